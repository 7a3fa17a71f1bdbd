"""Forces and torques of one's own in a simulation, and their part in the stress."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from . import _arrays
from ._errors import InputError
from .neighbours import Neighbours

LoadFunction = Callable[[np.ndarray, float], Any]
PairFunction = Callable[[Neighbours, float], Any]

# Part of the forces' size that their sum may be, where they are between particles: round-off of many.
_UNBALANCED = 1e-8
_STRESSES = (None, "moments", "positions")


class OwnForces:
    """Functions of forces and torques, added to those of the scene."""

    _core: Any

    def force(self, function: LoadFunction | None = None, *, stress: str | None = None) -> Any:
        """Adds a force of your own to the others, as a decorator or by a call.

        `function(positions, time)` is given positions (N, 3) in the order of the ids, which go on beyond the box as if
        there were no periodicity, and returns the forces (N, 3). It is called at each evaluation of the mobility, of
        which a step takes one or several, each with its own positions and time. What it raises ends the step, which is
        not taken, and reaches the caller. For suspensions.

        stress  what part the forces have in the stress:
                None         none, as forces from outside
                "moments"    the function returns `(forces, moments)`, with each particle's share (N, 6) of the symmetric first
                             moments -sym((x_i - x_j) F_ij) of forces between particles: xx, xy, xz, yy, yz, zz
                "positions"  the moments are -sym(x F) by the positions that the function is given; the forces have to add
                             up to zero, and those of a pair have to be by those positions, not by images

        Stress over the volume is in the time series as `stress_applied`, and in all that is made of the stress.
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
        """Adds a torque of your own, as `force` does: the function returns torques (N, 3)."""
        name = _named("torque", function)

        def torques(positions, time):
            return _arrays.rows(name, function(positions, time), len(positions))

        self._core.add_loads(torques, "torques", None)
        return function

    def pair_force(self, function: PairFunction | None = None, *, cutoff: float) -> Any:
        """Adds a force between near particles, as a decorator, `@sim.pair_force(cutoff=3.0)`, or by a call.

        `function(neighbours, time)` is given the `Neighbours` whose centres are nearer than `cutoff`, images included, and
        returns the force (P, 3) on the first of each pair; the second feels the opposite one. Its stress is in the time series
        as `stress_applied`, and in all that is made of the stress. It is called as those of `force` are. For suspensions.
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
        """The pairs of particles whose centres are nearer than `cutoff` now, each once over all images."""
        cutoff = _positive("cutoff", cutoff)
        return Neighbours(self._core.neighbours(cutoff), cutoff)


def _with_moments(name, forces, positions):
    """Forces between particles, and the moments -sym(x F) of them."""
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
