"""A sweep of disks: the segregation of each branch."""

import numpy as np
from matplotlib.figure import Figure

from ..csv_table import needed_table
from ..style import PAGE, colours, legend_above

OF = (("viscosity", "viscosity"), ("rate", "rate"), ("area_fraction", "area fraction"))
# Branches that can still be told apart.
MOST = 12


def draw(folder, scene):
    """Mean segregation over the seeds of each branch."""
    path = folder / "averages.csv"
    averages = needed_table(path, "a sweep writes it when its cases are finished: go on with fcm-solve resume")
    averages.needs_numbers(path, "strain", "segregation", "segregation_error", *(name for name, _ in OF))
    figure = Figure(figsize=(PAGE * 0.6, 3.2), layout="constrained")
    axes = figure.subplots()
    branches = np.unique(np.stack([averages[name] for name, _ in OF], axis=1), axis=0)[:MOST]
    differing = [number for number in range(len(OF)) if len(set(branches[:, number])) > 1] or [0]
    for branch, colour in zip(branches, colours(len(branches))):
        rows = averages.where(**{name: value for (name, _), value in zip(OF, branch)})
        label = ", ".join(f"{OF[number][1]} {branch[number]:g}" for number in differing)
        _draw_branch(axes, rows, label, colour)
    axes.set(xlabel="strain", ylabel="segregation", ylim=(0, None))
    legend_above(axes, room=54)
    figure.suptitle(scene.title)
    return figure


def _draw_branch(axes, rows, label, colour):
    strain, mean = rows["strain"], rows["segregation"]
    error = np.where(np.isfinite(rows["segregation_error"]), rows["segregation_error"], 0)
    axes.plot(strain, mean, color=colour, label=label, marker="o" if len(rows) < 4 else "", markersize=3)
    axes.fill_between(strain, mean - error, mean + error, color=colour, alpha=0.25, linewidth=0)
