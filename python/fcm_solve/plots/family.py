"""The figure of a family of runs: each quantity over the first swept key, with errors from the spread over seeds."""

from dataclasses import dataclass

import numpy as np

from . import members
from .answers import ALL
from .csv_table import read_table
from .error import PlotError
from .sheet import in_rows, sheet
from .style import PAGE, colours, legend_above
from .text import shown, words
from .units import Units, labelled, upright

TABLE = "family.csv"
FIRST = ("point", "values", "quantity", "species", "verdicts", "unit")
NUMBERS = ("mean", "error", "seeds", "spread", "claimed_error", "calibration")
# Largest numbers of panels of a page, and of curves of a panel.
MOST, MOST_CURVES = 8, 8
# Ratio of the largest to the smallest value above which an axis is logarithmic.
WIDE = 30.0


@dataclass
class Family:
    """The table of a family, and the key on the horizontal axis; None if no swept key has numbers."""

    table: object
    keys: list
    units: Units

    @property
    def key(self):
        """The first key with several values."""
        several = [key for key in self.keys if len(np.unique(self.table[key])) > 1]
        return (several or self.keys or [None])[0]


def is_one(folder, scene):
    """Whether a folder holds a family."""
    return (folder / TABLE).is_file() or "ensemble" in scene.keys or "sweep" in scene.keys


def draw(folder, scene, only=None):
    """The figure of a family, or of one of its quantities."""
    path = folder / TABLE
    table = read_table(path)
    if table is None or not len(table):
        why = f"{path} has no answers yet; a family writes them as its runs end: continue it with fcm-solve run --continue"
        return members.draw(folder, scene, why)
    table.needs(path, "values", "quantity", "species", "unit").needs_numbers(path, "mean", "error")
    keys = [name for name in table.columns if name not in (*FIRST, *NUMBERS)]
    family = Family(table, [key for key in keys if table.get(key) is not None], Units(scene.is_si))
    quantities = _quantities(table)
    if not quantities:
        why = f"{path} has no mean that means something: its runs are too short, see the column verdicts"
        return members.draw(folder, scene, why)
    if only is not None and only not in quantities:
        raise PlotError(f"{path} has no mean of {only}; it has {', '.join(quantities)}")
    quantities = [only] if only else quantities[:MOST]
    figure, places = sheet(in_rows(len(quantities)), 2.4, width=PAGE if len(quantities) > 1 else PAGE / 2)
    for axes, quantity in zip(places, quantities):
        _draw_quantity(axes, family, quantity)
    figure.suptitle(scene.title)
    return figure


def _quantities(table):
    """The quantities with a mean."""
    quantities = dict.fromkeys(table["quantity"].tolist())
    return [q for q in quantities if np.isfinite(table["mean"][table["quantity"] == q]).any()]


def _draw_quantity(axes, family, quantity):
    rows = family.table.where(quantity=quantity)
    factor, unit = family.units.axis(rows["unit"][0], rows["mean"])
    lines = _lines(family, rows)[:MOST_CURVES]
    for (label, chosen), colour in zip(lines, colours(len(lines))):
        x = chosen[family.key] if family.key else _places(chosen, rows)
        order = np.argsort(x)
        mean, error = chosen["mean"][order] * factor, np.nan_to_num(chosen["error"][order] * factor, posinf=0)
        style = {"marker": "o", "markersize": 3, "capsize": 2, "elinewidth": 0.8, "color": colour, "label": label}
        axes.errorbar(x[order], mean, yerr=error, linestyle="-" if family.key else "", **style)
    axes.set_ylabel(upright(labelled(words(quantity), unit)))
    _scale(axes, family, rows)
    legend_above(axes)


def _lines(family, rows):
    """The rows of each line, and its label: the species, and the values of the other keys."""
    names = [_name(family, rows, number) for number in range(len(rows))]
    marked = np.array(names)
    return [(name, rows.at(marked == name)) for name in dict.fromkeys(names)]


def _name(family, rows, number):
    species = rows["species"][number]
    values = [value for value in rows["values"][number].split(", ") if value.split(" = ")[0] != family.key]
    parts = ([] if species in ALL else [species]) + (values if family.key else [])
    return shown(", ".join(parts), 40)


def _places(chosen, rows):
    """Positions on the axis of points that have no number: their order in the table."""
    order = list(dict.fromkeys(rows["values"].tolist()))
    return np.array([order.index(value) for value in chosen["values"].tolist()], dtype=float)


def _values(text):
    """The values of a point without their keys."""
    return shown(", ".join(part.split(" = ")[-1].strip('"') for part in text.split(", ")), 20)


def _scale(axes, family, rows):
    if family.key is None:
        points = [_values(value) for value in dict.fromkeys(rows["values"].tolist())]
        axes.set_xticks(range(len(points)), points, rotation=20 if len(points) > 2 else 0)
        axes.set_xlim(-0.5, len(points) - 0.5)
        return
    axes.set_xlabel(shown(family.key, 60))
    x = rows[family.key]
    if x.min() > 0 and x.max() > WIDE * x.min():
        axes.set_xscale("log")
