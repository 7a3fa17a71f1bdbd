"""The velocity of the fluid on the grid, by step."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._extras import needed
from ._hdf5 import opened


@dataclass(frozen=True)
class Field:
    """The velocity of the fluid at a time, relative to the background flow."""

    step: int
    """Steps taken."""
    time: float
    """The time."""
    velocity: np.ndarray
    """(nz, ny, nx, 3), length/time"""
    edges: np.ndarray
    """(3,), of the box; length"""
    strain: float
    """The box's Lees-Edwards strain: its second edge is (strain Ly, Ly, 0)."""

    def to_xarray(self):
        """A DataArray with the places of the grid's points along the edges of the box."""
        xarray = needed("xarray", "field.to_xarray()")
        counts = self.velocity.shape[2::-1]
        places = {name: np.arange(n) * edge / n for name, n, edge in zip("xyz", counts, self.edges)}
        attributes = {"units": "length/time", "step": self.step, "time": self.time, "strain": self.strain}
        coordinates = {**places, "axis": ["x", "y", "z"]}
        return xarray.DataArray(self.velocity, coordinates, ("z", "y", "x", "axis"), "velocity", attributes)


class Fields(Mapping):
    """The fields of a run by step: `fields[100]`, `list(fields)`."""

    def __init__(self, folder):
        self._folder = folder

    @cached_property
    def _paths(self):
        paths = {int(path.stem.removeprefix("velocity-")): path for path in self._folder.glob("velocity-*.h5")}
        return dict(sorted(paths.items()))

    def __getitem__(self, step):
        with opened(self._paths[step], "fields") as file:
            velocity, attributes = file["velocity"][:], dict(file.attrs)
        time, strain = float(attributes["time"]), float(attributes["strain"])
        return Field(int(attributes["step"]), time, velocity, np.array(attributes["edges"]), strain)

    def __iter__(self):
        return iter(self._paths)

    def __len__(self):
        return len(self._paths)
