"""Cost of walls and unbounded fluid: a solve for the motions of rigid spheres between walls, above one wall, or in unbounded fluid,
relative to one for the same spheres in a periodic box with the same edges; timed in turns, medians."""

import sys

import h5py
import numpy as np
from support.page import table, write_section
from support.program import mobility, results

FULL = "--full" in sys.argv[1:]
TOLERANCE, HEIGHT, COUNT, ROUNDS = 1e-3, 20.0, 2000, 9 if FULL else 3
# Boundaries across z, or all; volume fractions; allowed ratio of the time of an evaluation to that in a periodic box.
CASES = [
    ("walls", (0.1, 0.2, 0.3), 1.4),
    ("wall", (0.2,), None),
    ("open", (0.2,), 3.0),
]


def box(kind, fraction):
    """Edges for a volume fraction, between walls at a fixed distance."""
    volume = COUNT * 4 / 3 * np.pi / fraction
    return [volume ** (1 / 3)] * 3 if kind == "open" else [(volume / HEIGHT) ** 0.5] * 2 + [HEIGHT]


def places(edges):
    """Random positions of spheres between walls at the faces of the box."""
    scene = f"""seed = 3
box = {{ edges = {edges}, boundaries = ["periodic", "periodic", "walls"] }}
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.05 }}
hydrodynamics = {{ tolerance = 1e-2, multipoles = "monopole" }}
time = {{ step = 1e-6, steps = 1 }}
output.trajectory_every = 1
[[species]]
radius = 1.0
count = {COUNT}
"""
    with results(scene) as out, h5py.File(out / "trajectory.h5") as file:
        # Positions within the box for all boundaries.
        return np.clip(file["particles/all/position/value"][0], 0.0, np.array(edges))


def seconds(case, boundaries):
    """Seconds of an evaluation of the mobility within a solve, and how many there are."""
    answer = mobility(case | {"boundaries": boundaries}, TOLERANCE)
    return answer["seconds"] / (1 + answer["iterations"]), 1 + answer["iterations"]


def row(kind, fraction, allowed, failed):
    edges = box(kind, fraction)
    positions = places(edges)
    forces = np.random.default_rng(1).normal(size=(COUNT, 3))
    case = {"box": edges, "viscosity": 1.0, "radii": 1.0, "positions": positions, "forces": forces}
    boundaries = ["open"] * 3 if kind == "open" else ["periodic", "periodic", kind]
    taken = [(seconds(case, boundaries), seconds(case, ["periodic"] * 3)) for _ in range(ROUNDS)]
    ratios = [here / there for (here, _), (there, _) in taken]
    here, there = (np.median([way[k][0] for way in taken]) for k in (0, 1))
    ratio = np.median(ratios)
    if allowed and ratio > allowed:
        failed.append(f"{kind} at {fraction:.0%}: {ratio:.2f} times the periodic box, more than {allowed}")
    size = " x ".join(f"{edge:.1f}" for edge in edges)
    evaluations = " and ".join(str(way[1]) for way in taken[0])
    cells = [kind, f"{fraction:.0%}", size, f"{1e3 * here:.1f}", f"{1e3 * there:.1f}", evaluations]
    cells += [f"{ratio:.2f} ({min(ratios):.2f} to {max(ratios):.2f})", str(allowed or "")]
    print(*cells, flush=True)
    return cells


def main():
    failed = []
    rows = [row(kind, fraction, allowed, failed) for kind, fractions, allowed in CASES for fraction in fractions]
    lines = [
        f"{COUNT} rigid spheres of radius 1 under random forces, tolerance {TOLERANCE:g}, one thread, {ROUNDS} rounds: milliseconds per",
        "evaluation of the mobility, including preparations, between walls across z, above one wall, and in unbounded fluid,",
        "compared with the same spheres in a periodic box of the same edges.",
        "",
        *table(["boundaries", "φ", "box", "ms", "ms, periodic", "evaluations", "ratio", "allowed"], rows),
        "",
        f"Not met: {'; '.join(failed)}." if failed else "All ratios are within the limits.",
    ]
    write_section("walls.md", "boundary-cost", "Cost", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
