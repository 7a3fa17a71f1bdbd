"""Iterations of the solve with lubrication in random suspensions under shear, and evaluations of the mobility in a step of a run.

Spheres at random, at least the given gap apart and moved at random from there, are solved once, from zero, to an estimated
error of 1e-3 and of 1e-6. Iterations should not grow as the gap shrinks, nor be more than 1.5 times those of a prototype with a
dense mobility: 20, 35 and 41 to 1e-3, 32, 57 and 66 to 1e-6 at 20, 40 and 45%."""

import csv
import pathlib
import tempfile

import h5py
import numpy as np
from support.page import table, write_section
from support.program import run

SPHERES = 64
FRACTIONS, GAPS, TOLERANCES = (0.2, 0.4, 0.45, 0.5, 0.55), (1e-2, 1e-3, 1e-4), (1e-3, 1e-6)
# By volume fraction: iterations to either tolerance. Denser suspensions have the limit of 45%.
ALLOWED = {0.2: (30, 48), 0.4: (52, 85), 0.45: (61, 99), 0.5: (61, 99), 0.55: (61, 99)}
# A solve that takes more fails.
MOST = 1000
# The velocities' error is measured against a solve to this estimated error.
EXACT = 1e-8
EVALUATIONS_ALLOWED, STEPS, STEPS_FRACTION = 12, 200, 0.4


# Numbers of spheres by radius in the runs: of one size, and half the volume each of two.
RUNS = {"one size": {1.0: SPHERES}, "radii 1 and 2": {1.0: SPHERES, 2.0: SPHERES // 8}}


def scene(fraction, gap, *keys, counts=RUNS["one size"]):
    edge = (sum(4 / 3 * np.pi * radius**3 * count for radius, count in counts.items()) / fraction) ** (1 / 3)
    return "\n".join([
        "seed = 1",
        f"box.edges = [{edge}, {edge}, {edge}]",
        "fluid.viscosity = 1.0",
        f'particles = {{ initial = "random", minimum_gap = {gap} }}',
        'flow = { kind = "shear", rate = 1.0, lees_edwards = true }',
        "output = { trajectory_every = 1, checkpoint_every = 0 }",
        *keys,
        *(f'[[species]]\nname = "{radius:g}"\nradius = {radius}\ncount = {count}\n' for radius, count in counts.items()),
    ])


def result(text, overrides):
    """The rows of the time series and the velocities at its start; `None` if the solve does not converge."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        ended = run(text, out, overrides)
        if ended.returncode and "did not converge" not in ended.stderr:
            raise SystemExit(ended.stderr)
        if ended.returncode:
            return None, None
        with open(out / "observables.csv") as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        with h5py.File(out / "trajectory.h5") as file:
            return rows, next(iter(file["particles"].values()))["velocity/value"][0]


def solve(fraction, gap, tolerance, preconditioner=True):
    """Iterations of one solve, and its velocities."""
    text = scene(fraction, gap, "time = { step = 0.01, steps = 0 }", "hydrodynamics.lubrication = true")
    overrides = ["hydrodynamics.tolerance=1e-5", f"hydrodynamics.iteration_tolerance={tolerance}"]
    overrides.append(f"hydrodynamics.preconditioner={str(preconditioner).lower()}")
    rows, velocities = result(text, overrides)
    return (rows[0]["iterations"] if rows else None), velocities


def solves(fraction, gap):
    """Iterations with the preconditioner and without it, and the error of the velocities with it, for each tolerance."""
    _, exact = solve(fraction, gap, EXACT)
    for tolerance in TOLERANCES:
        found, velocities = solve(fraction, gap, tolerance)
        plain, _ = solve(fraction, gap, tolerance, preconditioner=False)
        yield found, plain, np.linalg.norm(velocities - exact) / np.linalg.norm(exact)


def iterations():
    """The table, and the failures."""
    rows, failed = [], []
    for fraction in FRACTIONS:
        for gap in GAPS:
            cells = [f"{fraction:.0%}", f"{gap:g}"]
            for tolerance, allowed, (found, plain, error) in zip(TOLERANCES, ALLOWED[fraction], solves(fraction, gap)):
                cells += [f"{found:.0f}", str(allowed), f"over {MOST}" if plain is None else f"{plain:.0f}", f"{error:.0e}"]
                if found > allowed:
                    failed.append(f"{fraction:.0%}, gap {gap:g}: {found:.0f} iterations to {tolerance:g}, more than {allowed}")
            rows.append(cells)
            print(*cells, flush=True)
    header = ["φ", "smallest gap"]
    header += [f"{name}{tolerance:g}" for tolerance in TOLERANCES for name in ("to ", "allowed to ", "plain to ", "error at ")]
    return table(header, rows), failed


def evaluations(counts):
    """Mean evaluations of the mobility in a step of a run, without the steps of the start."""
    time = f"time = {{ step = 0.005, steps = {STEPS} }}"
    hydrodynamics = "hydrodynamics = { tolerance = 1e-3, lubrication = true }"
    rows, _ = result(scene(STEPS_FRACTION, 0.01, time, hydrodynamics, "repulsion.strength = 60.0", counts=counts), [])
    return np.mean([row["evaluations"] for row in rows[4:]])


def main():
    lines, failed = iterations()
    means = {name: evaluations(counts) for name, counts in RUNS.items()}
    lines = [
        f"{SPHERES} spheres at random positions in shear, starting from zero: iterations to an estimated error of 1e-3 and 1e-6, the",
        "allowed number, the number without the preconditioner (*plain*), and the remaining error of the velocities.",
        "",
        *lines,
        "",
        f"A step of a run at {STEPS_FRACTION:.0%} (tolerance 1e-3, steps of 0.005 over the rate, {STEPS} of them) takes on average",
        f"{' and '.join(f'{mean:.1f} ({name})' for name, mean in means.items())} evaluations of the mobility; {EVALUATIONS_ALLOWED} are allowed.",
    ]
    write_section("lubrication.md", "iterations", "Iterations", lines)
    print("\n".join(lines))
    for name, mean in means.items():
        if mean > EVALUATIONS_ALLOWED:
            failed.append(f"{mean:.1f} evaluations in a step of {name}, more than {EVALUATIONS_ALLOWED}")
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
