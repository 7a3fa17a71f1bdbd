"""The picture of a suspension: spheres on the left, panels around them, answers below."""

from matplotlib.figure import Figure

from . import answers
from .error import PlotError
from .snapshot import Snapshot
from .style import PAGE
from .suspension import panels

ROW = 2.1


def draw(run, by):
    """The figure of a run."""
    snapshot = Snapshot(run, by) if run.frames is not None else None
    shown = panels(run)
    if snapshot is None and not shown:
        raise PlotError(f"{run.folder} has nothing to draw: " + "; ".join(dict.fromkeys(run.notes)))
    cells, rows = _cells(snapshot is not None, len(shown))
    table = answers.height_of_table(run.answers)
    width = PAGE if max(column.stop for _, column in cells) == 2 else PAGE / 2
    figure = Figure(figsize=(width, ROW * rows + table + 0.3), layout="constrained")
    ratios = [ROW] * rows + ([table] if table else [])
    grid = figure.add_gridspec(len(ratios), round(2 * width / PAGE), height_ratios=ratios)
    for (row, column), part in zip(cells, ([snapshot] if snapshot else []) + shown):
        part.draw(figure.add_subplot(grid[row, column]))
    if table:
        answers.draw_table(figure.add_subplot(grid[rows, :]), run.answers, run.units)
    figure.suptitle(run.scene.title)
    return figure


def _cells(has_snapshot, count):
    """The cell of each part, rows and columns, and the number of rows. Spheres take the left of two or three rows."""
    if not has_snapshot:
        places = [(number // 2, number % 2) for number in range(count)]
    elif count == 0:
        return [(slice(0, 2), slice(0, 1))], 2
    else:
        beside = 2 + count % 2 if count > 2 else count
        places = [(number, 1) for number in range(beside)]
        places += [(beside + number // 2, number % 2) for number in range(count - beside)]
    cells = [(slice(row, row + 1), slice(column, column + 1)) for row, column in places]
    rows = max(row for row, _ in places) + 1
    if not has_snapshot:
        return cells, rows
    if count == 1:
        return [(slice(0, 2), slice(0, 1)), (slice(0, 2), slice(1, 2))], 2
    return [(slice(0, beside), slice(0, 1)), *cells], rows
