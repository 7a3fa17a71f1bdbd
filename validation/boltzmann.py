"""The equilibrium of Brownian spheres is independent of hydrodynamics: energy, virial and pair distribution with and without
lubrication against Monte Carlo with the same potential."""

import sys
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
from support.estimates import mean_and_error, without_step
from support.page import table, write_section
from support.program import results

FULL = "--full" in sys.argv[1:]
COUNT, FRACTION, STRENGTH, RANGE = 64, 0.3, 60.0, 0.4
EDGE = (COUNT * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
# The time a^2/D_0 in which a sphere diffuses over its radius.
DIFFUSIVE = 6 * np.pi
STEPS = (2e-3, 4e-3, 8e-3) if FULL else (4e-3, 8e-3)
CASES = [(name, lubrication, step) for name, lubrication in (("far field", False), ("lubrication", True)) for step in STEPS]
LENGTH, SETTLED = (60.0, 4.0) if FULL else (12.0, 2.0)
SWEEPS = 40000 if FULL else 15000
# Allowed error of the energy and the virial extrapolated to step 0: standard errors, and a relative part for nonlinear terms.
ERRORS, BENT = 3.0, 0.02
BINS = np.linspace(1.8, EDGE / 2, 16)


def distances(places, others):
    apart = places - others
    apart -= EDGE * np.round(apart / EDGE)
    return np.sqrt((apart**2).sum(-1))


def potential(r):
    """Potential of the repulsion, whose force is STRENGTH at contact: F = strength/c [(R^2 - r^2)/(R^2 - c^2)]^2 r."""
    contact, reach = 2.0, 2.0 * (1 + RANGE / 2)
    return STRENGTH * np.clip(reach**2 - r**2, 0, None) ** 3 / (6 * contact * (reach**2 - contact**2) ** 2)


def force(r):
    contact, reach = 2.0, 2.0 * (1 + RANGE / 2)
    return STRENGTH / contact * (np.clip(reach**2 - r**2, 0, None) / (reach**2 - contact**2)) ** 2 * r


def measured(places):
    """Energy per sphere, virial over 3 N, and the number of pairs in each bin."""
    i, j = np.triu_indices(COUNT, 1)
    r = distances(places[i], places[j])
    return np.concatenate([[potential(r).sum() / COUNT, (force(r) * r).sum() / (3 * COUNT)], np.histogram(r, BINS)[0]])


def monte_carlo():
    random = np.random.default_rng(1)
    side = int(np.ceil(COUNT ** (1 / 3)))
    lattice = np.stack(np.meshgrid(*[np.arange(side)] * 3), -1).reshape(-1, 3)[:COUNT]
    places, step, samples = (lattice + 0.5) * EDGE / side, 0.35, []
    rows = np.arange(COUNT)
    for sweep in range(SWEEPS):
        moves, chances = random.uniform(-step, step, (COUNT, 3)), random.random(COUNT)
        for k in range(COUNT):
            others = places[rows != k]
            change = potential(distances(places[k] + moves[k], others)).sum() - potential(distances(places[k], others)).sum()
            if chances[k] < np.exp(-change):
                places[k] += moves[k]
        if sweep > SWEEPS // 20 and sweep % 5 == 0:
            samples.append(measured(places))
    return np.array(samples)


def brownian(case):
    _, lubrication, step = case
    step, every = step * DIFFUSIVE, max(1, round(0.02 / step))
    scene = f"""seed = 2
box.edges = [{EDGE}, {EDGE}, {EDGE}]
fluid = {{ viscosity = 1.0, thermal_energy = 1.0 }}
repulsion = {{ strength = {STRENGTH}, range = {RANGE} }}
hydrodynamics = {{ lubrication = {str(lubrication).lower()}, tolerance = 1e-2 }}
time = {{ step = {step}, duration = {round(LENGTH * DIFFUSIVE / step) * step} }}
output = {{ trajectory_every = {every}, observables_every = 0, checkpoint_every = 0 }}
[[species]]
radius = 1.0
count = {COUNT}
"""
    with results(scene) as out:
        with h5py.File(out / "trajectory.h5") as file:
            places = file["particles/all/position/value"][:]
            time = file["particles/all/position/time"][:]
    return np.array([measured(frame) for frame in places[time > SETTLED * DIFFUSIVE]])


def main():
    with ThreadPoolExecutor(2) as two:
        found = list(two.map(brownian, CASES))
    exact, exact_error = mean_and_error(monte_carlo())
    rows, failed = [["Monte Carlo", "", f"{exact[0]:.4f} ± {exact_error[0]:.4f}", f"{exact[1]:.3f} ± {exact_error[1]:.3f}", ""]], []
    for name in ("far field", "lubrication"):
        own = [(step, *mean_and_error(samples)) for (of, _, step), samples in zip(CASES, found) if of == name]
        for step, mean, error in own:
            pairs = np.abs(mean[2:] - exact[2:]).max() / exact[2:].max()
            rows.append([name, f"{step:g}", f"{mean[0]:.4f} ± {error[0]:.4f}", f"{mean[1]:.3f} ± {error[1]:.3f}", f"{pairs:.3f}"])
        limits = [without_step([(step, mean[k], error[k]) for step, mean, error in own]) for k in (0, 1)]
        rows.append([name, "0", *(f"{value:.{digits}f} ± {error:.{digits}f}" for (value, error), digits in zip(limits, (4, 3))), ""])
        for what, k in (("energy", 0), ("virial", 1)):
            value, error = limits[k]
            if abs(value - exact[k]) > ERRORS * np.hypot(error, exact_error[k]) + BENT * exact[k]:
                failed.append(f"{name}: the {what} is {value:.4f}, not {exact[k]:.4f}")
    for cells in rows:
        print(*cells, flush=True)
    lines = [
        f"{COUNT} spheres at {FRACTION:.0%} by volume with a repulsion of {STRENGTH:g} kT/a at contact that vanishes at a gap of {RANGE:g}, over",
        f"a time of {LENGTH:g} \\\\(a^2/D_0\\\\), the unit of the steps: energy per sphere and virial over \\\\(3N\\\\), both in kT, and the",
        "largest deviation of the pair distribution from that of Monte Carlo, relative to its peak. The errors are linear in",
        "the step; rows at step 0 are linear extrapolations.",
        "",
        *table(["", "step", "energy", "virial", "pair distribution"], rows),
    ]
    write_section("brownian.md", "boltzmann", "Equilibrium", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
