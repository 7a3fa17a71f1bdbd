"""The figure of a family without means yet: the time series of its runs, coloured by point."""

from . import suspension
from .error import PlotError
from .panel import Panel
from .run import Run
from .scene import read_scene
from .sheet import in_rows, sheet
from .style import PAGE, colours

# Largest number of panels of a page.
MOST = 4


def draw(folder, scene, why):
    """The figure of the runs with time series; raises an error that says why there are no means if no run has one."""
    points = sorted(path for path in folder.glob("point-*") if path.is_dir())
    panels = {}
    for number, point in enumerate(points):
        for member in sorted(point.glob("seed-*")) if len(list(point.glob("seed-*"))) else [point]:
            _add_member(panels, member, f"point {number + 1}", colours(len(points))[number])
    if not panels:
        raise PlotError(why)
    shown = list(panels.values())[:MOST]
    figure, places = sheet(in_rows(len(shown)), 2.4, width=PAGE if len(shown) > 1 else PAGE / 2)
    for axes, panel in zip(places, shown):
        panel.draw(axes)
    figure.suptitle(scene.title)
    return figure


def _add_member(panels, folder, label, colour):
    """Adds the first curve of each panel of a run to the panel of the same axes."""
    if not (folder / "scene.toml").is_file():
        return
    run = Run(folder, read_scene(folder))
    made = suspension.panels(run) if run.scene.kind == "suspension" and run.series is not None else []
    for own in made:
        if isinstance(own, Panel):
            panel = panels.setdefault((own.x, own.y), Panel(own.run, own.x, own.y, log=own.log, level=own.level))
            is_new = all(curve.label != label for curve in panel.curves)
            panel.add(own.curves[0].x, own.curves[0].y, label if is_new else "", colour=colour)
