"""The picture of a suspension: spheres on the left, panels around them, answers below."""

from .error import PlotError
from .sheet import in_rows, sheet
from .snapshot import Snapshot
from .style import PAGE
from .suspension import panels, panels_of

ROW = 2.1


def draw(run, by, only=None):
    """The figure of a run, or of the panels of one quantity alone."""
    if only is not None:
        return _put_together(run, None, panels_of(run, only))
    snapshot = Snapshot(run, by) if run.frames is not None else None
    shown = panels(run)
    if snapshot is None and not shown:
        raise PlotError(f"{run.folder} has nothing to draw: " + "; ".join(dict.fromkeys(run.notes)))
    return _put_together(run, snapshot, shown)


def _put_together(run, snapshot, shown):
    cells = _cells(snapshot is not None, len(shown))
    width = PAGE if len(cells) > 1 else PAGE / 2
    answers = run.answers if len(cells) > 1 else []
    figure, places = sheet(cells, ROW, answers, run.units, width)
    for axes, part in zip(places, ([snapshot] if snapshot else []) + shown):
        part.draw(axes)
    figure.suptitle(run.scene.title)
    return figure


def _cells(has_snapshot, count):
    """The grid cell of each part. Spheres, which come first, take the left side of two or three rows."""
    if not has_snapshot:
        return in_rows(count)
    if count < 2:
        return [(slice(0, 2), column) for column in range(1 + count)]
    beside = 2 + count % 2
    right = [(number, 1) for number in range(beside)]
    return [(slice(0, beside), 0), *right, *((beside + row, column) for row, column in in_rows(count - beside))]
