"""Runs of a million spheres and more on two ranks: seconds of the start and of a step, and the peak of memory of each rank.

`scripts/validate millions` runs one million spheres; `--full` also four million, which takes 12 GB and a quarter of an hour.
`scripts/validate millions --lubricated` takes ten steps of a quarter of a million to four million spheres with lubrication instead, which
takes 18 GB and 20 minutes; given numbers of spheres, it writes no page."""

import argparse
import csv
import json
import pathlib
import subprocess
import tempfile
import time

from memory import spheres
from support.page import table, write_section
from support.peak import measured, predicted
from support.program import PROGRAM, ROOT

RANKS, STEPS = 2, 10
SIZES, MORE = (1_000_000,), (4_000_000,)
LUBRICATED = (250_000, 1_000_000, 4_000_000)
FRACTION = 0.12
# Allowed seconds for a million random positions, and peak bytes of a rank in a run with them.
START, PEAK = 10.0, 1.5e9
EXAMPLE = pathlib.Path(PROGRAM).parent / "examples" / "random_start"
BUILD = ["cargo", "build", "--quiet", "--release", "--package", "fcm-solve-domain", "--features", "mpi", "--example", "random_start"]


def start(count):
    """Seconds to find random positions of spheres."""
    command = ["mpirun", "-n", str(RANKS), EXAMPLE, str(count), str(FRACTION)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["seconds"]


def step(words):
    """Seconds of the last step of a run with a row of the time series each step."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        command = ["mpirun", "-n", str(RANKS), PROGRAM, "run", *words, "--threads", "1", "--out", out]
        subprocess.run([*command, "--set", "output.observables_every=1"], check=True, capture_output=True)
        rows = list(csv.DictReader((out / "observables.csv").open()))
    return float(rows[-1]["seconds_per_step"])


def lubricated(count):
    """Steps of lubricated spheres: seconds of the run with its start, and the predicted peak and those of each rank."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.toml"
        path.write_text(spheres(count, "split", True))
        words = [path]
        for item in ("hydrodynamics.tolerance=0.01", "hydrodynamics.lubrication_cutoff=0.2", f"time.steps={STEPS}", "output.trajectory_every=0"):
            words += ["--set", item]
        expected, began = predicted(PROGRAM, [*words, "--no-trial"], RANKS)[0], time.monotonic()
        peaks = measured(PROGRAM, words, RANKS)
        cells = [f"{count:,}", f"{time.monotonic() - began:.0f}", *(f"{peak / 1e9:.2f}" for peak in (expected, *peaks))]
    print(*cells, sep="  ", flush=True)
    return cells


def write_lubricated(rows):
    header = ["spheres", f"run of {STEPS} steps, s", "predicted, GB", "first rank, GB", "second, GB"]
    lines = [
        "Spheres at 12% that settle at a tolerance of 1e-2, with lubrication at gaps of up to a fifth of a radius; seconds with the start.",
        "",
        *table(header, rows),
    ]
    title, command = "Millions of lubricated spheres on two ranks", "scripts/validate millions --lubricated"
    write_section("scale.md", "millions-lubricated", title, lines, command)


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--full", action="store_true", help="also four million spheres")
    arguments.add_argument("--lubricated", type=int, nargs="*", metavar="COUNT", help="steps of spheres with lubrication instead")
    asked = arguments.parse_args()
    if asked.lubricated is not None:
        rows = [lubricated(count) for count in asked.lubricated or LUBRICATED]
        if not asked.lubricated:
            write_lubricated(rows)
        return
    subprocess.run(BUILD, check=True, cwd=ROOT)
    rows, wrong = [], []
    for count in SIZES + MORE * asked.full:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.toml"
            path.write_text(spheres(count, "split", False))
            began = time.monotonic()
            peaks = measured(PROGRAM, [path], RANKS)
            whole = time.monotonic() - began
            row = [start(count), step([path]), whole, predicted(PROGRAM, [path], RANKS)[0], *peaks]
        rows.append([f"{count:,}", *(f"{value:.1f}" for value in row[:3]), *(f"{value / 1e9:.2f}" for value in row[3:])])
        print(*rows[-1], sep="  ", flush=True)
        if count == SIZES[0] and (row[0] > START or max(peaks) > PEAK):
            wrong.append(rows[-1])
    header = ["spheres", "initial positions, s", "step, s", "run of two steps, s", "predicted, GB", "first rank, GB", "second, GB"]
    write_section("scale.md", "millions", "Millions of spheres on two ranks", table(header, rows))
    if wrong:
        raise SystemExit(f"failed: more than {START} s or {PEAK / 1e9} GB: {wrong}")


if __name__ == "__main__":
    main()
