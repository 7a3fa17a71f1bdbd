"""Coverage of the errors that runs print: the frequency with which the true mean lies within them, from random
starts of a scene, each cut to short lengths.

A scene is run from many starts. Its true mean is that over all of these runs after their transients, at their full length. A short
run is a part of one, from its start, where `fcm-solve stats` has to find the transient, or between two times. A family is a
quantity of a scene in such a part. Answers with the verdict that they drift claim no steady state, and are counted separately.

With `--full` there are more starts and lengths."""

import concurrent.futures
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
from dataclasses import dataclass

import numpy as np
from support.page import table, write_section
from support.program import PROGRAM, run

FULL = "--full" in sys.argv[1:]
STARTS = 144 if FULL else 48
# Parts of a run that are short runs, of its length, and the part after which the rest is surely steady.
STARTING = ((0.0, 0.25), (0.0, 0.5), (0.0, 1.0))
STEADY = 0.25
PARTS = (*STARTING, *((k * STEADY, (k + 1) * STEADY) for k in (1, 2, 3)), (STEADY, 1.0))
# Allowed coverage of one error and of two.
WANTED = ((0.60, 0.76), (0.90, 0.98))


@dataclass
class Kind:
    """A scene as text, the time at its end, and the answers that are compared, each with the column of which it is the mean, in its sign."""

    fraction: float
    count: int
    keys: str
    end: float
    quantities: dict


SHEAR = ("relative_viscosity", "first_normal_stress_difference", "particle_pressure")
KINDS = {
    "settling at 10%": Kind(
        0.10,
        50,
        "time = { step = 0.1, steps = 1500, order = 2 }\nrepulsion = { strength = 160.0, range = 0.2 }\nhydrodynamics.tolerance = 1e-2",
        150.0,
        {"settling_velocity": lambda table: -table["mean_velocity_z[sphere]"]},
    ),
    "shear at 30%": Kind(
        0.30,
        50,
        "time = { step = 0.02, steps = 1500 }\nflow = { kind = \"shear\", rate = 1.0 }\nrepulsion = { strength = 20.0, range = 0.1 }\n"
        "hydrodynamics.tolerance = 1e-2",
        30.0,
        {name: lambda table, name=name: table[name] for name in SHEAR},
    ),
    "dense shear at 45%, friction 0.5": Kind(
        0.45,
        40,
        "time = { step = 0.01, steps = 600 }\nflow = { kind = \"shear\", rate = 1.0 }\ncontacts.friction = 0.5\n"
        "hydrodynamics = { lubrication = true, tolerance = 1e-2 }",
        6.0,
        {name: lambda table, name=name: table[name] for name in SHEAR},
    ),
    "Brownian motion at 20%": Kind(
        0.20,
        40,
        "time = { step = 0.05, steps = 1500 }\nfluid.thermal_energy = 1.0\nrepulsion = { strength = 60.0, screening_length = 0.1 }\n"
        "hydrodynamics.tolerance = 1e-2",
        75.0,
        {"osmotic_pressure": lambda table: table["osmotic_pressure"]},
    ),
}


def scene(kind, seed):
    edge = (4 / 3 * math.pi * kind.count / kind.fraction) ** (1 / 3)
    force = "force = [0.0, 0.0, -18.84955592153876]\n" if "settling_velocity" in kind.quantities else ""
    viscosity = "fluid.viscosity = 1.0\n"
    return (
        f"seed = {seed}\nbox.edges = [{edge}, {edge}, {edge}]\n{viscosity}{kind.keys}\n"
        "output = { trajectory_every = 0, observables_every = 2, checkpoint_every = 0 }\n"
        f'[[species]]\nname = "sphere"\nradius = 1.0\ncount = {kind.count}\n{force}'
    )


def answers(folder, begin, until):
    """Answers by quantity between two times; if that is from the start, `stats` excludes the transient that it detects."""
    command = [PROGRAM, "stats", str(folder), "--json", "--until", repr(until), *(["--from", repr(begin)] if begin else [])]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return {answer["quantity"]: answer for answer in found["answers"]}


def column_means(folder, kind):
    """The means of the quantities over the steady part of a run."""
    columns = np.genfromtxt(folder / "observables.csv", delimiter=",", names=True, deletechars="", dtype=float)
    steady = columns[columns["time"] >= STEADY * kind.end]
    return {name: float(np.mean(of(steady))) for name, of in kind.quantities.items()}


def one(job):
    """The steady means of a run, and its answers by part and quantity."""
    name, seed, place = job
    kind, folder = KINDS[name], pathlib.Path(place) / f"{name.split()[0]}-{seed}"
    done = run(scene(kind, seed), folder)
    if done.returncode != 0:
        raise SystemExit(f"{name}, seed {seed}: {done.stderr}")
    found = {part: answers(folder, part[0] * kind.end, part[1] * kind.end) for part in PARTS}
    return column_means(folder, kind), found


def families(name, place):
    """The rows of a scene: for each family the coverage of one error and of two, the numbers of answers, the mean error and the spread."""
    kind = KINDS[name]
    jobs = [(name, seed, place) for seed in range(1, STARTS + 1)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = list(pool.map(one, jobs))
    rows = []
    for quantity in kind.quantities:
        truth = np.mean([means[quantity] for means, _ in runs])
        for part in PARTS:
            given = [of[part][quantity] for _, of in runs if of[part][quantity]["value"] is not None]
            found = [answer for answer in given if answer["verdict"] != "drifting"]
            values, errors = (np.array([answer[key] for answer in found]) for key in ("value", "error"))
            inside = [np.mean(abs(values - truth) <= k * errors) if found else math.nan for k in (1, 2)]
            spread = math.sqrt(np.mean((values - truth) ** 2)) if found else math.nan
            error = np.mean(errors) if found else math.nan
            span = f"{part[0] * kind.end:g} to {part[1] * kind.end:g}"
            rows.append((name, quantity, span, truth, spread, error, len(found), len(given) - len(found), inside))
    return rows


def main():
    with tempfile.TemporaryDirectory() as place:
        rows = [row for name in KINDS for row in families(name, place)]
    counted = sum(row[6] for row in rows)
    shares = [sum(row[8][k] * row[6] for row in rows if row[6]) / counted for k in (0, 1)]
    cells = [
        [name, quantity.replace("_", " "), span, f"{truth:.3g}", f"{spread:.2g}", f"{error:.2g}", f"{count}", f"{drifting}"]
        + [f"{share:.0%}" for share in inside]
        for name, quantity, span, truth, spread, error, count, drifting, inside in rows
    ]
    lines = [
        f"Each scene of 40 to 50 spheres was run from {STARTS} random starts, in small boxes so that fluctuations are large. A family",
        f"is one quantity in one part of the runs. In {len(rows)} families {counted} answers claim a steady state; the true mean lies within",
        f"one error in {shares[0]:.0%} of them and within two errors in {shares[1]:.0%}. The answers with the verdict *drifting* are counted",
        "separately.",
        "",
        *table(
            ["scene", "quantity", "times", "true mean", "spread", "mean error", "answers", "drifting", "within one error", "within two"], cells
        ),
    ]
    write_section("answers.md", "coverage", "Coverage of the errors", lines)
    print("\n".join(lines))
    if not all(low <= share <= high for share, (low, high) in zip(shares, WANTED)):
        raise SystemExit(f"failed: inside one error in {shares[0]:.1%}, inside two in {shares[1]:.1%}")


if __name__ == "__main__":
    main()
