"""Snapshots of the state of a simulation, which can be changed and set."""

from __future__ import annotations

import numpy as np

from . import _arrays
from ._errors import Error

_NO_INERTIA = (
    "spheres in Stokes flow have no {} of their own: they follow from the positions, which can be set; simulation.{} has them"
)


class Snapshot:
    """The complete state of a simulation at a step, by `simulation.get_snapshot()`, for `simulation.set_snapshot(snapshot)`.

    Arrays are in the order of the ids, on the first rank. They can be changed in place or assigned. Unchanged values are kept to
    the last bit.
    """

    def __init__(self, core):
        self._state = core.snapshot()
        self._step, self._time = core.clock()
        self._taken = core.frame()
        names = ("positions", "radii", *(("velocity", "angular_velocity") if self._state.has_inertia else ()))
        self._arrays = {name: self._taken[name].copy() for name in (*names, "orientation") if name in self._taken}

    @property
    def step(self) -> int:
        """Steps taken."""
        return self._step

    @property
    def time(self) -> float:
        """The time."""
        return self._time

    @property
    def positions(self) -> np.ndarray:
        """(N, 3), inside the box; new values may be outside; length"""
        return self._arrays["positions"]

    @positions.setter
    def positions(self, value):
        self._set("positions", value)

    @property
    def radii(self) -> np.ndarray:
        """(N,); can be changed for spheres in Stokes flow, fixed by the scene for grains; length"""
        return self._arrays["radii"]

    @radii.setter
    def radii(self, value):
        self._set("radii", value)

    @property
    def velocities(self) -> np.ndarray:
        """(N, 3), for grains, which have inertia; length/time"""
        return self._of_inertia("velocity", "velocities")

    @velocities.setter
    def velocities(self, value):
        self._of_inertia("velocity", "velocities")
        self._set("velocity", value)

    @property
    def angular_velocities(self) -> np.ndarray:
        """(N, 3), for grains that rotate; 1/time"""
        return self._of_inertia("angular_velocity", "angular_velocities")

    @angular_velocities.setter
    def angular_velocities(self, value):
        self._of_inertia("angular_velocity", "angular_velocities")
        self._set("angular_velocity", value)

    @property
    def orientations(self) -> np.ndarray:
        """(N, 4): quaternions w, x, y, z; new values of any length; zeros for spheres without orientation"""
        if "orientation" not in self._arrays:
            raise Error("spheres of this scene have no orientations; species.orientation asks for them")
        return self._arrays["orientation"]

    @orientations.setter
    def orientations(self, value):
        _ = self.orientations
        self._set("orientation", value)

    @property
    def ids(self) -> np.ndarray:
        """(N,), ids of the particles"""
        return self._taken["ids"]

    @property
    def species(self) -> np.ndarray:
        """(N,), indices into the scene's list"""
        return self._taken["species"]

    @property
    def lattice(self) -> np.ndarray:
        """(3, 3), the vectors of the box as rows; length"""
        return self._taken["lattice"]

    def _of_inertia(self, name, plural):
        if not self._state.has_inertia:
            raise Error(_NO_INERTIA.format(plural.replace("_", " "), plural))
        if name not in self._arrays:
            raise Error(f"grains of this kind have no {plural.replace('_', ' ')}")
        return self._arrays[name]

    def _set(self, name, value):
        before = self._arrays[name]
        self._arrays[name] = np.array(_arrays.exactly(name, value, before.shape), order="C")

    def _changes(self):
        """The state, and the changed rows of each array, in the form that the compiled part takes."""
        moved = [self._changed(name) for name in ("positions", "velocity", "angular_velocity", "orientation")]
        ids, radii = self._changed("radii")
        return self._state, tuple(moved), (ids, radii.tolist())

    def _changed(self, name):
        if name == "orientation" and name not in self._taken:
            return [], np.empty((0, 4))
        taken = self._taken.get(name, np.empty((0, 3)))
        now = _arrays.exactly(name, self._arrays.get(name, taken), taken.shape)
        is_changed = (now != taken) if taken.ndim == 1 else (now != taken).any(axis=1)
        return self.ids[is_changed].tolist(), np.ascontiguousarray(now[is_changed])

    def __repr__(self):
        return f"<fcm_solve.Snapshot of {len(self.ids)} particles at step {self._step}>"
