"""Cost of a step: seconds and memory by number of spheres, volume fraction and tolerance, with lubrication and without. One thread,
sheared, fixed steps from a random start. Needs a machine without other load; --full takes long."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from support.page import table, write_section
from support.program import PROGRAM

FULL = "--full" in sys.argv
COUNTS = (100, 1000, 10_000, 100_000) if FULL else (100, 1000)
TOLERANCES = (1e-2, 1e-3, 1e-6) if FULL else (1e-2, 1e-3)
# Steps of the shorter run, and additional sphere steps of the longer one: enough to exceed the variation of the start-up time.
STEPS, MORE = 12, 200_000
SCENE = """
title = "Cost of a step"
[box]
edges = [{edge}, {edge}, {edge}]
[fluid]
viscosity = 1.0
[[species]]
radius = 1.0
count = {count}
[flow]
kind = "shear"
rate = 1.0
[repulsion]
strength = 1.0
range = 0.1
[hydrodynamics]
tolerance = {tolerance}
lubrication = {lubrication}
[time]
step = 0.001
steps = {steps}
[output]
trajectory_every = 0
checkpoint_every = 0
observables_every = {steps}
"""


def seconds(scene, folder):
    """Wall time of a run."""
    begin = time.perf_counter()
    command = [PROGRAM, "run", str(scene), "--out", str(folder), "--force", "--threads", "1"]
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - begin


def measured(folder, **values):
    """Seconds per step, from two runs that differ in their length, and predicted memory in MB."""
    times, more = [], max(STEPS, MORE // values["count"])
    scene = folder / "scene.toml"
    for steps in (STEPS, STEPS + more):
        scene.write_text(SCENE.format(steps=steps, **values))
        times.append(min(seconds(scene, folder / "out") for _ in range(2)))
    outline = subprocess.run([PROGRAM, "check", str(scene), "--json", "--no-trial"], check=True, capture_output=True, text=True)
    return (times[1] - times[0]) / more, json.loads(outline.stdout)["memory_bytes"][0] / 1e6


def rows():
    for count in COUNTS:
        for fraction in (0.05, 0.2, 0.4):
            edge = (count * 4.18879 / fraction) ** (1 / 3)
            for tolerance in TOLERANCES:
                values = {"count": count, "edge": f"{edge:.4f}", "tolerance": tolerance}
                with tempfile.TemporaryDirectory() as folder:
                    place = pathlib.Path(folder)
                    plain, memory = measured(place, lubrication="false", **values)
                    lubricated, more = measured(place, lubrication="true", **values)
                numbers = [f"{1e3 * plain:.3g}", f"{1e3 * lubricated:.3g}", f"{memory:.0f}", f"{more:.0f}"]
                print(count, fraction, tolerance, *numbers, flush=True)
                yield [f"{count:,}", f"{100 * fraction:g}%", re.sub("e-0", "e-", f"{tolerance:.0e}"), *numbers]


HEADER = ["spheres", "by volume", "tolerance", "ms per step", "ms with lubrication", "MB", "MB with lubrication"]
write_section("costs.md", "costs", "Time per step and memory, one thread", table(HEADER, list(rows())))
