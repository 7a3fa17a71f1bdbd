"""Time of a step with lubrication: spheres in shear, compared with the same step without lubrication, on two threads and on two ranks.

Steps of the Adams-Bashforth method are timed, each with one solve that starts from previous solutions: a run makes the starting
steps, and its continuations are timed in turns. `scripts/validate step-times 1000` times only that many spheres, at 20% and a
tolerance of 1e-3."""

import csv
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from support.page import table, write_section
from support.program import PROGRAM, run

# Numbers of spheres with their volume fractions and tolerances.
CASES = [(500, 0.2, 1e-3), (1_000, 0.2, 1e-3), (5_280, 0.2, 1e-2), (10_000, 0.2, 1e-3), (100_000, 0.2, 1e-3), (50_000, 0.1, 1e-3)]
# Starting steps (Runge-Kutta, and one more); rounds of measurements in turns.
START, ROUNDS = 4, 5


def timed_steps(count):
    """Number of timed steps, larger for few spheres."""
    return max(4, min(40, 100_000 // count))
# Ways to run a step: with lubrication or without, ranks, threads.
WAYS = {"one": (True, 1, 1), "far field": (False, 1, 1), "threads": (True, 1, 2), "ranks": (True, 2, 1)}


def scene(count, fraction, tolerance, lubrication):
    edge = (count * 4 / 3 * np.pi / fraction) ** (1 / 3)
    return f"""
seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.01 }}
flow = {{ kind = "shear", rate = 1.0, lees_edwards = true }}
repulsion.strength = 60.0
hydrodynamics = {{ tolerance = {tolerance:g}, lubrication = {str(lubrication).lower()} }}
time = {{ step = 0.005, steps = {START} }}
output = {{ trajectory_every = 0, checkpoint_every = {START} }}
[[species]]
radius = 1.0
count = {count}
"""


def start(folder, case, lubrication):
    """A run that has made its first steps."""
    ended = run(scene(*case, lubrication), folder)
    if ended.returncode:
        raise SystemExit(ended.stderr)
    return folder


def timed(begun, steps, ranks, threads):
    """Median seconds, and mean evaluations of the mobility, of the steps that continue from the starting steps."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        shutil.copytree(begun, out)
        launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
        command = [*launcher, PROGRAM, "resume", str(out), "--steps", str(START + steps), "--threads", str(threads)]
        subprocess.run(command, check=True, capture_output=True)
        with open(out / "observables.csv") as file:
            rows = list(csv.DictReader(file))[START + 1 :]
    return np.median([float(row["seconds_per_step"]) for row in rows]), np.mean([float(row["evaluations"]) for row in rows])


def measured(case):
    """Medians over the rounds by way: seconds, evaluations."""
    with tempfile.TemporaryDirectory() as folder:
        begun = {lubrication: start(pathlib.Path(folder) / str(lubrication), case, lubrication) for lubrication in (True, False)}
        rounds = [[timed(begun[lubricated], timed_steps(case[0]), *shares) for lubricated, *shares in WAYS.values()] for _ in range(ROUNDS)]
    return dict(zip(WAYS, np.median(rounds, axis=0)))


def main():
    rows = []
    for count, fraction, tolerance in [(int(size), 0.2, 1e-3) for size in sys.argv[1:]] or CASES:
        found = measured((count, fraction, tolerance))
        seconds = {way: found[way][0] for way in WAYS}
        one = seconds["one"]
        ratios = [one / seconds[way] for way in ("far field", "threads", "ranks")]
        rows.append([f"{count:,}", f"{fraction:.0%}", f"{tolerance:.0e}", f"{one:.3g}", *(f"{ratio:.2f}" for ratio in ratios),
                     f"{seconds['threads']:.3g}", f"{found['one'][1]:.1f}", f"{1e6 * one / count:.0f}"])
        print(*rows[-1], flush=True)
    header = ["spheres", "φ", "tolerance", "s per step", "relative to no lubrication", "speed-up, two threads", "two ranks", "s, two threads",
              "evaluations per step", "µs per sphere"]
    lines = [
        f"Spheres in shear, steps of 0.005 over the shear rate, on one thread of one rank unless stated otherwise. Medians of {ROUNDS}",
        f"rounds of 4 to 40 steps, measured in turns on a machine with {os.cpu_count()} cores.",
        "",
        *table(header, rows),
    ]
    write_section("lubrication.md", "step-times", "Time of a step", lines)


if __name__ == "__main__":
    main()
