"""Files of rows: step, time, and numbers or arrays by name."""

import csv
import os
from itertools import product

import numpy as np

from ._errors import Error
from ._extras import needed


def opened(path, names, units, goes_on):
    """Opens a file of the kind of its suffix: a new one, or an existing one, whose quantities have to be those named."""
    kind = {".csv": CsvRows, ".h5": Hdf5Rows, ".hdf5": Hdf5Rows}[path.suffix.lower()]
    try:
        return kind(path, names, units, goes_on)
    except OSError as error:
        raise Error(f"can't write {path}: {error}") from error


def columns(name, shape):
    """Column names of a quantity of a shape: `name`, or `name[0]`, `name[0][1]`."""
    return [name + "".join(f"[{index}]" for index in indices) for indices in product(*map(range, shape))]


def _of_other_names(path, found, names):
    return Error(f"{path} has the quantities {', '.join(found)}, not {', '.join(names)}; take another file, or force=True")


class CsvRows:
    """CSV file with a line for each row."""

    def __init__(self, path, names, units, goes_on):
        self._path, self._names = path, names
        self._header, self.last_step = None, None
        if goes_on:
            self._take_up()
        self._file = path.open("a" if goes_on else "w", newline="", encoding="utf-8")

    def _take_up(self):
        """Reads the header and the last step of an existing file, and drops an incomplete last line."""
        lines = self._path.read_text(encoding="utf-8").splitlines(keepends=True)
        whole = [line for line in lines if line.endswith("\n")]
        if len(whole) < len(lines):
            self._replace(whole)
        if whole:
            self._header = next(csv.reader(whole[:1]))
            found = list(dict.fromkeys(column.split("[")[0] for column in self._header))
            if found != ["step", "time", *self._names]:
                raise _of_other_names(self._path, found[2:], self._names)
        if len(whole) > 1:
            self.last_step = int(whole[-1].split(",")[0])

    def _replace(self, lines):
        beside = self._path.with_name(self._path.name + ".tmp")
        beside.write_text("".join(lines), encoding="utf-8", newline="")
        os.replace(beside, self._path)

    def cut(self, step):
        """Drops the rows from `step` on."""
        self._file.close()
        header, *lines = self._path.read_text(encoding="utf-8").splitlines(keepends=True)
        self._replace([header, *(line for line in lines if int(line.split(",")[0]) < step)])
        self._file = self._path.open("a", newline="", encoding="utf-8")

    def append(self, step, time, row):
        """Appends a row, and flushes the file."""
        header = ["step", "time", *(column for name, array in row.items() for column in columns(name, array.shape))]
        writer = csv.writer(self._file, lineterminator="\n")
        if self._header is None:
            writer.writerow(header)
        elif self._header != header:
            raise Error(f"{self._path} has the columns {', '.join(self._header)}, not {', '.join(header)}")
        numbers = (number for array in row.values() for number in array.ravel().tolist())
        writer.writerow([step, *map(repr, (time, *numbers))])
        self._file.flush()
        self._header, self.last_step = header, step

    def close(self):
        self._file.close()


class Hdf5Rows:
    """HDF5 file with a dataset for each quantity, whose first index is the row, with its unit as the attribute `dimensions`."""

    def __init__(self, path, names, units, goes_on):
        h5py = needed("h5py", "a file of HDF5")
        self._path, self._names, self._units = path, names, units
        self._file = h5py.File(path, "a" if goes_on else "w", locking=False)
        self.last_step = None
        if "step" in self._file:
            found = [name for name in self._file.attrs["quantities"]]
            if found != list(names):
                self._file.close()
                raise _of_other_names(path, found, names)
            self._level(min(len(self._file[name]) for name in ("step", "time", *names)))

    def _level(self, count):
        """Truncates each dataset to `count` rows."""
        for name in ("step", "time", *self._names):
            self._file[name].resize(count, axis=0)
        self.last_step = int(self._file["step"][-1]) if count else None
        self._file.flush()

    def cut(self, step):
        """Drops the rows from `step` on."""
        self._level(int(np.searchsorted(self._file["step"][:], step)))

    def append(self, step, time, row):
        """Appends a row, and flushes the file."""
        row = {"step": np.int64(step), "time": np.float64(time), **row}
        if "step" not in self._file:
            self._file.attrs["quantities"] = list(self._names)
            for name, array in row.items():
                made = self._file.create_dataset(name, (0, *array.shape), array.dtype, maxshape=(None, *array.shape))
                made.attrs["dimensions"] = self._units.get(name, "time" if name == "time" else "")
        for name, array in row.items():
            dataset = self._file[name]
            if dataset.shape[1:] != array.shape:
                raise Error(f"{self._path} has {name} of the shape {dataset.shape[1:]}, not {array.shape}")
        for name, array in row.items():
            dataset = self._file[name]
            dataset.resize(len(dataset) + 1, axis=0)
            dataset[-1] = array
        self._file.flush()
        self.last_step = step

    def close(self):
        self._file.close()
