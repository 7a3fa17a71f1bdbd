"""A family of disks: segregation at each point over the strain."""

import numpy as np
from matplotlib.figure import Figure

from ..csv_table import needed_table
from ..style import PAGE, colours, legend_above
from ..text import shown

TABLE = "averages.csv"
# Largest number of points that can be distinguished.
MOST = 12


def is_one(folder, scene):
    """Whether the folder of a family has records of disks."""
    return scene.kind == "granular-disks" and (folder / TABLE).is_file()


def draw(folder, scene):
    """Draws the mean segregation over the seeds of each point."""
    path = folder / TABLE
    averages = needed_table(path, "the family writes it as its runs end: continue it with fcm-solve resume")
    averages.needs(path, "values").needs_numbers(path, "strain", "segregation", "segregation_error")
    figure = Figure(figsize=(PAGE * 0.6, 3.2), layout="constrained")
    axes = figure.subplots()
    points = list(dict.fromkeys(averages["values"].tolist()))[:MOST]
    for values, colour in zip(points, colours(len(points))):
        _draw_point(axes, averages.where(values=values), shown(values, 40), colour)
    axes.set(xlabel="strain", ylabel="segregation", ylim=(0, None))
    legend_above(axes, room=54)
    figure.suptitle(scene.title)
    return figure


def _draw_point(axes, rows, label, colour):
    strain, mean = rows["strain"], rows["segregation"]
    error = np.where(np.isfinite(rows["segregation_error"]), rows["segregation_error"], 0)
    axes.plot(strain, mean, color=colour, label=label, marker="o" if len(rows) < 4 else "", markersize=3)
    axes.fill_between(strain, mean - error, mean + error, color=colour, alpha=0.25, linewidth=0)
