"""The layout of a figure: panels in rows, and the table of answers below."""

from matplotlib.figure import Figure

from .answers import draw_table, height_of_table
from .style import PAGE

# Heights in inches: of the title, and between panels and table.
TITLE, PAD = 0.3, 0.12


def sheet(cells, row_height, answers=(), units=None, width=PAGE):
    """A figure and the axes of its cells. Each cell is a pair of row and column, or of slices of them."""
    rows, columns = (max(_end(cell[side]) for cell in cells) for side in (0, 1))
    table = height_of_table(answers) + PAD if answers else 0.0
    figure = Figure(figsize=(width, rows * row_height + table + TITLE), layout="constrained")
    ratios = [row_height] * rows + ([table] if answers else [])
    grid = figure.add_gridspec(len(ratios), columns, height_ratios=ratios)
    axes = [figure.add_subplot(grid[cell]) for cell in cells]
    if answers:
        draw_table(figure.add_subplot(grid[rows, :]), answers, units)
    return figure, axes


def in_rows(count, columns=2):
    """Cells one after another, in rows."""
    return [divmod(number, columns) for number in range(count)]


def _end(part):
    return part.stop if isinstance(part, slice) else part + 1
