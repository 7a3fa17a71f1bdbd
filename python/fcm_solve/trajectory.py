"""The trajectory of a run, whose frames are read on access."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from operator import index
from typing import TYPE_CHECKING

import numpy as np

from ._arrays import axes_of
from ._extras import needed
from ._hdf5 import opened
from .lazy import Dataset, Unwrapped, variable

if TYPE_CHECKING:
    import xarray

_COMPONENTS = {
    3: ("axis", ["x", "y", "z"]),
    4: ("quaternion", ["w", "x", "y", "z"]),
    5: ("component", ["xx", "xy", "xz", "yy", "yz"]),
}
_UNITS = {
    "position": "length",
    "velocity": "length/time",
    "angular_velocity": "1/time",
    "stresslet": "force*length",
    "orientation": "",
}


@dataclass(frozen=True)
class Frame:
    """The particles at one time, in the order of their ids."""

    step: int
    """Steps taken."""
    time: float
    """The time."""
    positions: np.ndarray
    """(N, 3), inside the box; length"""
    images: np.ndarray
    """(N, 3), numbers of lattice vectors removed by wrapping"""
    lattice: np.ndarray
    """(3, 3), the vectors of the box as rows; length"""
    columns: dict = field(repr=False)
    """Further columns that the run has written: velocity and angular_velocity (N, 3), stresslet (N, 5), orientation (N, 4)"""

    @property
    def unwrapped_positions(self):
        """(N, 3), without wrapping into the periodic box; length"""
        return self.positions + self.images @ self.lattice

    @property
    def velocities(self):
        """(N, 3), the background flow included; length/time"""
        return self.columns["velocity"]

    @property
    def angular_velocities(self):
        """(N, 3), the background flow's rotation included; 1/time"""
        return self.columns["angular_velocity"]

    @property
    def orientations(self):
        """(N, 4): quaternions w, x, y, z; zeros for spheres without orientation"""
        return self.columns["orientation"]

    @property
    def axes(self):
        """(N, 3): unit vectors, the third axis of each orientation; zeros for spheres without orientation"""
        return axes_of(self.orientations)

    @property
    def stresslets(self):
        """(N, 5): xx, xy, xz, yy, yz; force*length"""
        return self.columns["stresslet"]


class Trajectory:
    """Frames of N particles: `len(trajectory)` is their number, `trajectory[-1]` the last one."""

    def __init__(self, path):
        self._file = opened(path, "trajectory")
        self._particles = self._file["particles/all"]
        self._count = len(self._particles["position/step"])

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, frame: int) -> Frame:
        number = range(self._count)[index(frame)]
        columns = {name: self._particles[f"{name}/value"][number] for name in self._columns}
        lattice = self._particles["box/edges/value"][number]
        place = columns.pop("position"), self._particles["image/value"][number], lattice
        return Frame(int(self.steps[number]), float(self.times[number]), *place, columns)

    @cached_property
    def steps(self):
        """(frames,), steps"""
        return self._particles["position/step"][: self._count]

    @cached_property
    def times(self):
        """(frames,), times"""
        return self._particles["position/time"][: self._count]

    @cached_property
    def ids(self):
        """(N,), ids of the particles"""
        return self._particles["id"][:]

    @cached_property
    def radii(self):
        """(N,), length"""
        return self._particles["radius"][:]

    @cached_property
    def species(self):
        """(N,), indices into the scene's list"""
        return self._particles["species"][:]

    @cached_property
    def bodies(self):
        """(N,), the number of the rigid body of each sphere, -1 for none; in scenes with bodies"""
        return self._particles["body"][:]

    @property
    def _columns(self):
        return [name for name in _UNITS if name in self._particles]

    def to_xarray(self, unwrapped: bool = False) -> xarray.Dataset:
        """An xarray Dataset over time and particles, whose values are read on access.

        unwrapped  positions without wrapping, instead of those inside the periodic box
        """
        images, edges = self._dataset("image"), self._dataset("box/edges")
        variables = {name: self._variable(name, self._dataset(name)) for name in self._columns}
        if unwrapped:
            positions = Unwrapped(self._dataset("position"), images, edges)
            variables["position"] = self._variable("position", positions)
        else:
            variables["image"] = variable(("time", "particle", "axis"), images, {})
        variables["lattice"] = variable(("time", "vector", "axis"), edges, {"units": "length"})
        return _labelled(variables, self)

    def _dataset(self, name):
        return Dataset(self._particles[f"{name}/value"], self._count)

    def _variable(self, name, array):
        dimension, _ = _COMPONENTS[array.shape[2]]
        return variable(("time", "particle", dimension), array, {"units": _UNITS[name]})

    def close(self):
        """Closes the file; values that were not read yet are no longer available."""
        self._file.close()


def _labelled(variables, trajectory):
    xarray = needed("xarray", "trajectory.to_xarray()")
    dimensions = {dimension for held in variables.values() for dimension in held.dims}
    labels = {name: labels for name, labels in _COMPONENTS.values() if name in dimensions}
    coordinates = {
        "time": trajectory.times,
        "step": ("time", trajectory.steps),
        "particle": trajectory.ids,
        "radius": ("particle", trajectory.radii, {"units": "length"}),
        "species": ("particle", trajectory.species),
    }
    return xarray.Dataset(variables, coords={**coordinates, **labels})
