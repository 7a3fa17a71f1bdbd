"""Boxes that are long along the flow, sheared to a strain of 100: runs complete, spheres do not overlap, and velocities meet the tolerance
at any strain of the lattice.

scripts/validate long-boxes: it fails if a run ends before its time, spheres overlap, a number is not finite, or an error is above the
tolerance."""

import numpy as np
from support.page import table, write_section
from support.program import mobility, series

BOXES = ([200.0, 10.0, 10.0], [400.0, 10.0, 10.0], [400.0, 4.0, 6.0])
SPHERES, STRAIN, STEP = 60, 100.0, 0.1
TOLERANCES, TIGHT = (1e-2, 1e-3, 1e-5), 1e-8
# Strains of the lattice over the largest one, which is half of the ratio of the edges.
PARTS = (-1.0, -0.77, -0.4, 0.03, 0.55, 0.999)


def scene(box):
    return f"""seed = 3
box.edges = {box}
fluid.viscosity = 1.0
species = [{{ name = "one", radius = 1.0, count = {SPHERES} }}]
particles = {{ initial = "random", minimum_gap = 0.1 }}
flow = {{ kind = "shear", rate = 1.0 }}
repulsion = {{ strength = 100.0, range = 0.1 }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ integrator = "adaptive", step = {STEP}, steps = {round(STRAIN / STEP)} }}
output = {{ trajectory_every = 0, observables_every = 1, checkpoint_every = 0 }}
"""


def case(box, part):
    """Spheres of two sizes along the box, at random positions across it, and random loads."""
    random, count = np.random.default_rng(7), 8
    strain = part * 0.5 * box[0] / box[1]
    parts = np.column_stack([np.arange(count) / count, random.uniform(size=(count, 2))])
    positions = parts * box
    positions[:, 0] += strain * positions[:, 1]
    loads = random.normal(size=(2, count, 3))
    return {
        "box": box, "strain": strain, "viscosity": 1.0, "positions": positions, "radii": [1.0, 1.3] * (count // 2),
        "forces": loads[0], "torques": loads[1],
    }


def error(box, part, tolerance):
    """The largest relative error of velocities and of angular velocities against a tight solve."""
    found, exact = (mobility(case(box, part), t) for t in (tolerance, TIGHT))
    arrays = [[np.array(answer[name]) for name in ("velocities", "angular_velocities")] for answer in (found, exact)]
    return max(np.linalg.norm(a - b) / np.linalg.norm(b) for a, b in zip(*arrays))


def main():
    rows, failed = [], []
    for box in BOXES:
        name = " x ".join(f"{edge:g}" for edge in box)
        run = series(scene(box))
        gap, end = min(row["smallest_gap"] for row in run), run[-1]["time"]
        errors = [max(error(box, part, tolerance) for part in PARTS) / tolerance for tolerance in TOLERANCES]
        rows.append([name, f"{end:g}", f"{gap:.1e}", *(f"{e:.2f}" for e in errors)])
        numbers = np.array([[row["smallest_gap"], row["relative_viscosity"]] for row in run])
        if not (np.isfinite(numbers).all() and gap > 0 and abs(end - STRAIN) < 1e-6 and max(errors) < 1):
            failed.append(name)
    lines = [
        f"Runs of {SPHERES} spheres of radius 1 with lubrication and repulsion, and the largest ratio of error to tolerance for eight",
        f"spheres of radii 1 and 1.3 under random loads, over {len(PARTS)} strains of the lattice.",
        "",
        *table(["box", "strain", "smallest gap", *(f"error / {t:g}" for t in TOLERANCES)], rows),
    ]
    write_section("method.md", "long-boxes", "Long boxes", lines)
    print("\n".join(lines))
    if failed:
        raise SystemExit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
