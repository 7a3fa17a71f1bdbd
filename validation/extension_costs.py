"""Cost of extensions: processor time of a step with orientations, bodies, squirmers and dipoles over that without, timed in turns
on one thread; --rounds N."""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
from statistics import median

from support.page import table, write_section
from support.program import PROGRAM

COUNT, FRACTION = 970, 0.15
# Steps of the shorter run, and of the longer one.
STEPS = (10, 210)
SCENE = """seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
flow = {{ kind = "shear", rate = 1.0 }}
repulsion = {{ strength = 1.0, range = 0.1 }}
particles = {{ initial = "random", minimum_gap = 0.05 }}
hydrodynamics = {{ tolerance = 1e-3, lubrication = {lubrication} }}
time = {{ step = 0.002, steps = {steps} }}
output = {{ trajectory_every = 0, checkpoint_every = 0, observables_every = {steps} }}
"""
SPHERES = f"""[[species]]
radius = 1.0
count = {COUNT}
"""
DUMBBELLS = f"""[[bodies]]
shape = "rod"
spheres = 2
radius = 1.0
gap = 0.1
count = {COUNT // 2}
"""
ORIENTED = SPHERES + 'orientation = "random"\n'
PERMANENT = "[magnetic]\nfield = [0.0, 0.0, 1.0]\n" + ORIENTED + "magnetic_moment = 1.0\n"
INDUCED = "[magnetic]\nfield = [0.0, 0.0, 1.0]\n" + SPHERES + "magnetic_susceptibility = 3.0\n"
SQUIRMERS = ORIENTED + "swimming = { speed = 1.0, beta = 1.0 }\n"
PASSIVE = "spheres alone"
CASES = {
    PASSIVE: SPHERES,
    "orientations": ORIENTED,
    "dumbbells": DUMBBELLS,
    "squirmers": SQUIRMERS,
    "permanent dipoles": PERMANENT,
    "induced dipoles": INDUCED,
}


def user_seconds(folder, text):
    """Processor time of a run outside of the system."""
    scene = folder / "scene.toml"
    scene.write_text(text)
    command = [PROGRAM, "run", str(scene), "--out", str(folder / "out"), "--force", "--threads", "1", "--quiet"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"a run failed:\n{text}")
    return usage.ru_utime


def milliseconds_per_step(folder, species, lubrication):
    """From two runs that differ in their length."""
    edge = (COUNT * 4.18879 / FRACTION) ** (1 / 3)
    times = [
        user_seconds(folder, SCENE.format(edge=f"{edge:.4f}", lubrication=lubrication, steps=steps) + species)
        for steps in STEPS
    ]
    return 1e3 * (times[1] - times[0]) / (STEPS[1] - STEPS[0])


def rows(rounds, chosen):
    """The rows of the table; each round times all cases in turn."""
    taken = {(name, lubrication): [] for name in chosen for lubrication in ("false", "true")}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            for name, lubrication in taken:
                taken[name, lubrication].append(milliseconds_per_step(pathlib.Path(folder), CASES[name], lubrication))
    for name in chosen:
        cells = [name]
        for lubrication in ("false", "true"):
            own, passive = taken[name, lubrication], taken[PASSIVE, lubrication]
            cells += [f"{median(own):.2f}", f"{median(a / b for a, b in zip(own, passive)):.2f}"]
        print(*cells, flush=True)
        yield cells


def main():
    parser = argparse.ArgumentParser(prog="scripts/validate extension-costs", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="number of rounds [5]")
    parser.add_argument("--only", help="print the costs of one extension alone, and leave the page as it is")
    arguments = parser.parse_args()
    chosen = [name for name in CASES if arguments.only in (None, name) or name == PASSIVE]
    header = ["extension", "ms", "over spheres alone", "lubricated, ms", "over lubricated spheres"]
    lines = [
        f"{COUNT} spheres at {100 * FRACTION:g}% in shear, tolerance 1e-3: processor time of a step on one thread, from the difference",
        f"of runs of {STEPS[1]} and {STEPS[0]} steps, and its ratio to that of spheres without the extension; medians of",
        f"{arguments.rounds} rounds, in which the cases took turns. Dumbbells are of two spheres with a gap of 0.1.",
        "",
        *table(header, list(rows(arguments.rounds, chosen))),
    ]
    if arguments.only is None:
        write_section("costs.md", "extension-costs", "Extensions", lines, " ".join(["scripts/validate extension-costs", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
