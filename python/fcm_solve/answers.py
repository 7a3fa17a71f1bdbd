"""The answers of a run: means in the steady state, with errors and verdicts."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from ._errors import Error


@dataclass(frozen=True, repr=False)
class Answer:
    """Answer of a run for one quantity. Missing numbers, as of an answer whose verdict is "meaningless", are NaN."""

    quantity: str
    species: str
    value: float
    error: float
    """the standard error"""
    samples: float
    """effective number of independent samples"""
    transient: float
    """the time from which the mean is taken"""
    verdict: str
    """"converged", "too short", "drifting" or "meaningless" """
    longer: float
    """the factor by which a run that is too short would need to be longer"""
    unit: str
    """in terms of length, time and force"""

    def __repr__(self):
        species = "" if self.species == "all" else f"[{self.species}]"
        value = f"{_rounded(self.value, self.error)} {self.unit}".rstrip()
        longer = f": {max(self.longer, 1.1):.2g} times longer" if self.verdict == "too short" else ""
        return f"<{self.quantity}{species} = {value}, {self.verdict}{longer}>"


class Answers(Sequence):
    """The answers of a run, as a sequence and by name: `answers["relative_viscosity"]` or, for one species,
    `answers["settling_velocity", "heavy"]`."""

    def __init__(self, answers):
        self._answers = list(answers)

    def __len__(self):
        return len(self._answers)

    def __getitem__(self, key):
        if isinstance(key, (int, slice)):
            return self._answers[key]
        quantity, species = (key, None) if isinstance(key, str) else key
        found = [a for a in self if a.quantity == quantity and species in (None, a.species)]
        if len(found) == 1:
            return found[0]
        names = ", ".join(sorted({f"{a.quantity}[{a.species}]" for a in self}))
        how = "names no answer" if not found else "names several answers; say of which species"
        raise Error(f"{key!r} {how}; there are {names}")

    def __repr__(self):
        return "\n".join(map(repr, self)) or "<no answers>"


NAMES = [field.name for field in fields(Answer)]


def is_table(path: Path) -> bool:
    """Whether a file is a table of answers."""
    with path.open(newline="") as file:
        return next(csv.reader(file), []) == NAMES


def read(path: Path) -> Answers:
    """Reads the answers in a file."""
    with path.open(newline="") as file:
        return Answers(Answer(**{name: _cell(name, cell) for name, cell in row.items()}) for row in csv.DictReader(file))


def _cell(name, cell):
    if name in ("quantity", "species", "verdict", "unit"):
        return cell
    return float(cell) if cell else math.nan


def _rounded(value, error):
    """A value with its error to two digits."""
    if not math.isfinite(value):
        return "unknown"
    if error == 0 or not math.isfinite(error):
        return f"{value:.6g}"
    last = math.floor(math.log10(float(f"{error:.1e}"))) - 1
    largest = math.floor(math.log10(max(abs(value), error)))
    if -4 <= largest < 6 and last <= 2:
        return f"{value:.{max(-last, 0)}f} +- {error:.{max(-last, 0)}f}"
    digits = max(largest - last, 0)
    return f"({value / 10**largest:.{digits}f} +- {error / 10**largest:.{digits}f})e{largest}"
