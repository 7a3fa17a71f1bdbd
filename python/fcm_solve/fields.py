"""Velocity of the fluid at grid points of the box, by step."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._extras import needed
from ._hdf5 import opened


@dataclass(frozen=True)
class Field:
    """Velocity of the fluid at one time, relative to the background flow."""

    step: int
    """Steps taken."""
    time: float
    """The time."""
    velocity: np.ndarray
    """(nz, ny, nx, 3), length/time"""
    edges: np.ndarray
    """(3,), edges of the box; length"""
    strain: float
    """The box's Lees-Edwards strain: its second edge is (strain Ly, Ly, 0)."""
    origin: np.ndarray
    """(3,), position of the first grid point; length"""
    spacing: np.ndarray
    """(3,), distances of grid points along the edges; length"""

    def to_xarray(self):
        """A DataArray whose coordinates are the positions of the grid points along the edges of the box."""
        xarray = needed("xarray", "field.to_xarray()")
        counts = self.velocity.shape[2::-1]
        places = {
            name: first + np.arange(n) * step for name, n, first, step in zip("xyz", counts, self.origin, self.spacing)
        }
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
        edges = np.array(attributes["edges"])
        # Files of fully periodic boxes do not have the positions of the grid points: they start at 0 and cover the box.
        origin = np.array(attributes.get("origin", np.zeros(3)))
        spacing = np.array(attributes.get("spacing", edges / velocity.shape[2::-1]))
        return Field(int(attributes["step"]), time, velocity, edges, strain, origin, spacing)

    def __iter__(self):
        return iter(self._paths)

    def __len__(self):
        return len(self._paths)
