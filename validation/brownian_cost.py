"""Cost of a step of Brownian motion, over one solve from zero for the motions of the same spheres under random forces, at the
positions before and after the steps; timed in turns, medians."""

import json
import sys

import h5py
import numpy as np
from support.page import table, write_section
from support.program import mobility, results, rows_of

FULL = "--full" in sys.argv[1:]
COUNT, FRACTIONS, ROUNDS = 2000, (0.1, 0.3), 7 if FULL else 3
# Steps of a run.
STEPS = 16
# Schemes, steps per row of the time series, and the intended cost of a step in solves.
SCHEMES = [("drifter-corrector", STEPS, "1.3"), ("random-finite-difference", STEPS, "1.9"), ("random-finite-difference", 1, "")]
# Distance of the walls in radii, and the schemes between them.
HEIGHT, BETWEEN_WALLS = 20.0, [("drifter-corrector", STEPS, ""), ("random-finite-difference", STEPS, "")]
TOLERANCE = 1e-3


def box(fraction, kind):
    """Edges and boundaries."""
    volume = COUNT * 4 / 3 * np.pi / fraction
    if kind == "walls":
        return {"box": [(volume / HEIGHT) ** 0.5] * 2 + [HEIGHT], "boundaries": ["periodic", "periodic", "walls"]}
    return {"box": [volume ** (1 / 3)] * 3, "boundaries": ["periodic"] * 3}


def timed_steps(fraction, kind, lubrication, scheme, every):
    """Seconds of a step, and the positions of the spheres at the start and at the end, where gaps are smaller and solves longer."""
    place = box(fraction, kind)
    scene = f"""seed = 2
box = {{ edges = {place["box"]}, boundaries = {json.dumps(place["boundaries"])} }}
fluid = {{ viscosity = 1.0, thermal_energy = 1.0 }}
particles.minimum_gap = 0.08
repulsion = {{ strength = 60.0, range = 0.2 }}
hydrodynamics = {{ lubrication = {str(lubrication).lower()}, tolerance = {TOLERANCE} }}
time = {{ step = 0.002, steps = {STEPS}, brownian = "{scheme}" }}
output = {{ trajectory_every = {STEPS}, observables_every = {every}, checkpoint_every = 0 }}
[[species]]
radius = 1.0
count = {COUNT}
"""
    with results(scene) as out, h5py.File(out / "trajectory.h5") as file:
        seconds = [float(row["seconds_per_step"]) for row in rows_of(out / "observables.csv")][1:]
        return np.mean(seconds), file["particles/all/position/value"][:]


def row(scheme, every, meant, fraction, kind, lubrication):
    forces = np.random.default_rng(1).normal(size=(COUNT, 3)).tolist()
    ratios, steps = [], []
    for _ in range(ROUNDS):
        step, places = timed_steps(fraction, kind, lubrication, scheme, every)
        case = box(fraction, kind) | {"viscosity": 1.0, "radii": 1.0, "lubrication": lubrication, "forces": forces}
        solve = np.mean([mobility(case | {"positions": at}, TOLERANCE)["seconds"] for at in places])
        ratios.append(step / solve)
        steps.append(1e3 * step)
    spread = f"{np.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
    recorded = "every step" if every == 1 else "last step"
    cells = [scheme, recorded, kind, f"{fraction:.0%}", "yes" if lubrication else "no", f"{np.median(steps):.0f}", spread, meant]
    print(*cells, flush=True)
    return cells


def main():
    cases = [(scheme, fraction, "periodic") for scheme in SCHEMES for fraction in FRACTIONS]
    cases += [(scheme, 0.2, "walls") for scheme in BETWEEN_WALLS]
    rows = [row(*scheme, fraction, kind, lubrication) for scheme, fraction, kind in cases for lubrication in (False, True)]
    lines = [
        f"{COUNT} spheres, tolerance {TOLERANCE:g}, one thread, {ROUNDS} rounds. The time of a step, from runs of {STEPS} steps that record",
        "either the last or every step in the time series, is divided by that of one solve from zero for random forces (mean of",
        f"the initial and the final positions). The box is a periodic cube, or has walls {HEIGHT:g} radii apart. The solve takes longer",
        "when a half step of noise makes spheres overlap, as it does if the step is too long for the gaps.",
        "",
        *table(["scheme", "recorded", "box", "φ", "lubrication", "ms per step", "steps in solves", "goal"], rows),
    ]
    write_section("brownian.md", "brownian-cost", "Cost", lines)


if __name__ == "__main__":
    main()
