"""Stability of runs: sweeps of time step, concentration, size ratio, repulsion, its range and the cutoff of lubrication, with both
integrators; starts with overlaps, spheres pressed together, and a cluster of touching spheres that settles. Each run must end
with finite positions, or with an error that gives advice.

scripts/validate stability [--full]: --full has more spheres and more strain. It fails if a number is not finite, if the
power is negative, if spheres overlap in adaptive steps after the start, or if a run ends with an error that
gives no advice."""

import concurrent.futures
import csv
import math
import os
import sys
import tempfile
from dataclasses import dataclass, field

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from support.page import save, table, write_section
from support.program import run

FULL = "--full" in sys.argv[1:]
SPHERES, STRAIN = (64, 2.0) if FULL else (24, 0.2)
# Limits of the number of steps in sweeps of the time step.
FEWEST, MOST = (100, 4000) if FULL else (10, 200)
# Words in a helpful error message.
ADVICE = ("try", "change", "give", "set ", "take ", "larger", "smaller")
STEPS = (1e-4, 1e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1, 0.2)
FRACTIONS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.55)
RATIOS, STRENGTHS, RANGES, CUTOFFS = (1, 1.5, 2, 3, 4), (0, 1, 10, 100, 1000), (0.01, 0.025, 0.1), (0.2, 0.5, 1, 2.5)
PRESSED_STEPS = (0.02, 0.05, 0.1, 0.2, 0.5, 1)
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
time = {{ step = {step}, steps = {steps}, integrator = "{integrator}" }}
species = [{species}]
{more}
"""


@dataclass
class Case:
    """A run to be made: one value of a sweep with one integrator."""

    sweep: str
    value: float
    integrator: str
    scene: str
    overrides: list = field(default_factory=list)
    # Forces by species, if they move the spheres.
    forces: dict = field(default_factory=dict)


@dataclass
class Outcome:
    """End of a run."""

    message: str
    finite: bool = True
    steps: int = 0
    overlaps: int = 0
    gap: float = math.nan
    iterations: float = math.nan
    # Mean and least power, relative to that of the fluid alone in shear or of isolated spheres under their forces.
    power: float = math.nan
    least_power: float = math.nan

    def is_stable(self):
        return not self.message and self.finite and not self.overlaps


def sheared(integrator, step=5e-3, fraction=0.3, ratio=1, strength=100, steps=None):
    """A suspension, of two sizes with half the volume each if `ratio` is not 1."""
    small = SPHERES if ratio == 1 else round(SPHERES / 2)
    kinds = [(1.0, small)] + ([] if ratio == 1 else [(ratio, max(2, round(small / ratio**3)))])
    volume = sum(count * 4 / 3 * math.pi * radius**3 for radius, count in kinds)
    species = ", ".join(f'{{ name = "{radius:g}", radius = {radius}, count = {count} }}' for radius, count in kinds)
    steps = steps or round(STRAIN / step)
    edge = max((volume / fraction) ** (1 / 3), 2.2 * ratio)
    return SCENE.format(edge=edge, strength=strength, species=species, step=step, steps=steps, integrator=integrator)


def sweeps(kind):
    """Suspensions in shear."""
    for fraction in (0.3, 0.45):
        for step in STEPS:
            steps = min(max(round(STRAIN / step), FEWEST), MOST)
            yield Case(f"time step at {fraction:.0%}", step, kind, sheared(kind, step, fraction, steps=steps))
    for fraction in FRACTIONS:
        yield Case("volume fraction", fraction, kind, sheared(kind, fraction=fraction))
    for ratio in RATIOS:
        yield Case("ratio of radii", ratio, kind, sheared(kind, ratio=ratio))
    for strength in STRENGTHS:
        yield Case("repulsion", strength, kind, sheared(kind, strength=strength))
    for reach in RANGES:
        yield Case("range of repulsion", reach, kind, sheared(kind), [f"repulsion.range={reach}"])
    for cutoff in CUTOFFS:
        yield Case("cutoff of lubrication", cutoff, kind, sheared(kind), [f"hydrodynamics.lubrication_cutoff={cutoff}"])
    weak = sheared(kind, step=0.02, fraction=0.4, strength=1, steps=round(5 * STRAIN / 0.02))
    yield Case("weak repulsion at 40%", 1, kind, weak)


def single(name, count, force):
    return f'{{ name = "{name}", radius = 1.0, count = {count}, force = {list(force)} }}'


def odd(kind):
    """Two spheres that overlap at the start or are pressed together, and a cluster that sediments."""
    resting = {"kept": (0.0, 0.0, 0.0)}
    pressed = {"right": (50.0, 0.0, 0.0), "left": (-50.0, 0.0, 0.0)}
    falling = {"cluster": (0.0, 5.0, -19.0)}
    near = "[[4, 8, 8], [6.1, 8, 8]]"
    bent = "[[4, 8, 8], [6, 8, 8], [8, 8, 8], [8, 10, 8]]"

    def scene(positions, forces, count, step, steps, more=""):
        species = ", ".join(single(name, count, force) for name, force in forces.items())
        return ODD.format(positions=positions, species=species, step=step, steps=steps, more=more, integrator=kind)

    overlapping = scene("[[4, 8, 8], [5.9, 8, 8]]", resting, 2, 0.02, 50)
    yield Case("overlapping start", 0.1, kind, overlapping)
    for step in PRESSED_STEPS:
        alone = scene(near, pressed, 1, step, 50)
        repelled = scene(near, pressed, 1, step, 50, "repulsion.strength = 100.0")
        yield Case("time step, pressed together", step, kind, alone, forces=pressed)
        yield Case("time step, pressed, with repulsion", step, kind, repelled, forces=pressed)
    settling = scene(bent, falling, 4, 0.02, 200, "repulsion.strength = 20.0")
    yield Case("settling cluster of touching spheres", 4, kind, settling, forces=falling)


def cases():
    for kind in INTEGRATORS:
        yield from sweeps(kind)
        yield from odd(kind)


def powers(case, rows):
    """The power of each row: that of the flow over that of the fluid alone, or that of the forces over that of single spheres."""
    if not case.forces:
        return [row["relative_viscosity"] for row in rows if "relative_viscosity" in row]

    def done(row):
        return sum(f * row[f"mean_velocity_{axis}[{name}]"] for name, force in case.forces.items() for axis, f in zip("xyz", force))

    alone = sum(sum(f * f for f in force) / (6 * math.pi) for force in case.forces.values())
    return [done(row) / alone for row in rows]


def outcome(case):
    with tempfile.TemporaryDirectory() as folder:
        ended = run(case.scene, f"{folder}/run", case.overrides)
        try:
            with open(f"{folder}/run/observables.csv") as file:
                rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
        except FileNotFoundError:
            rows = []
    message = "" if ended.returncode == 0 else ended.stderr.strip().splitlines()[-1].removeprefix("error: ")
    # Spheres may touch at the start, when nothing has moved yet.
    moved = rows[1:]
    if not moved:
        return Outcome(message)
    gaps, power = [row["smallest_gap"] for row in moved], powers(case, moved)
    return Outcome(
        message,
        finite=all(math.isfinite(value) for row in rows for key, value in row.items() if key != "smallest_gap"),
        steps=int(rows[-1]["step"]),
        overlaps=sum(gap <= 0 for gap in gaps),
        gap=min(gaps),
        iterations=sum(row["iterations"] for row in moved) / len(moved),
        power=sum(power) / len(power),
        least_power=min(power),
    )


def draw(found):
    names = ("time step at 30%", "volume fraction", "ratio of radii", "repulsion", "cutoff of lubrication", "time step, pressed together")
    figure, panels = plt.subplots(2, len(names), figsize=(17, 6), layout="constrained", sharey="row", sharex="col")
    for column, sweep in zip(panels.T, names):
        for kind, mark in zip(INTEGRATORS, "ox"):
            points = [(case.value, ended) for case, ended in found if case.sweep == sweep and case.integrator == kind]
            for axes, quantity in zip(column, ("gap", "power")):
                axes.plot([x for x, _ in points], [getattr(y, quantity) for _, y in points], mark, fillstyle="none", label=kind)
        column[1].set(xlabel=sweep, xscale="linear" if "ratio" in sweep or "fraction" in sweep else "symlog" if sweep == "repulsion" else "log")
        column[0].set_yscale("symlog", linthresh=1e-7)
        column[0].set_yticks([-1, -1e-2, -1e-4, -1e-6, 0, 1e-6, 1e-4, 1e-2, 1])
        column[1].set_yscale("log")
        column[0].axhline(0, color="0.7", linewidth=0.8)
    panels[0, 0].set_ylabel("smallest gap of the run / a")
    panels[1, 0].set_ylabel("power / that without interactions")
    panels[0, 0].legend(fontsize=8)
    save(figure, "stability.png")


def row(case, ended):
    outcome = ended.message or ("completed, spheres overlap" if ended.overlaps else "completed")
    numbers = ((ended.gap, ".1e"), (ended.power, ".3g"), (ended.iterations, ".1f"))
    cells = ["" if math.isnan(x) else f"{x:{form}}" for x, form in numbers]
    return [case.sweep, f"{case.value:g}", case.integrator, f"{ended.steps:,}", f"{ended.overlaps:,}", *cells, outcome]


def complaints(case, ended):
    """Violations of the criteria of stability."""
    if not ended.finite:
        yield "not finite"
    # Repulsion releases stored energy: the work of the forces, or the energy of overlaps due to long steps.
    stored = ended.overlaps or (case.forces and "repulsion" in case.scene)
    if ended.least_power <= 0 and not stored:
        yield f"power {ended.least_power:g}"
    if case.integrator == "adaptive" and ended.overlaps:
        yield "spheres overlap"
    if ended.message and not any(word in ended.message for word in ADVICE):
        yield "no advice"


def largest_steps(found):
    """A table: by sweep and integrator, the largest time step up to which all are stable."""
    names = [name for name in dict.fromkeys(case.sweep for case, _ in found) if name.startswith("time step")]
    rows = []
    for name in names:
        cells = [name.removeprefix("time step").removeprefix(",").strip()]
        for kind in INTEGRATORS:
            tried = [(case.value, ended) for case, ended in found if (case.sweep, case.integrator) == (name, kind)]
            unstable = min((step for step, ended in tried if not ended.is_stable()), default=math.inf)
            stable = max((step for step, _ in tried if step < unstable), default=math.nan)
            cells.append(f"{stable:g} of {max(step for step, _ in tried):g}")
        rows.append(cells)
    return table(["largest stable time step", *INTEGRATORS], rows)


def main():
    listed = list(cases())
    found, failed = [], []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for case, ended in zip(listed, pool.map(outcome, listed)):
            print(*row(case, ended), sep=" | ", flush=True)
            found.append((case, ended))
            failed += [f"{case.sweep} {case.value:g} {case.integrator}: {what}" for what in complaints(case, ended)]
    draw(found)
    header = ["sweep", "value", "integrator", "steps", "with overlap", "smallest gap", "power", "iterations", "outcome"]
    lines = [
        f"{SPHERES} spheres unless stated otherwise, sheared to a strain of {STRAIN:g} with a step of 0.005 at 30% and a repulsion of 100. Power",
        "is the power of the flow relative to that in the fluid alone, or the power of the forces relative to that for isolated",
        "spheres; all of it is dissipated except for the energy stored by repulsion. Iterations are means over the steps (the",
        "last substep of each).",
        "",
        *largest_steps(found),
        "",
        "![Smallest gaps and power](figures/stability.png)",
        "",
        *table(header, [row(case, ended) for case, ended in found]),
    ]
    write_section("lubrication.md", "stability", "Stability", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
