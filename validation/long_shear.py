"""A long shear of a dense suspension with lubrication and repulsion, in adaptive steps: spheres do not overlap, and the cost of the solve
does not grow.

scripts/validate long-shear [STEPS] [--full]: 100,000 steps by default, with --full more spheres. It fails
if spheres overlap or a number is not finite."""

import sys

import numpy as np
from stability import SPHERES, sheared
from support.page import table, write_section
from support.program import series

FRACTION, STEP, PARTS = 0.4, 2e-3, 10
COLUMNS = ("smallest_gap", "iterations", "relative_viscosity")


def steps_of(steps):
    """The columns of all steps except the start."""
    return np.array([[row[name] for name in COLUMNS] for row in series(sheared("adaptive", STEP, FRACTION, steps=steps))[1:]])


def main():
    said = [int(word) for word in sys.argv[1:] if word != "--full"]
    steps = said[0] if said else 100_000
    found = steps_of(steps)
    rows = []
    for part in np.array_split(found, PARTS):
        gaps, iterations, viscosity = part.T
        rows.append([f"{gaps.min():.1e}", str((gaps <= 0).sum()), f"{iterations.mean():.2f}", f"{viscosity.mean():.2f}"])
    ends = [f"{STEP * steps * (k + 1) / PARTS:g}" for k in range(PARTS)]
    lines = [
        f"{SPHERES} spheres at {FRACTION:.0%} with a repulsion of 100, {steps:,} steps of {STEP:g} over the shear rate, by tenths of the run.",
        "",
        *table(
            ["strain up to", "smallest gap", "steps with overlap", "iterations per step", "relative viscosity"],
            [[end, *row] for end, row in zip(ends, rows)],
        ),
    ]
    write_section("lubrication.md", "long-shear", "A long shear", lines)
    print("\n".join(lines))
    if not np.isfinite(found).all() or found[:, 0].min() <= 0:
        raise SystemExit("failed: spheres overlap, or a number is not finite")


if __name__ == "__main__":
    main()
