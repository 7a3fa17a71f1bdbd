"""Viscosity of colloids against the Peclet number, by the scheme of two evaluations, with the contributions to the stress; and its limit
of slow shear from the autocorrelation of the stress at rest (Green & Kubo)."""

import sys
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
from support.estimates import mean_and_error
from support.page import table, write_section
from support.program import mobility, results, rows_of

FULL = "--full" in sys.argv[1:]
COUNT, FRACTION, STRENGTH, RANGE = (64, 0.3, 60.0, 0.4) if FULL else (24, 0.3, 60.0, 0.4)
EDGE = (COUNT * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
# The time in which a sphere diffuses over its radius, with kT, mu and a of 1.
DIFFUSIVE = 6 * np.pi
# At higher numbers shear forces make pairs overlap against this repulsion.
NUMBERS = (0.3, 1.0, 3.0, 10.0, 30.0) if FULL else (1.0, 10.0)
STEP, LONGEST = 2e-3, 5e-3
LENGTH, SETTLED = (60.0, 6.0) if FULL else (8.0, 2.0)
# Steps per row in shear, where successive stresses are nearly the same.
EVERY = 4
# Configurations at rest on which the viscosity at high frequency is computed.
FRAMES = 40 if FULL else 8
# Peclet number nearly at rest, at which the time series still has stresses.
REST = 1e-6
PARTS = ("stresslet", "lubrication", "repulsion", "brownian")
# Correlation time of the stress at rest.
MEMORY = 1.5


def rows(rate, step, length, every, frames=0):
    """The time series of a run at a shear rate. The step and the length are in times of diffusion; a row is written every `every`
    steps, and `frames` configurations in all."""
    scene = f"""seed = 5
box.edges = [{EDGE}, {EDGE}, {EDGE}]
fluid = {{ viscosity = 1.0, thermal_energy = 1.0 }}
flow = {{ kind = "shear", rate = {rate} }}
repulsion = {{ strength = {STRENGTH}, range = {RANGE} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = {step * DIFFUSIVE}, steps = {round(length / step)}, brownian = "random-finite-difference" }}
output = {{ trajectory_every = {round(length / step / frames) if frames else 0}, observables_every = {every}, checkpoint_every = 0 }}
[[species]]
radius = 1.0
count = {COUNT}
"""
    with results(scene) as out:
        lines = rows_of(out / "observables.csv")
        places = []
        if frames:
            with h5py.File(out / "trajectory.h5") as file:
                places = file["particles/all/position/value"][1:]
    series = {name: np.array([float(line[name]) for line in lines]) for name in lines[0]}
    kept = series["time"] >= SETTLED * DIFFUSIVE * step / STEP
    return {name: values[kept] for name, values in series.items()}, places


def component(series, part, name):
    return sum(values for key, values in series.items() if key.startswith(f"stress_{part}_{name}"))


def sheared(number):
    """Viscosity by parts at a Peclet number; above a number of 1 the runs have the same length in strain."""
    # At most half a percent of strain, so that pairs do not overlap in a step.
    step = min(STEP, LONGEST / number)
    rate = number / DIFFUSIVE
    series, _ = rows(rate, step, LENGTH * step / STEP, EVERY)
    parts = [mean_and_error(component(series, part, "xy") / rate, 10) for part in PARTS]
    whole = mean_and_error(series["relative_viscosity"], 10)
    differences = [mean_and_error(series[f"{which}_normal_stress_difference"] / rate, 10) for which in ("first", "second")]
    return [whole, *parts, *differences]


def high_frequency(places):
    """High-frequency viscosity of configurations: without the stresses of forces and Brownian motion."""
    gradient = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    case = {"box": [EDGE] * 3, "viscosity": 1.0, "radii": 1.0, "lubrication": True, "background": {"velocity_gradient": gradient}}
    of_each = [np.sum(mobility(case | {"positions": x}, 1e-3)["stresslets"], axis=0)[1] / (2 * EDGE**3) for x in places]
    return 1 + np.mean(of_each), np.std(of_each, ddof=1) / np.sqrt(len(of_each))


def at_rest(_):
    """The high-frequency viscosity, and the integral of the autocorrelation of the stresses of forces and Brownian motion: V/kT times its mean over
    five components. Errors by fifths of the run."""
    series, places = rows(REST / DIFFUSIVE, STEP, 2 * LENGTH, 1, FRAMES)
    total = {name: sum(component(series, part, name) for part in PARTS) for name in ("xx", "xy", "xz", "yy", "yz", "zz")}
    five = [total["xy"], total["xz"], total["yz"], 0.5 * (total["xx"] - total["yy"]), (2 * total["zz"] - total["xx"] - total["yy"]) / 12**0.5]
    lags, step = round(MEMORY / STEP), STEP * DIFFUSIVE

    def integral(piece):
        # The noise of the Brownian stress is uncorrelated with later values: lag 0 is replaced by the value at the first lag.
        values = [np.mean([np.mean(s[:-lag] * s[lag:]) for s in piece]) for lag in range(1, lags)]
        return EDGE**3 * step * (np.sum(values) + 0.5 * values[0])

    fifths = [integral([s[k * len(s) // 5 : (k + 1) * len(s) // 5] for s in five]) for k in range(5)]
    return high_frequency(places), (np.mean(fifths), np.std(fifths, ddof=1) / np.sqrt(5))


def main():
    with ThreadPoolExecutor(2) as two:
        rest, found = two.submit(at_rest, None), list(two.map(sheared, NUMBERS))
        frequent, (integral, error) = rest.result()
    slowest = found[0]
    cells = [[f"{number:g}", *(f"{value:.3f} ± {error:.3f}" for value, error in values)] for number, values in zip(NUMBERS, found)]
    limit, error = frequent[0] + integral, np.hypot(error, frequent[1])
    cells.insert(0, ["at rest", f"{limit:.3f} ± {error:.3f}", *[""] * 6])
    for row in cells:
        print(*row, flush=True)
    lines = [
        f"{COUNT} spheres with lubrication at {FRACTION:.0%} by volume and a repulsion of {STRENGTH:g} kT/a at contact that vanishes at a gap of",
        f"{RANGE:g}, with steps of at most {STEP:g} \\\\(a^2/D_0\\\\): the relative viscosity as a function of",
        "\\\\(\\mathrm{Pe} = \\dot\\gamma a^2/D_0\\\\), its contributions, and the normal stress differences over",
        "\\\\(\\mu \\dot\\gamma\\\\). The contribution of the stresslets includes those induced by the repulsive forces. The row at",
        f"rest is the limit of slow shear by the Green-Kubo relation: the high-frequency viscosity, {frequent[0]:.3f} ± {frequent[1]:.3f} from",
        f"{FRAMES} configurations, plus the integral of the stress autocorrelation.",
        "",
        *table(["Pe", "viscosity", "stresslets", "lubrication", "repulsion", "Brownian", "\\\\(N_1\\\\)", "\\\\(N_2\\\\)"], cells),
    ]
    write_section("brownian.md", "brownian-viscosity", "Viscosity", lines)
    thin = found[len(found) // 2][0]
    if thin[0] > slowest[0][0] + 3 * np.hypot(thin[1], slowest[0][1]):
        raise SystemExit("failed: there is no shear thinning at small Peclet numbers")
    if abs(limit - slowest[0][0]) > 3 * np.hypot(error, slowest[0][1]) + 0.2 * slowest[0][0]:
        raise SystemExit(f"failed: {limit:.2f} at rest is not {slowest[0][0]:.2f} in slow shear")


if __name__ == "__main__":
    main()
