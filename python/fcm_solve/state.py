"""The present state of a simulation, as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._arrays import axes_of
from ._errors import Error


class State:
    """Present particles, in the order of their ids, and observables of them. Arrays are copies."""

    _core: Any

    @property
    def positions(self) -> np.ndarray:
        """(N, 3), inside the box, in the order of the ids; length"""
        return self._core.frame()["positions"]

    @property
    def unwrapped_positions(self) -> np.ndarray:
        """(N, 3), without wrapping into the periodic box, as passed to functions of forces; length"""
        frame = self._core.frame()
        return frame["positions"] + frame["images"] @ frame["lattice"]

    @property
    def velocities(self) -> np.ndarray:
        """(N, 3), the background flow included; length/time"""
        return self._column("velocity")

    @property
    def angular_velocities(self) -> np.ndarray:
        """(N, 3), the background flow's rotation included; 1/time"""
        return self._column("angular_velocity")

    @property
    def orientations(self) -> np.ndarray:
        """(N, 4): quaternions w, x, y, z, from axes fixed in the sphere to those of space; zeros for spheres without orientation"""
        return self._column("orientation")

    @property
    def axes(self) -> np.ndarray:
        """(N, 3): unit vectors, the third axis of each orientation; zeros for spheres without orientation"""
        return axes_of(self.orientations)

    @property
    def stresslets(self) -> np.ndarray:
        """(N, 5): xx, xy, xz, yy, yz, hydrodynamic; force*length"""
        return self._column("stresslet")

    @property
    def radii(self) -> np.ndarray:
        """(N,), length"""
        return self._core.frame()["radii"]

    @property
    def species(self) -> np.ndarray:
        """(N,), indices into the scene's list"""
        return self._core.frame()["species"]

    @property
    def bodies(self) -> np.ndarray:
        """(N,), the number of the rigid body of each sphere, -1 for none; in scenes with bodies"""
        return self._column("body")[:, 0].astype(int)

    @property
    def lattice(self) -> np.ndarray:
        """(3, 3), the vectors of the box as rows; length"""
        return self._core.frame()["lattice"]

    @property
    def observables(self) -> dict[str, float | np.ndarray]:
        """Present quantities of the time series by name: numbers, or arrays over species and components."""
        return {name: _quantity(table, numbers) for name, _, table, numbers in self._core.observables()}

    @property
    def smallest_gap(self) -> float:
        """The smallest gap between two surfaces, negative if they overlap; length"""
        return self._named("smallest_gap", self.observables)

    def _column(self, name):
        return self._named(name, self._core.frame())

    @staticmethod
    def _named(name, items):
        if name not in items:
            raise Error(f"scenes of this kind have no {name}; there are {', '.join(items)}")
        return items[name]


def _quantity(table, numbers):
    if table is None:
        return numbers[0]
    rows, columns = table
    return np.reshape(numbers, (len(rows), len(columns)))
