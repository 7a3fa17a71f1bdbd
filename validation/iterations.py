"""Mobility evaluations that a lubricated solve takes from nothing, for random suspensions at several volume fractions and smallest
gaps, to two tolerances; and in a run, which starts each solve from those before."""

import concurrent.futures
import csv
import os
import tempfile

import numpy as np
from support import hard_spheres
from support.page import table, write_section
from support.program import mobility, run

FRACTIONS, GAPS, SPHERES = (0.2, 0.4, 0.45, 0.5, 0.55), (1e-2, 1e-3, 1e-4), 64
# The error asked for, whose solve goes on to a twentieth of it: (tolerance, residual).
TOLERANCES = (2e-2, 2e-5)
# Of a prototype of the same formulation, 64 spheres, by volume fraction: to 1e-3 and 1e-6.
PROTOTYPE = {0.2: (20, 32), 0.4: (35, 57), 0.45: (41, 66)}
MORE, MOST_A_STEP = 1.5, 12
RUN = """
seed = 5
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles.minimum_gap = 0.01
flow = {{ kind = "shear", rate = 1.0, lees_edwards = true }}
repulsion.strength = 100.0
hydrodynamics = {{ tolerance = 1e-3, lubrication = true, iteration_tolerance = 1e-3 }}
output = {{ trajectory_every = 0, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = {count} }}]
time = {{ step = 0.002, steps = {steps} }}
"""


def with_gap(fraction, gap):
    """A configuration whose nearest pair has the gap given, and no other a smaller one."""
    edge = hard_spheres.box(SPHERES, fraction)
    # Spheres a little larger at equilibrium, then one moved to its neighbour.
    scale = 1 + gap
    centres, loose = hard_spheres.equilibrium(SPHERES, min(fraction * scale**3, 0.57), 7, sweeps=300)
    centres = centres * edge / loose
    apart = centres[:, None] - centres[None]
    apart -= edge * np.round(apart / edge)
    distances = np.linalg.norm(apart, axis=-1) + 10 * edge * np.eye(SPHERES)
    i, j = np.unravel_index(distances.argmin(), distances.shape)
    centres[i] += apart[i, j] * ((2 + gap) / distances[i, j] - 1)
    return centres, edge


def count(job):
    fraction, gap = job
    centres, edge = with_gap(fraction, gap)
    gradient = [[0, 1.0, 0], [0, 0, 0], [0, 0, 0]]
    case = {"box": [edge] * 3, "viscosity": 1.0, "positions": centres, "radii": 1.0, "lubrication": True}
    case["background"] = {"velocity_gradient": gradient}
    return [mobility(case, tolerance) for tolerance in TOLERANCES]


def mean_of_run(steps=60, spheres=60, fraction=0.4):
    """Mobility evaluations a step, the first three aside, which take four solves each."""
    edge = hard_spheres.box(spheres, fraction)
    with tempfile.TemporaryDirectory() as folder:
        ended = run(RUN.format(edge=edge, count=spheres, steps=steps), f"{folder}/run")
        if ended.returncode:
            raise SystemExit(ended.stderr)
        with open(f"{folder}/run/observables.csv") as file:
            counts = [float(row["iterations"]) + 1 for row in csv.DictReader(file)]
    return float(np.mean(counts[4:]))


def main():
    jobs = [(fraction, gap) for fraction in FRACTIONS for gap in GAPS]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(jobs, pool.map(count, jobs)))
    rows, failed = [], []
    for fraction in FRACTIONS:
        cells = [f"{fraction:.0%}"]
        for k in range(2):
            counts = [found[fraction, gap][k]["iterations"] for gap in GAPS]
            residuals = [found[fraction, gap][k]["residual"] for gap in GAPS]
            cells += [", ".join(map(str, counts)), f"{max(residuals):.0e}"]
            prototype = PROTOTYPE.get(fraction, (None, None))[k]
            cells.append("" if prototype is None else str(prototype))
            if prototype and max(counts) > MORE * prototype:
                failed.append(f"{max(counts)} iterations at {fraction:.0%}")
            if max(counts) > counts[0] + 3:
                failed.append(f"iterations grow as the gap shrinks at {fraction:.0%}")
        rows.append(cells)
    header = ["φ", "iterations", "residual", "prototype to 1e-3", "iterations", "residual", "prototype to 1e-6"]
    a_step = mean_of_run()
    lines = [
        f"Mobility evaluations for {SPHERES} spheres in shear, from nothing, with smallest gaps of "
        + ", ".join(f"{gap:g}" for gap in GAPS) + " radii:",
        "",
        *table(header, rows),
        "",
        f"In a sheared run at 40%, residual 1e-3, a step of 0.002 takes {a_step:.1f} evaluations on average.",
    ]
    write_section("lubrication.md", "iterations", "Iterations", lines)
    print("\n".join(lines))
    if a_step > MOST_A_STEP:
        failed.append(f"{a_step:.1f} evaluations a step")
    if failed:
        raise SystemExit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    main()
