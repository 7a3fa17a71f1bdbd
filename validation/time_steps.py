"""What fixed time steps of each order cost and how far they lead astray: places after a while, against those by short steps of order 4,
where a barrier holds near spheres apart."""

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
# Short ones of order 4, which the others are compared with.
EXACT = (4, 0.00125)
STEPS = {4: (0.005, 0.01), 3: (0.01, 0.02), 2: (0.01, 0.02, 0.03125, 0.05)}
# The method is wrong where a median error is more than this many times the square of the step.
ALLOWED = 10.0


def result(scene, order, step):
    """Places at the end, the rows of the time series, and what was warned of."""
    count = round(TIME / step)
    time = f"time = {{ step = {step}, steps = {count}, order = {order} }}"
    output = f"output = {{ trajectory_every = {count}, checkpoint_every = 0 }}"
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        ended = run("\n".join([COMMON, time, output, scene]), out)
        if ended.returncode:
            raise SystemExit(ended.stderr)
        with open(out / "observables.csv") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        with h5py.File(out / "trajectory.h5") as file:
            places = next(iter(file["particles"].values()))["position/value"][-1]
        return places, rows, "longer than" in ended.stderr


def main():
    rows, failed = [], []
    for name, scene in CASES.items():
        exact, *_ = result(scene, *EXACT)
        for order, steps in STEPS.items():
            for step in steps:
                places, series, warned = result(scene, order, step)
                errors = np.linalg.norm(places - exact, axis=1)
                median, most = np.median(errors), np.quantile(errors, 0.95)
                evaluations = sum(row["evaluations"] for row in series[1:]) / TIME
                gap = min(row["smallest_gap"] for row in series)
                row = [name, str(order), f"{step:g}", "yes" if warned else "", f"{evaluations:.0f}", f"{median:.1e}", f"{most:.1e}", f"{gap:.3f}"]
                print(*row, flush=True)
                rows.append(row)
                if median > ALLOWED * step**2:
                    failed.append(f"{name}, order {order}, step {step:g}: median error {median:.1e}, more than {ALLOWED * step**2:.1e}")
    header = ["case", "order", "step", "warned of", "evaluations in a unit of time", "median error", "error of 95%", "smallest gap"]
    lines = [
        "Spheres in a box of side 20, velocities to 1e-2, held apart by repulsion that starts at a gap of 0.2. Errors are",
        f"those of places, over the small radius, against order {EXACT[0]} with a step of {EXACT[1]}. A velocity that is off by a hundredth leads 0.01 to 0.04 astray.",
        "",
        *table(header, rows),
    ]
    write_section("method.md", "time-steps", "Orders and time steps", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
