"""The answers of a run in summary.csv: quantities in the steady state, with errors and verdicts."""

import math
from dataclasses import dataclass

from .csv_table import read_table
from .text import shown, words
from .units import labelled, with_error

COLUMNS = ("quantity", "species", "value", "error", "samples", "transient", "verdict", "longer", "unit")
# Largest number of rows of the table in a figure.
MOST = 12
ALL = ("", "all")
# The verdicts in the words in which the program prints them.
VERDICTS = {"drifting": "still drifting", "meaningless": "too short for any value"}


@dataclass(frozen=True)
class Answer:
    """The answer for one quantity, of a species or of all."""

    quantity: str
    species: str
    value: float
    error: float
    transient: float
    longer: float
    verdict: str
    unit: str

    @property
    def judged(self):
        """The verdict, and how much longer the run would need to be."""
        if self.verdict == "too short" and math.isfinite(self.longer):
            return f"too short: {float(f'{max(self.longer, 1.1):.2g}'):g} times longer"
        return VERDICTS.get(self.verdict) or shown(self.verdict)

    @property
    def has_value(self):
        """Whether there is a meaningful value."""
        return math.isfinite(self.value) and self.verdict != "meaningless"


def read_answers(folder):
    """The answers in a folder; none without the file, or if it is the table of a continuum model."""
    path = folder / "summary.csv"
    table = read_table(path)
    if table is None or "verdict" not in table:
        return []
    table.needs(path, *COLUMNS)
    texts = [table[name].tolist() for name in ("quantity", "species", "verdict", "unit")]
    numbers = [_numbers(table[name]) for name in ("value", "error", "transient", "longer")]
    return [Answer(q, s, *n, v, u) for q, s, v, u, n in zip(*texts, zip(*numbers))]


def _numbers(column):
    return column.tolist() if column.dtype.kind == "f" else [math.nan] * len(column)


def find(answers, quantities, species):
    """The answer for the first of these quantities that has one, of a species or, for None, of all; None without an answer."""
    names = ALL if species is None else (species,)
    for quantity in quantities:
        for answer in answers:
            if answer.quantity == quantity and answer.species in names and answer.has_value:
                return answer
    return None


def rows(answers, units):
    """Rows of the table as text: quantity, value with its error, and verdict."""
    several = len({answer.species for answer in answers} - set(ALL)) > 0
    table = []
    for answer in answers[:MOST]:
        factor, unit = units.scale(answer.unit, [answer.value]) if answer.has_value else (1.0, "")
        name = words(answer.quantity)
        if several and answer.species not in ALL:
            name += f", {shown(answer.species, 20)}"
        number = with_error(answer.value * factor, answer.error * factor) if answer.has_value else "\u2013"
        table.append([labelled(name, unit), number, answer.judged])
    if len(answers) > MOST:
        table.append([f"{len(answers) - MOST} more in summary.csv", "", ""])
    return table


def draw_table(axes, answers, units):
    """Draws the table of the answers."""
    axes.set_axis_off()
    heads = ["quantity", "mean (dashed) \u00b1 error (band)", "verdict (transient: gray)"]
    options = {"loc": "upper left", "cellLoc": "left", "edges": "B", "colWidths": [0.48, 0.24, 0.28]}
    table = axes.table([heads, *rows(answers, units)], bbox=(0, 0, 1, 1), **options)
    table.auto_set_font_size(False)
    table.set_fontsize(7)
    for (row, _), cell in table.get_celld().items():
        cell.set_linewidth(0.7 if row == 0 else 0.0)
        cell.PAD = 0.01
        if row == 0:
            cell.get_text().set_color("0.35")


def band(axes, span, value_and_error, colour):
    """Draws a value with its error as a band over a part of the axis."""
    value, error = value_and_error
    error = abs(error) if math.isfinite(error) else 0.0
    axes.fill_between(span, value - error, value + error, color=colour, alpha=0.25, linewidth=0)
    axes.plot(span, [value, value], color=colour, linewidth=0.8, linestyle=(0, (4, 2)))


def shade(axes, start, end):
    """Shades the transient, which answers leave out."""
    if end > start:
        axes.axvspan(start, end, color="0.93", zorder=-1, linewidth=0)


def height_of_table(answers):
    """Height of the table in inches."""
    return 0.17 * (1 + min(len(answers), MOST + 1)) if answers else 0.0
