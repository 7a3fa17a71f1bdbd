"""Seconds of a step with lubrication: spheres at 20% in shear, tolerance 1e-3.

Steps of the Adams-Bashforth method are timed, each with one solve that starts from those before: a run makes the steps of the
start, and what goes on with it is timed. `scripts/validate step-times 1000` times that many spheres alone."""

import csv
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from support.page import table, write_section
from support.program import PROGRAM, run

SIZES, FRACTION = (500, 1000, 10000, 100000), 0.2
# Steps by the method of Runge and Kutta and one more, and steps that are timed.
START, TIMED = 4, 4


def scene(count):
    edge = (count * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
    return f"""
seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.01 }}
flow = {{ kind = "shear", rate = 1.0, lees_edwards = true }}
repulsion.strength = 60.0
hydrodynamics = {{ tolerance = 1e-3, lubrication = true }}
time = {{ step = 0.005, steps = {START} }}
output = {{ trajectory_every = 0, checkpoint_every = {START} }}
[[species]]
radius = 1.0
count = {count}
"""


def timed(count):
    """Median seconds, and mean evaluations of the mobility, of a step."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        ended = run(scene(count), out)
        if ended.returncode:
            raise SystemExit(ended.stderr)
        command = [PROGRAM, "resume", str(out), "--steps", str(START + TIMED), "--threads", "1"]
        subprocess.run(command, check=True, capture_output=True)
        with open(out / "observables.csv") as file:
            rows = list(csv.DictReader(file))[START + 1 :]
    return np.median([float(row["seconds_per_step"]) for row in rows]), np.mean([float(row["evaluations"]) for row in rows])


def main():
    rows = []
    for count in [int(size) for size in sys.argv[1:]] or SIZES:
        seconds, evaluations = timed(count)
        rows.append([f"{count:,}", f"{seconds:.3g}", f"{evaluations:.1f}", f"{1e6 * seconds / count:.0f}"])
        print(*rows[-1], flush=True)
    header = ["spheres", "seconds a step", "evaluations a step", "microseconds a sphere"]
    lines = ["Spheres at 20% in shear, tolerance 1e-3, steps of 0.005 over the rate; one thread.", "", *table(header, rows)]
    write_section("lubrication.md", "step-times", "Seconds of a step", lines)


if __name__ == "__main__":
    main()
