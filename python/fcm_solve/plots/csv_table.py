"""CSV tables as written by runs."""

import csv

import numpy as np

from .error import PlotError, damage


# Columns of text, where names of species may look like numbers.
WORDS = {"point", "values", "quantity", "species", "first", "second", "verdict", "verdicts", "unit", "wall", "axis"}


class CsvTable:
    """Columns of equal length by name: numbers where all cells are numbers or empty, words otherwise."""

    def __init__(self, columns):
        self.columns = columns

    def __contains__(self, name):
        return name in self.columns

    def __getitem__(self, name):
        return self.columns[name]

    def __len__(self):
        return len(next(iter(self.columns.values()), ()))

    def get(self, name):
        """A column; None if it is absent or has no finite number."""
        column = self.columns.get(name)
        return column if column is not None and column.dtype.kind == "f" and np.isfinite(column).any() else None

    def has(self, *names):
        """Whether the table has all of these columns, and each column of numbers a finite value."""
        return all(name in self.columns if name in WORDS else self.get(name) is not None for name in names)

    def where(self, **values):
        """The rows with these values in the named columns."""
        chosen = np.ones(len(self), dtype=bool)
        for name, value in values.items():
            chosen &= self.columns[name] == value
        return self.at(chosen)

    def at(self, chosen):
        """The rows selected by a mask."""
        return CsvTable({name: column[chosen] for name, column in self.columns.items()})

    def needs(self, path, *names):
        """Refuses a table without these columns."""
        missing = [name for name in names if name not in self.columns]
        if missing:
            raise PlotError(f"{path} has no column {missing[0]}; write it again with fcm-solve")
        return self

    def needs_numbers(self, path, *names):
        """Refuses a table that lacks one of these columns, or has words in it."""
        self.needs(path, *names)
        wordy = [name for name in names if self.columns[name].dtype.kind != "f"]
        if wordy:
            raise PlotError(f"{path} is damaged: its column {wordy[0]} has words among the numbers")
        return self


def read_table(path):
    """Reads the table in a file; None if there is no file. An incomplete last row is left out."""
    if not path.is_file():
        return None
    with damage(path):
        text = path.read_text(encoding="utf-8")
        whole = text[: text.rfind("\n") + 1]
        records = list(csv.reader(whole.splitlines(keepends=True), strict=True))
        if not records:
            raise PlotError(f"{path} is empty; if the run is still in progress, try again later")
        names, *rows = records
        for number, row in enumerate(rows, start=2):
            if len(row) != len(names):
                raise PlotError(
                    f"{path} is damaged: row {number} has {len(row)} cells, and there are {len(names)} names"
                )
        cells = list(zip(*rows)) if rows else [()] * len(names)
        return CsvTable({name: _column(name, column) for name, column in zip(names, cells)})


def needed_table(path, advice):
    """Reads the table in a file, which needs to have rows; the error otherwise includes the advice."""
    table = read_table(path)
    if table is None:
        raise PlotError(f"there is no {path}; {advice}")
    if not len(table):
        raise PlotError(f"{path} has no rows yet; if the run is still in progress, try again later")
    return table


def _column(name, cells):
    if name in WORDS:
        return np.array(cells, dtype=str)
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells], dtype=float)
    except ValueError:
        return np.array(cells, dtype=str)
