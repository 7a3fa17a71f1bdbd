"""The shear cell of Yu & Tichy, J. Tribol. 123, 777 (2001): Figs 5, 6, 9 and 10, by theory and by particles."""

import csv
import math

import numpy as np

from report import Report, main
from runs import Run, make

SPEEDS = [1.4, 2.0, 2.8]
DIAMETER, DENSITY, GAP = 0.787e-3, 2550.0, 4e-3
# The paper's mean solid fractions at 5.5 kPa, and those of its experiments and particles.
PAPER = [0.63, 0.58, 0.51]
DENSE = 0.595
# Load at which the theory gives that solid fraction at the first speed.
LOAD = 3574.0
# Solid fraction at which the particles are compared.
FRACTION = 0.5
# The paper's speeds, at the first of which the weight of the grains is two fifths of the stress, and speeds at which it is a
# fortieth and less: the collisional regime.
REGIMES = {"the paper's speeds": SPEEDS, "collisional": [4 * speed for speed in (*SPEEDS, 5.6)]}
GRAVITY = 9.81
ENGINES = ("time-stepped", "event-driven")


def continuum(name, speeds, pressure):
    return Run(
        f"shear-cell/{name}",
        {
            "kind": "shear-cell-continuum",
            "cell": {"gap": GAP, "speeds": speeds, "pressures": [pressure]},
            "grains": {"diameter": DIAMETER, "density": DENSITY, "restitution": 0.9},
            "walls": {"restitution": 0.9, "r5": 0.5, "r6": 0.5, "r7": 0.5, "r8": 0.5},
        },
    )


def particles(collisions, speed, seed, mode):
    """Grains at a speed; times are proportional to its inverse, so that all runs have the same displacement."""
    slow = SPEEDS[0] / speed
    length, width = (0.03, 0.019) if mode == "full" else (0.008, 0.008)
    window = float(f"{5e-5 * slow:.3g}")
    collision_step = {"collision_step": window / 100} if collisions == "time-stepped" else {}
    settle, measured = (100, 100) if mode == "full" else (60, 400)
    return Run(
        f"shear-cell/{mode}-{collisions}-{speed:g}",
        {
            "kind": "shear-cell",
            "collisions": collisions,
            "seed": seed,
            "cell": {
                "length": length,
                "height": GAP,
                "width": width,
                "speed": speed,
                "gravity": GRAVITY,
                "circumference": 0.479,
            },
            "grains": {
                "diameter": DIAMETER,
                "density": DENSITY,
                "solid_fraction": FRACTION,
                "restitution": 0.9,
                "friction": 0.3,
                "contact_time": 1e-7 * slow,
            },
            "walls": {"restitution": 0.9, "friction": 0.3},
            "time": {"step": 20 * window, "steps": settle + measured, "transient": settle * 20 * window} | collision_step,
            "measure": {"window": window},
            "output": {"trajectory_every": 0, "checkpoint_every": 10},
        },
    )


def rows(run, name):
    """The rows of a table, with numbers as floats."""
    with open(run.folder / f"{name}.csv") as file:
        return [{k: v if k == "wall" else float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def wall(run, component, name="top"):
    """Stress on a wall and its error."""
    row = next(row for row in rows(run, "walls") if row["wall"] == name)
    return abs(row[component]), row[f"{component}_error"]


def slope(speeds, stresses):
    """Slope of stress against speed, both logarithmic, and its error from those of the stresses."""
    x = np.log(speeds) - np.mean(np.log(speeds))
    weights = x / np.sum(x * x)
    errors = [error / value for value, error in stresses]
    return float(weights @ np.log([value for value, _ in stresses])), math.hypot(*(weights * errors))


def profiles(report, solved):
    """Figs 5 and 6: solid fraction and velocity across the gap."""
    for speed in SPEEDS:
        points = [row for row in rows(solved, "profile") if row["speed"] == speed]
        heights = [row["y"] / GAP for row in points]
        report.curve(f"U = {speed} m/s", heights, [row["solid_fraction"] for row in points], panel=0)
        report.curve(f"U = {speed} m/s", heights, [row["velocity"] / speed for row in points], panel=1)
    report.label("y/H", "solid fraction (Fig. 5)", panel=0)
    report.label("y/H", "u/U (Fig. 6)", panel=1)
    slips = []
    for row, paper in zip(rows(solved, "summary"), PAPER):
        found = row["mean_solid_fraction"]
        near = abs(found - paper) <= 0.025
        report.state(f"mean solid fraction, 5.5 kPa, U = {row['speed']:g} m/s", f"{paper} (paper)", f"{found:.4f}", near)
        slips.append(row["slip"] / row["speed"])
    text = ", ".join(f"{slip:.4f}" for slip in slips)
    report.state("slip over speed at the three speeds", "nearly identical (paper)", text, max(slips) - min(slips) < 1e-3)


def stresses(report, solved, runs):
    """Figs 9 and 10: stress against speed."""
    theory = [rows(run, "summary")[0] for run in solved]
    for panel, component, key in ((2, "normal", "pressure"), (3, "along", "shear_stress")):
        report.curve(f"theory at {DENSE}", SPEEDS, [row[key] for row in theory], panel=panel, color="0.3")
        for (collisions, regime), cases in runs.items():
            label, speeds = f"{collisions}, {regime}", REGIMES[regime]
            found = [wall(run, component) for run in cases]
            marker = "o" if collisions == "event-driven" else "x"
            style = "-" if regime == "collisional" else ":"
            report.points(label, speeds, found, panel=panel, marker=marker, linestyle=style, linewidth=0.8)
            value, error = slope(speeds, found)
            name = f"slope of the {'normal' if component == 'normal' else 'shear'} stress, {label}"
            reference = "2.0 ± 0.1" if regime == "collisional" else "nearly 2 (paper)"
            within = abs(value - 2) <= (0.1 if regime == "collisional" else 0.2)
            report.state(name, reference, f"{value:.2f} ± {error:.2f}", within)
        name = "normal stress on the top, Pa (Fig. 9)" if panel == 2 else "shear stress on the top, Pa (Fig. 10)"
        report.label("U, m/s", name, panel=panel, xscale="log", yscale="log")
        ticks = [1.4, 2.8, 5.6, 11.2, 22.4]
        report.panels[panel].set_xticks(ticks, [f"{speed:g}" for speed in ticks])
        report.panels[panel].minorticks_off()
    fractions = [row["mean_solid_fraction"] for row in theory]
    constant = max(abs(f - DENSE) for f in fractions) < 5e-4
    report.state("theory: solid fraction at loads proportional to U²", "constant, so the slope is 2", f"{fractions[-1]:.4f}", constant)


def engines(report, runs):
    """Both engines side by side."""
    for component in ("normal", "along"):
        for speed, stepped, driven in zip(SPEEDS, *(runs[engine, "the paper's speeds"] for engine in ENGINES)):
            (a, da), (b, db) = wall(stepped, component), wall(driven, component)
            name = f"{'normal' if component == 'normal' else 'shear'} stress on the top at {speed:g} m/s, Pa"
            agree = abs(a - b) <= 3 * math.hypot(da, db)
            report.state(name, f"time-stepped: {a:.4g} ± {da:.1g}", f"event-driven: {b:.4g} ± {db:.1g}", agree)
    first = runs["event-driven", "the paper's speeds"][0]
    weight = FRACTION * GAP * DENSITY * GRAVITY
    bottom, top = wall(first, "normal", "bottom"), wall(first, "normal")
    difference, error = bottom[0] - top[0], math.hypot(bottom[1], top[1])
    report.compare("normal stress on the bottom minus that on the top, Pa", "weight per area", weight, (difference, error), 0.08)


def draw(mode):
    """Theory at 5.5 kPa; theory, time-stepped and event-driven particles against the speed."""
    solved = continuum("5.5kPa", SPEEDS, 5500.0)
    scaled = [continuum(f"dense-{speed:g}", [speed], LOAD * (speed / SPEEDS[0]) ** 2) for speed in SPEEDS]
    runs = {
        (engine, regime): [particles(engine, speed, seed, mode) for seed, speed in enumerate(speeds, 1)]
        for engine in ENGINES
        for regime, speeds in REGIMES.items()
    }
    make([solved, *scaled, *sum(runs.values(), [])])
    report = Report("shear-cell", mode, "Shear cell: Figs 5, 6, 9 and 10", panels=4)
    profiles(report, solved)
    stresses(report, scaled, runs)
    engines(report, runs)
    return report


if __name__ == "__main__":
    main(draw)
