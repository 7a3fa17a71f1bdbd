"""Kinetic theory of a shear cell: profiles of every case."""

import numpy as np
from matplotlib.figure import Figure

from ..csv_table import needed_table
from ..style import PAGE, colours
from ..units import Units, labelled, upright

PROFILES = (
    ("solid_fraction", 0, "solid fraction"),
    ("velocity", 1, "velocity / U"),
    ("temperature", 2, "temperature / U\u00b2"),
)
# Largest number of cases that can be distinguished.
MOST = 12


def draw(folder, scene):
    """Draws solid fraction, velocity and temperature over the height."""
    path, units = folder / "profile.csv", Units(scene.is_si)
    profile = needed_table(path, "run the scene anew, which takes seconds")
    profile.needs_numbers(path, "speed", "pressure", "y", *(name for name, _, _ in PROFILES))
    cases = np.unique(np.stack([profile["speed"], profile["pressure"]], axis=1), axis=0)[:MOST]
    figure = Figure(figsize=(PAGE, 2.8), layout="constrained")
    panels = figure.subplots(1, 3, sharey=True)
    factor, unit = units.scale("length", profile["y"])
    for (speed, pressure), colour in zip(cases, colours(len(cases))):
        rows = profile.where(speed=speed, pressure=pressure)
        for axes, (name, power, label) in zip(panels, PROFILES):
            axes.plot(rows[name] / speed**power, rows["y"] * factor, color=colour, label=_label(speed, pressure, units))
            axes.set_xlabel(label)
    panels[0].set_ylabel(upright(labelled("y", unit)))
    figure.suptitle(scene.title)
    if len(cases) > 1:
        lines = (len(cases) + 3) // 4
        figure.get_layout_engine().set(rect=(0, 0.07 * lines, 1, 1 - 0.07 * lines))
        figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncols=min(4, len(cases)))
    return figure


def _label(speed, pressure, units):
    factor, unit = units.scale("force/length^2", [pressure])
    speed_unit = " m/s" if units.is_si else ""
    return f"U = {speed:g}{speed_unit}, P = {pressure * factor:g} {unit}".rstrip()
