"""What a run survives: sweeps of time step, concentration, ratio of sizes, repulsion and cutoff of lubrication, with both integrators;
starts that overlap, spheres pressed together, a cluster of touching spheres that settles, and a long shear of a dense suspension.
Each ends with its spheres where numbers are finite, or in an error that says what to change.

scripts/validate stability [--full]: the full sizes take hours. It fails if a number is not finite, if spheres overlap in adaptive steps
after the start, or if a run ends in an error that does not say what to change."""

import concurrent.futures
import csv
import math
import os
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from support.page import save, table, write_section
from support.program import run

FULL = "--full" in sys.argv[1:]
SPHERES, STRAIN, LONG = (24, 10.0, 100_000) if FULL else (24, 0.2, 200)
# What an error that helps says.
ADVICE = ("try", "change", "give", "set ", "take ", "larger", "smaller")
STEPS = (1e-4, 1e-3, 5e-3, 1e-2, 5e-2) if FULL else (1e-3, 5e-3, 1e-2, 5e-2)
FRACTIONS = (0.05, 0.2, 0.4, 0.5, 0.55) if FULL else (0.05, 0.2, 0.4, 0.5)
INTEGRATORS = ("adams-bashforth", "adaptive")
SCENE = """
seed = 11
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles.minimum_gap = 0.005
flow = {{ kind = "shear", rate = 1.0, lees_edwards = true }}
hydrodynamics = {{ tolerance = 1e-3, lubrication = true }}
output = {{ trajectory_every = 0, checkpoint_every = 0 }}
repulsion.strength = {strength}
species = [{species}]
time = {{ step = {step}, steps = {steps}, integrator = "{integrator}" }}
"""
ODD = """
box.edges = [16.0, 16.0, 16.0]
fluid.viscosity = 1.0
hydrodynamics = {{ tolerance = 1e-3, lubrication = true }}
output = {{ trajectory_every = 0, checkpoint_every = 0 }}
particles = {{ initial = "positions", positions = {positions} }}
time = {{ step = 0.02, steps = 50, integrator = "{integrator}" }}
species = [{species}]
{more}
"""


def sheared(integrator, step=5e-3, fraction=0.3, ratio=1.0, strength=100.0, steps=None):
    """A suspension of two sizes with half the volume each."""
    small = SPHERES if ratio == 1 else round(SPHERES / 2)
    kinds = [(1.0, small)] + ([] if ratio == 1 else [(ratio, max(2, round(small / ratio**3)))])
    volume = sum(count * 4 / 3 * math.pi * radius**3 for radius, count in kinds)
    species = ", ".join(f'{{ name = "{radius}", radius = {radius}, count = {count} }}' for radius, count in kinds)
    steps = steps or round(STRAIN / step)
    edge = max((volume / fraction) ** (1 / 3), 2.2 * ratio)
    return SCENE.format(edge=edge, strength=strength, species=species, step=step, steps=steps, integrator=integrator)


def cases():
    """(sweep, value, integrator, scene, overrides)."""
    for kind in INTEGRATORS:
        for step in STEPS:
            yield "time step", step, kind, sheared(kind, step=step), []
        for fraction in FRACTIONS:
            yield "volume fraction", fraction, kind, sheared(kind, fraction=fraction), []
        for ratio in (1.0, 2.0, 4.0):
            yield "ratio of radii", ratio, kind, sheared(kind, ratio=ratio), []
        for strength in (1.0, 10.0, 100.0, 1000.0):
            yield "repulsion", strength, kind, sheared(kind, strength=strength), []
        for cutoff in (0.2, 1.0, 2.5):
            yield "cutoff", cutoff, kind, sheared(kind), [f"hydrodynamics.lubrication_cutoff={cutoff}"]
        yield "weak repulsion at 40%", 1.0, kind, sheared(kind, fraction=0.4, strength=1.0, step=0.02, steps=round(5 * STRAIN / 0.02)), []
        yield "long run at 40%", LONG, kind, sheared(kind, fraction=0.4, step=2e-3, steps=LONG), []
        one = 'radius = 1.0, count = {}'
        yield "start that overlaps", 0, kind, ODD.format(
            positions="[[4, 8, 8], [5.9, 8, 8]]", species="{ " + one.format(2) + " }", more="", integrator=kind
        ), []
        pressed = '{ name = "right", radius = 1.0, count = 1, force = [50.0, 0, 0] }, '
        pressed += '{ name = "left", radius = 1.0, count = 1, force = [-50.0, 0, 0] }'
        for name, more in (("pressed together", ""), ("pressed, with repulsion", "repulsion.strength = 100.0")):
            yield name, 50, kind, ODD.format(
                positions="[[4, 8, 8], [6.1, 8, 8]]", species=pressed, more=more, integrator=kind
            ), []
        touching = "{ " + one.format(4) + ", force = [0, 5.0, -19.0] }"
        yield "touching cluster settles", 4, kind, ODD.format(
            positions="[[4, 8, 8], [6, 8, 8], [8, 8, 8], [8, 10, 8]]", species=touching,
            more="repulsion.strength = 20.0", integrator=kind,
        ), []


def outcome(case):
    """How the case ended: (steps, smallest gap, mean iterations, mean power over that of the fluid alone, all finite, message)."""
    _, _, _, scene, overrides = case
    with tempfile.TemporaryDirectory() as folder:
        ended = run(scene, f"{folder}/run", overrides)
        try:
            with open(f"{folder}/run/observables.csv") as file:
                rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        except FileNotFoundError:
            rows = []
    message = "" if ended.returncode == 0 else ended.stderr.strip().splitlines()[-1].removeprefix("error: ")
    if not rows:
        return 0, math.nan, math.nan, math.nan, True, message
    mean = lambda key: sum(row[key] for row in rows) / len(rows)
    finite = all(math.isfinite(value) for row in rows for key, value in row.items() if key != "smallest_gap")
    power = mean("relative_viscosity") if "relative_viscosity" in rows[0] else math.nan
    # Spheres may touch at the start, when nothing has moved yet.
    gap = min((row["smallest_gap"] for row in rows[1:]), default=math.nan)
    return int(rows[-1]["step"]), gap, mean("iterations"), power, finite, message


def draw(found):
    sweeps = ("time step", "volume fraction", "ratio of radii", "repulsion", "cutoff")
    figure, panels = plt.subplots(1, len(sweeps), figsize=(16, 3.4), layout="constrained", sharey=True)
    for axes, sweep in zip(panels, sweeps):
        for kind, mark in zip(INTEGRATORS, "ox"):
            points = [(case[1], result[1]) for case, result in found if case[0] == sweep and case[2] == kind]
            axes.plot([x for x, _ in points], [gap for _, gap in points], mark, fillstyle="none", label=kind)
        axes.set(xlabel=sweep, yscale="symlog", xscale="linear" if "ratio" in sweep or "fraction" in sweep else "log")
        axes.set_yscale("symlog", linthresh=1e-6)
        axes.axhline(0, color="0.7", linewidth=0.8)
    panels[0].set_ylabel("smallest gap of the run / a")
    panels[0].legend(fontsize=8)
    save(figure, "stability.png")


def main():
    listed = list(cases())
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(zip(listed, pool.map(outcome, listed)))
    draw(found)
    rows, failed = [], []
    for (sweep, value, kind, *_), (steps, gap, iterations, power, finite, message) in found:
        ended = message if message else ("to the end" if gap > 0 else "to the end, spheres overlap")
        numbers = ["" if math.isnan(x) else f"{x:{form}}" for x, form in ((gap, ".1e"), (iterations, ".1f"), (power, ".2f"))]
        rows.append([sweep, f"{value:g}", kind, str(steps), *numbers, ended])
        overlaps = kind == "adaptive" and gap <= 0
        helpless = message and not any(word in message for word in ADVICE)
        if not finite or overlaps or helpless:
            failed.append(f"{sweep} {value:g} {kind}")
    largest = {
        kind: max((case[1] for case, result in found if case[0] == "time step" and case[2] == kind and result[1] > 0 and not result[5]), default=0)
        for kind in INTEGRATORS
    }
    header = ["sweep", "value", "integrator", "steps", "smallest gap", "iterations", "power / fluid's", "ended"]
    lines = [
        f"{SPHERES} spheres unless said otherwise, sheared to a strain of {STRAIN:g} with a step of 0.005 at 30% and a repulsion of 100.",
        "",
        *table(header, rows),
        "",
        "Largest step without overlap: " + ", ".join(f"{kind} {step:g}" for kind, step in largest.items()) + ".",
        "",
        "![Smallest gaps](figures/stability.png)",
    ]
    write_section("lubrication.md", "stability", "Stability", lines)
    print("\n".join(lines))
    if failed:
        raise SystemExit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    main()
