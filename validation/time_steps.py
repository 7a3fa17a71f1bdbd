"""Cost and error of the time integrators for spheres with a repulsive barrier: final positions relative to those of short
steps of order 4; and the viscosity of a dense suspension with lubrication, by integrators with substeps."""

import csv
import pathlib
import tempfile

import h5py
import numpy as np
from support.page import table, write_section
from support.program import run

# Radius and viscosity are 1: the weight of a sphere of Stokes velocity 1.
WEIGHT = 6 * np.pi
COMMON = """
seed = 1
box.edges = [20.0, 20.0, 20.0]
fluid.viscosity = 1.0
particles = { initial = "random", minimum_gap = 0.01 }
hydrodynamics.tolerance = 1e-2
"""
SETTLING = f"""
repulsion = {{ strength = {4 * WEIGHT}, range = 0.2 }}
species = [
    {{ name = "heavy", radius = 1.0, volume_fraction = 0.06, force = [0.0, 0.0, {-WEIGHT}] }},
    {{ name = "buoyant", radius = 1.0, volume_fraction = 0.06, force = [0.0, 0.0, {WEIGHT}] }},
]
"""
SIZES = f"""
repulsion = {{ strength = {4 * WEIGHT}, range = 0.2, radius_power = 2 }}
species = [
    {{ name = "small", radius = 1.0, volume_fraction = 0.05, force = [0.0, 0.0, {-WEIGHT}] }},
    {{ name = "large", radius = 3.0, volume_fraction = 0.05, force = [0.0, 0.0, {-27 * WEIGHT}] }},
]
"""
SHEARED = """
repulsion = { strength = 120.0, range = 0.2 }
flow = { kind = "shear", rate = 1.0, lees_edwards = true }
species = [{ radius = 1.0, volume_fraction = 0.15 }]
"""
CASES = {
    "6% heavy and 6% buoyant spheres, 4 Stokes times": SETTLING,
    "5% of radius 1 and 5% of radius 3 settle, 4 Stokes times": SIZES,
    "15%, sheared to a strain of 4": SHEARED,
}
TIME = 4.0
# Order and step of the reference.
EXACT = (4, 0.00125)
STEPS = {4: (0.005, 0.01), 3: (0.01, 0.02), 2: (0.01, 0.02, 0.03125, 0.05)}
# Tolerances of integrators with substeps, and the length of their steps.
SUBSTEPS = {"adaptive": (1e-4, 1e-3), "implicit": (1e-4, 1e-3)}
CLOCK_STEP = 0.2
# Allowed median error: this many times the square of the step, or this many tolerances.
ALLOWED = 10.0
TOLERANCES_ALLOWED = 20.0

DENSE = """
seed = 1
box.edges = [12.5, 12.5, 12.5]
fluid.viscosity = 1.0
particles = { initial = "random", minimum_gap = 0.01 }
hydrodynamics = { tolerance = 1e-2, lubrication = true }
flow = { kind = "shear", rate = 1.0, lees_edwards = true }
species = [
    { name = "small", radius = 1.0, volume_fraction = 0.27 },
    { name = "large", radius = 1.4, volume_fraction = 0.18 },
]
"""
STRENGTHS = (200.0, 2000.0, 20000.0)
STRAIN, FINE = 1.0, 1e-6
# Allowed relative difference of the mean viscosity from that with the finest substeps.
VISCOSITY_ALLOWED = 0.01


def fixed(order, step):
    return f"time = {{ step = {step}, steps = {round(TIME / step)}, order = {order} }}", round(TIME / step)


def divided(integrator, tolerance, step, time):
    keys = f'integrator = "{integrator}", tolerance = {tolerance}'
    return f"time = {{ step = {step}, steps = {round(time / step)}, {keys} }}", round(time / step)


def result(scene, time, count):
    """Final positions, the rows of the time series, and whether there was a warning."""
    output = f"output = {{ trajectory_every = {count}, checkpoint_every = 0 }}"
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        ended = run("\n".join([time, output, scene]), out)
        if ended.returncode:
            raise SystemExit(ended.stderr)
        with open(out / "observables.csv") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        with h5py.File(out / "trajectory.h5") as file:
            places = next(iter(file["particles"].values()))["position/value"][-1]
        return places, rows, "longer than" in ended.stderr


def ways():
    """Integrators: the name, the step or tolerance, the section [time] with the number of steps, and the allowed median error."""
    for order, steps in STEPS.items():
        for step in steps:
            yield f"order {order}", f"{step:g}", fixed(order, step), ALLOWED * step**2
    for integrator, tolerances in SUBSTEPS.items():
        for tolerance in tolerances:
            time = divided(integrator, tolerance, CLOCK_STEP, TIME)
            yield f"{integrator}, to", f"{tolerance:g}", time, TOLERANCES_ALLOWED * tolerance


def places():
    """A table of errors of positions, and the failures."""
    rows, failed = [], []
    for name, scene in CASES.items():
        exact, *_ = result(COMMON + scene, *fixed(*EXACT))
        for way, size, time, allowed in ways():
            found, series, warned = result(COMMON + scene, *time)
            errors = np.linalg.norm(found - exact, axis=1)
            median, most = np.median(errors), np.quantile(errors, 0.95)
            evaluations = sum(row["evaluations"] for row in series[1:]) / TIME
            gap = min(row["smallest_gap"] for row in series)
            row = [name, f"{way} {size}", "yes" if warned else "", f"{evaluations:.0f}", f"{median:.1e}", f"{most:.1e}", f"{gap:.3f}"]
            print(*row, flush=True)
            rows.append(row)
            if median > allowed:
                failed.append(f"{name}, {way} {size}: median error {median:.1e}, more than {allowed:.1e}")
    header = ["case", "steps", "warning", "evaluations per unit of time", "median error", "95th percentile", "smallest gap"]
    return table(header, rows), failed


def viscosities():
    """A table of viscosities of a dense suspension, and the failures."""
    rows, failed = [], []
    for strength in STRENGTHS:
        scene = f"{DENSE}repulsion.strength = {strength}\n"
        exact = None
        for integrator, tolerances in {"adaptive": (FINE, *SUBSTEPS["adaptive"]), "implicit": SUBSTEPS["implicit"]}.items():
            for tolerance in tolerances:
                time = divided(integrator, tolerance, 0.02, STRAIN)
                _, series, _ = result(scene, *time)
                viscosity = np.mean([row["relative_viscosity"] for row in series[1:]])
                exact = viscosity if exact is None else exact
                evaluations, gap = sum(row["evaluations"] for row in series[1:]), min(row["smallest_gap"] for row in series)
                off = viscosity / exact - 1
                rows.append([f"{strength:g}", f"{integrator}, to {tolerance:g}", f"{evaluations:.0f}", f"{viscosity:.3f}",
                             f"{100 * off:+.2f}%", f"{gap:.1e}"])
                print(*rows[-1], flush=True)
                if abs(off) > VISCOSITY_ALLOWED:
                    failed.append(f"strength {strength:g}, {integrator} to {tolerance:g}: viscosity off by {off:.1%}")
    header = ["strength", "substeps", "evaluations per unit of strain", "mean relative viscosity", "error", "smallest gap"]
    return table(header, rows), failed


def main():
    errors, failed = places()
    dense, failed_dense = viscosities()
    lines = [
        "Spheres in a box of edge 20, a tolerance of 1e-2, and a repulsion that vanishes at a gap of 0.2. Errors are those of",
        f"positions, in units of the small radius, relative to order {EXACT[0]} with a step of {EXACT[1]}. For comparison, an error of 1% in",
        "the velocity amounts to 0.01 to 0.04 in the final position. The integrators `adaptive` and `implicit` divide steps of",
        f"{CLOCK_STEP:g} into substeps to the tolerance given.",
        "",
        *errors,
        "",
        "Spheres of radius 1 (27%) and 1.4 (18%) with lubrication in a box of edge 12.5, for three strengths of the repulsion:",
        "",
        *dense,
    ]
    write_section("method.md", "time-steps", "Orders and time steps", lines)
    if failed or failed_dense:
        raise SystemExit("failed: " + "; ".join(failed + failed_dense))


if __name__ == "__main__":
    main()
