"""User-defined time series of a simulation: kept as arrays, or written to files."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays, _row_files
from ._errors import Error, InputError
from ._extras import needed
from .actions import Action

if TYPE_CHECKING:
    import pandas

    from .simulation import Simulation

_SUFFIXES = (".csv", ".h5", ".hdf5")


class Quantities(Action):
    """Action that makes a row of named quantities: step, time, and a number or an array for each."""

    def __init__(self) -> None:
        self._functions: dict[str, Callable | None] = {}
        self._units: dict[str, str] = {}
        self._shapes: dict[str, tuple[int, ...]] = {}

    def add(self, name: str, function: Callable[[Simulation], Any] | None = None, unit: str = "") -> Quantities:
        """Adds a quantity and returns the logger, so that calls can be chained.

        function  function of the simulation that returns a number, or an array of the same shape each time; without it the
                  quantity is that of the time series, `simulation.observables[name]`
        unit      in terms of length, time and force; known for quantities of the time series
        """
        if not isinstance(name, str) or not name or name in ("step", "time") or set(name) & set("/[],\n"):
            raise InputError(
                f'the name of a quantity is {name!r}; it needs to be a word other than "step" and "time", without / [ ] and ,'
            )
        if name in self._functions:
            raise InputError(f"there is a quantity {name} already; take another name")
        if self._shapes:
            raise Error(f"{name} can't be added: there are rows without it; take another logger")
        if function is not None and not callable(function):
            raise InputError(f"the function of {name} is {function!r}; it needs to be a function of the simulation")
        self._functions[name], self._units[name] = function, str(unit)
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the quantities, in the order in which they were added."""
        return tuple(self._functions)

    @property
    def units(self) -> dict[str, str]:
        """Units of the quantities, by name."""
        return dict(self._units)

    def attach(self, simulation: Simulation) -> None:
        """Looks up the units of quantities of the time series, and refuses names that it does not have."""
        of_series = [name for name, function in self._functions.items() if function is None]
        listed = {name: unit for name, unit, _, _ in simulation._core.observables()} if of_series else {}
        for name in of_series:
            if name not in listed:
                raise InputError(f"{name} has no function, and the time series has none; it has {', '.join(listed)}")
            self._units[name] = listed[name]

    def act(self, simulation: Simulation) -> None:
        """Makes a row for the present step. On several ranks, all call the functions, and the first rank keeps its row."""
        error = None
        try:
            row = self._row(simulation)
            if simulation._is_first:
                self._take(int(simulation.step), simulation.time, row)
        except Exception as raised:  # noqa: BLE001
            error = raised
        simulation._agree(error)

    def _row(self, simulation):
        observables = simulation.observables if None in self._functions.values() else {}
        values = {name: f(simulation) if f else observables[name] for name, f in self._functions.items()}
        return {name: self._checked(name, value) for name, value in values.items()}

    def _checked(self, name, value):
        array = np.asarray(value)
        if array.dtype.kind not in "fiub":
            raise InputError(f"the quantity {name} is {value!r}; it needs to be a number or an array of real numbers")
        shape = self._shapes.setdefault(name, array.shape)
        if array.shape != shape:
            raise InputError(f"the quantity {name} has the shape {array.shape}; it was {shape} in the rows before")
        return array.astype(np.float64)

    def _take(self, step, time, row):
        raise NotImplementedError


class Logger(Quantities):
    """Keeps quantities as arrays: `log["distance"]`, `log.times`, `log.to_pandas()`.

        log = fcm.Logger().add("smallest_gap").add("height", lambda s: s.positions[:, 2].mean(), "length")
        simulation.add(log, every=10)

    A repeated step, as after `set_snapshot`, replaces its row and drops those after it.
    """

    def __init__(self) -> None:
        super().__init__()
        self._rows: list[tuple[int, float, dict[str, np.ndarray]]] = []

    def _take(self, step, time, row):
        while self._rows and self._rows[-1][0] >= step:
            self._rows.pop()
        self._rows.append((step, time, row))

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def steps(self) -> np.ndarray:
        """(rows,), steps"""
        return np.array([step for step, _, _ in self._rows], dtype=np.int64)

    @property
    def times(self) -> np.ndarray:
        """(rows,), times"""
        return np.array([time for _, time, _ in self._rows], dtype=np.float64)

    def __getitem__(self, name: str) -> np.ndarray:
        """(rows, ...), the values of a quantity, a number or an array for each row"""
        if name not in self._functions:
            raise KeyError(f"there is no quantity {name}; there are {', '.join(self._functions)}")
        return np.array([row[name] for _, _, row in self._rows])

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame with a row for each time, which is the index, and columns for `step` and each number."""
        pandas = needed("pandas", "to_pandas()")
        table = {"step": self.steps}
        for name in self._shapes:
            numbers = self[name].reshape(len(self), -1)
            table |= dict(zip(_row_files.columns(name, self._shapes[name]), numbers.T, strict=True))
        return pandas.DataFrame(table, index=pandas.Index(self.times, name="time"))


class Writer(Quantities):
    """Writes quantities to a file, row by row: a table (.csv), or a dataset for each (.h5, .hdf5).

        out = fcm.Writer("own.csv").add("smallest_gap").add("height", lambda s: s.positions[:, 2].mean(), "length")
        simulation.add(out, every_time=0.5)

    path   the file. An existing file is refused, unless a resumed simulation continues it: then the rows from its step
           on are rewritten
    force  replace an existing file
    """

    def __init__(self, path: str | PathLike, force: bool = False) -> None:
        super().__init__()
        self._path, self._force, self._file = Path(path), _arrays.flag("force", force), None
        if self._path.suffix.lower() not in _SUFFIXES:
            raise InputError(f"{self._path} has the suffix {self._path.suffix!r}; it needs to be one of {', '.join(_SUFFIXES)}")
        self._owner: Simulation | None = None

    @property
    def path(self) -> Path:
        """The file."""
        return self._path

    def attach(self, simulation: Simulation) -> None:
        """Opens the file."""
        super().attach(simulation)
        error = None
        try:
            if simulation._is_first:
                self._open(simulation)
        except Exception as raised:  # noqa: BLE001
            error = raised
        simulation._agree(error)

    def _open(self, simulation):
        if self._file is not None:
            raise Error(f"{self._path} is being written already, by this writer in another simulation")
        exists = self._path.exists()
        goes_on = exists and (self._owner is simulation or (simulation._is_resumed and not self._force))
        if exists and not (goes_on or self._force):
            raise Error(f"{self._path} exists already; take another file, or force=True to replace it")
        self._file = _row_files.opened(self._path, self.names, self._units, goes_on)
        self._owner = simulation

    def detach(self, simulation: Simulation) -> None:
        """Closes the file."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def _take(self, step, time, row):
        if self._file.last_step is not None and self._file.last_step >= step:
            self._file.cut(step)
        self._file.append(step, time, row)
