"""Panels of Brownian suspensions: mean square displacements and the osmotic pressure."""

import numpy as np

from ..panel import Panel
from ..style import GRAY, colours
from ..text import shown
from . import motion


# Answers from slopes of the mean square displacement.
DIRECTIONS = ("along_gradient", "along_vorticity", "along_walls", "across_walls", "parallel", "perpendicular")
DIFFUSIVITIES = ("diffusivity", *(f"diffusivity_{direction}" for direction in DIRECTIONS))


def displacements(run):
    """Mean square displacement of a component over the lag time, and that of a single sphere in unbounded fluid."""
    thermal_energy, lags = run.scene.thermal_energy, run.statistics.get("lags")
    if thermal_energy <= 0 or lags is None or not lags.has("species", "time"):
        return None
    panel = Panel(run, ("time lag", "time"), ("mean square displacement", "length^2"), log=(True, True))
    axes = [axis for axis in "xyz" if run.scene.flow == "none" or axis != "x"]
    for name, colour in zip(run.names, colours(len(run.names))):
        rows = lags.where(species=name)
        later = rows["time"] > 0
        for axis, line in zip(axes, ("-", "--", ":")):
            values = rows.get(f"displacement_{axis}")
            text = f"{shown(name)}, {axis}" if len(run.names) > 1 else f"along {axis}"
            if values is not None:
                values = positive(values[later])
                panel.add(rows["time"][later], values, text, colour=colour, line=line, quantities=DIFFUSIVITIES)
    return _with_reference(panel, run, thermal_energy)


def _with_reference(panel, run, thermal_energy):
    """2 D t of a single sphere of the first species in unbounded fluid."""
    radius = run.radii[0] if run.radii else np.nan
    if panel and np.isfinite(radius):
        lags = panel.curves[0].x
        free = 2 * thermal_energy / (6 * np.pi * run.scene.viscosity * radius) * lags
        panel.add(lags, free, "one sphere alone", colour=GRAY, line="-.")
    return panel


def positive(values):
    """Values for a logarithmic axis."""
    return np.where(values > 0, values, np.nan)


def osmotic_pressure(run):
    """The osmotic pressure."""
    if not motion.has_series(run) or run.get("osmotic_pressure") is None:
        return None
    panel = Panel(run, run.progress[1:], ("osmotic pressure", "force/length^2"))
    options = {"colour": colours(1)[0], "quantities": ("osmotic_pressure",)}
    panel.add(run.progress[0], run.get("osmotic_pressure"), **options)
    return panel
