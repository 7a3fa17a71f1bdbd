"""Settling velocity at 5% by volume, the question of the tutorial: runs that test its time step, tolerance, random start and
box. The output of its commands is made by `scripts/validate pages tutorial`."""

import csv
import pathlib
import re
import subprocess
import sys
import tempfile

from support.page import BOOK, table, write_section
from support.program import PROGRAM

SCENE = BOOK / "tutorial.toml"
FULL = "--full" in sys.argv
# Names of the runs, and the keys in which they differ from the scene.
RUNS = {
    "the scene": {},
    "half the step": {"time.step": 0.015, "statistics.every": 20},
    "a tenth of the tolerance": {"hydrodynamics.tolerance": 1e-4},
    "another random start": {"seed": 2},
    "a third random start": {"seed": 3},
    "four times as many spheres": {"species[0].count": 1000, "box.edges": "[43.75, 43.75, 43.75]"},
}


def said(*words):
    """Standard output of a command."""
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def settled(folder, keys):
    """The mean downward velocity of a run with some keys set, its error, and whether the error has converged."""
    duration = {} if FULL else {"time.duration": 45, "statistics.from": 15}
    sets = [word for key, value in (duration | keys).items() for word in ("--set", f"{key}={value}")]
    said("run", SCENE, "--out", folder, *sets)
    with open(folder / "statistics" / "summary.csv", newline="") as file:
        row = next(row for row in csv.DictReader(file) if row["quantity"] == "mean_velocity_z")
    return -float(row["value"]), float(row["error"]), float(row["converged"]) == 1


def edge(keys):
    """The box's edge with some keys set."""
    return float(re.search(r"[\d.]+", keys.get("box.edges", "27.56"))[0])


def unbounded(found):
    """The velocity in an infinite box and its error, by linear extrapolation in the inverse edge."""
    (small, error, _), (large, other, _) = found["the scene"], found["four times as many spheres"]
    near, far = 1 / edge(RUNS["the scene"]), 1 / edge(RUNS["four times as many spheres"])
    weight = near / (near - far)
    return small + (large - small) * weight, (((1 - weight) * error) ** 2 + (weight * other) ** 2) ** 0.5


def row(name, value, error, converged):
    """A line of the table."""
    return [name, f"{edge(RUNS[name]):g}", f"{value:.4f}", f"{'' if converged else 'at least '}{error:.4f}"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder)
        found = {name: settled(place / name.replace(" ", "-"), keys) for name, keys in RUNS.items()}
    rows = [row(name, *values) for name, values in found.items()]
    rows.append(["infinite box, extrapolated", "", *(f"{number:.4f}" for number in unbounded(found))])
    lines = table(["run", "edge", "mean downward velocity", "error"], rows)
    write_section("tutorial.md", "tutorial", "The table", lines)
    print("\n".join(lines))


main()
