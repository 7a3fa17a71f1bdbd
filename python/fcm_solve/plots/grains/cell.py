"""The shear cell: wall stresses over time, profiles across the gap, and the map of the solid fraction."""

import numpy as np

from ..answers import read_answers
from ..csv_table import read_table
from ..error import PlotError
from ..sheet import in_rows, sheet
from ..style import PAGE, colours, legend_above
from ..units import Units, labelled, upright

STRESSES = (
    ("wall_stress_normal[bottom]", "normal, bottom"),
    ("wall_stress_normal[top]", "normal, top"),
    ("wall_stress_along[top]", "shear, top"),
)
PROFILE = ("y", "solid_fraction", "velocity_x", "temperature")


def draw(folder, scene):
    """Draws the panels for which there are tables."""
    units = Units(scene.is_si)
    series, profile, cells = (read_table(folder / name) for name in ("observables.csv", "profile.csv", "map.csv"))
    parts = []
    if series is not None and series.get("time") is not None and any(series.get(s) is not None for s, _ in STRESSES):
        parts.append(lambda axes: _draw_stresses(axes, series, units))
    if profile is not None and profile.has(*PROFILE):
        parts += [lambda axes: _draw_fraction(axes, profile, units), lambda axes: _draw_motion(axes, profile, units)]
    if cells is not None and cells.has("z", "y", "solid_fraction"):
        parts.append(lambda axes: _draw_map(axes, cells, units))
    if not parts:
        raise PlotError(f"{folder} has no averages yet; if the run is still in progress, try again after time.transient")
    width = PAGE if len(parts) > 1 else PAGE / 2
    figure, places = sheet(in_rows(len(parts)), 2.5, read_answers(folder), units, width)
    for part, axes in zip(parts, places):
        part(axes)
    figure.suptitle(scene.title)
    return figure


def _draw_stresses(axes, series, units):
    found = [(series.get(name), label) for name, label in STRESSES if series.get(name) is not None]
    factor, unit = units.scale("force/length^2", *(values for values, _ in found))
    time_factor, time_unit = units.scale("time", series["time"])
    for (values, label), colour in zip(found, colours(len(found))):
        marker = "o" if np.isfinite(values).sum() < 4 else ""
        axes.plot(series["time"] * time_factor, values * factor, label=label, color=colour, marker=marker, markersize=3)
    axes.set(xlabel=labelled("time", time_unit), ylabel=upright(labelled("wall stress", unit)))
    legend_above(axes)


def _height(axes, profile, units):
    factor, unit = units.scale("length", profile["y"])
    axes.set_ylabel(upright(labelled("y", unit)))
    return profile["y"] * factor


def _draw_fraction(axes, profile, units):
    axes.plot(profile["solid_fraction"], _height(axes, profile, units), color=colours(1)[0])
    axes.set(xlabel="solid fraction", xlim=(0, None))


def _draw_motion(axes, profile, units):
    y, roughness = _height(axes, profile, units), np.sqrt(np.maximum(profile["temperature"], 0))
    axes.plot(profile["velocity_x"], y, label="along the flow", color=colours(1)[0])
    axes.plot(roughness, y, "--", label="root of the temperature", color=colours(2)[1])
    axes.set_xlabel(labelled("velocity", "m/s" if units.is_si else ""))
    legend_above(axes)


def _draw_map(axes, cells, units):
    cells = cells.at(np.isfinite(cells["z"]) & np.isfinite(cells["y"]))
    (z, columns), (y, rows) = (np.unique(cells[name], return_inverse=True) for name in ("z", "y"))
    values = np.full((len(y), len(z)), np.nan)
    values[rows, columns] = cells["solid_fraction"]
    factor, unit = units.scale("length", z, y)
    mesh = axes.pcolormesh(z * factor, y * factor, values, cmap="gray_r", shading="nearest", rasterized=True)
    axes.set(xlabel=labelled("z", unit), ylabel=upright(labelled("y", unit)), aspect="equal")
    axes.figure.colorbar(mesh, ax=axes, orientation="horizontal", shrink=0.7, label="solid fraction")
