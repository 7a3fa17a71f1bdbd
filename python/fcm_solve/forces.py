"""User-defined forces and torques in a simulation, and their contribution to the stress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from . import _arrays
from ._errors import InputError
from .neighbours import Neighbours

LoadFunction = Callable[[np.ndarray, float], Any]
PairFunction = Callable[[Neighbours, float], Any]

# Tolerance for the sum of forces between particles, as a fraction of their total magnitude: round-off of many.
_UNBALANCED = 1e-8
_STRESSES = (None, "moments", "positions")


class OwnForces:
    """Adds functions of forces and torques to the loads of a scene."""

    _core: Any

    def force(self, function: LoadFunction | None = None, *, stress: str | None = None) -> Any:
        """Adds a user-defined force to the others, as a decorator or by a call.

        `function(positions, time)` takes the unwrapped positions (N, 3), in the order of the ids, and returns the forces
        (N, 3). It is called at each evaluation of the mobility, of which a step takes one or several, each with its own
        positions and time. An exception that it raises ends the step, which is not taken, and is passed on to the caller.
        For suspensions.

        stress  contribution of the forces to the stress:
                None         none, as of external forces
                "moments"    the function returns `(forces, moments)`, with each particle's share (N, 6) of the symmetric first
                             moments -sym((x_i - x_j) F_ij) of forces between particles: xx, xy, xz, yy, yz, zz
                "positions"  the moments are -sym(x F) with the positions passed to the function; the forces have to add
                             up to zero, and the force of a pair has to follow from these positions, not from images

        The stress, divided by the volume, is `stress_applied` in the time series, and part of all results on the stress.
        """
        if stress not in _STRESSES:
            raise InputError(f'stress is {stress!r}; it needs to be None, "moments" or "positions"')
        if function is None:
            return lambda function: self.force(function, stress=stress)
        name = _named("force", function)

        def forces(positions, time):
            return _arrays.rows(name, function(positions, time), len(positions))

        def with_moments(positions, time):
            if stress == "positions":
                return _with_moments(name, forces(positions, time), positions)
            given = function(positions, time)
            if not (isinstance(given, tuple) and len(given) == 2):
                raise InputError(f"{name} returned {type(given).__name__}; with stress=\"moments\" it is (forces, moments)")
            moments = _arrays.rows(f"the moments of {_name_of(function)}", given[1], len(positions), 6)
            return _arrays.rows(name, given[0], len(positions)), moments

        if stress is None:
            self._core.add_loads(forces, "forces", None)
        else:
            self._core.add_loads(with_moments, "moments", None)
        return function

    def torque(self, function: LoadFunction) -> LoadFunction:
        """Adds a user-defined torque, as `force` adds a force: the function returns torques (N, 3)."""
        name = _named("torque", function)

        def torques(positions, time):
            return _arrays.rows(name, function(positions, time), len(positions))

        self._core.add_loads(torques, "torques", None)
        return function

    def pair_force(self, function: PairFunction | None = None, *, cutoff: float) -> Any:
        """Adds a pair force between near particles, as a decorator, `@sim.pair_force(cutoff=3.0)`, or by a call.

        `function(neighbours, time)` takes the `Neighbours` whose centres are nearer than `cutoff`, images included, and
        returns the force (P, 3) on the first particle of each pair; the opposite force acts on the second. Its stress is
        `stress_applied` in the time series, and part of all results on the stress. The function is called at the same times
        as those of `force`. For suspensions.
        """
        cutoff = _positive("cutoff", cutoff)
        if function is None:
            return lambda function: self.pair_force(function, cutoff=cutoff)
        name = _named("pair force", function)

        def forces(near, time):
            return _arrays.rows(name, function(Neighbours(near, cutoff), time), len(near))

        self._core.add_loads(forces, "pairs", cutoff)
        return function

    def neighbours(self, cutoff: float) -> Neighbours:
        """The present pairs of particles whose centres are nearer than `cutoff`, each once over all images."""
        cutoff = _positive("cutoff", cutoff)
        return Neighbours(self._core.neighbours(cutoff), cutoff)


def _with_moments(name, forces, positions):
    """Forces between particles, and their moments -sym(x F)."""
    size = np.abs(forces).sum(axis=0)
    left = np.abs(forces.sum(axis=0))
    if np.any(left > _UNBALANCED * max(size.max(initial=0.0), np.finfo(float).tiny)):
        raise InputError(f'{name} adds up to {forces.sum(axis=0)}; with stress="positions" it needs to add up to zero')
    places = positions - positions.mean(axis=0)
    outer = -places[:, :, None] * forces[:, None, :]
    symmetric = 0.5 * (outer + outer.transpose(0, 2, 1))
    rows, columns = np.triu_indices(3)
    return forces, np.ascontiguousarray(symmetric[:, rows, columns])


def _name_of(function):
    return getattr(function, "__name__", type(function).__name__)


def _named(what, function):
    return f"the {what} of {_name_of(function)}"


def _positive(name, value):
    number = _arrays.number(name, value)
    if not number > 0:
        raise InputError(f"{name} is {number}; it needs to be above 0")
    return number
