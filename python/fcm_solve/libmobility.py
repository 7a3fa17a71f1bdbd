"""The mobility with the interface of libMobility's solvers: an adapter for programs written for these."""

from __future__ import annotations

import numpy as np

from ._errors import InputError
from .mobility import Mobility

_WORDS = {"single_wall": "wall", "two_walls": "walls"}
_KNOWN = [("periodic",) * 3, ("open",) * 3, *(("periodic", "periodic", word) for word in ("open", "wall", "walls"))]


class FCM:
    """Spheres of one radius that are not rigid, without lubrication: forces and torques to velocities and angular velocities.

    Along x, y and z the fluid is "periodic" or "open"; along z it may have a "single_wall" at `zmin`, or "two_walls".
    """

    precision = "double"

    def __init__(self, periodicityX, periodicityY, periodicityZ):
        self._axes = tuple(_WORDS.get(word, word) for word in (periodicityX, periodicityY, periodicityZ))
        if self._axes not in _KNOWN:
            raise RuntimeError(f"the fluid is {self._axes} along x, y and z; it can be one of {_KNOWN}")
        self.setParameters()
        self.clean()

    def setParameters(self, Lx=1.0, Ly=1.0, Lz=1.0, zmin=0.0, zmax=None, shearStrain=0.0, delta=1e-3):
        self._box, self._origin = (Lx, Ly, Lz if zmax is None else zmax - zmin), np.array([0.0, 0.0, zmin])
        self._strain, self._delta = shearStrain, delta

    def initialize(self, viscosity, hydrodynamicRadius, includeAngular=False, tolerance=1e-4, seed=None):
        self._fluid, self._radius = {"viscosity": viscosity, "tolerance": tolerance}, hydrodynamicRadius
        self._angular, self._random = includeAngular, np.random.default_rng(seed)
        self.clean()

    def setPositions(self, positions):
        self._places, self._shape = _rows(positions), np.shape(positions)
        self._put(self._places)

    def Mdot(self, forces=None, torques=None):
        shapes = [np.shape(load) for load in (forces, torques) if load is not None]
        return self._shaped(self._motion(forces, torques), shapes[0], shapes[-1])

    def sqrtMdotW(self, prefactor=1.0):
        numbers = self._random.standard_normal((self._count(), 6)) * np.repeat([1, self._angular], 3)
        return self._shaped(np.hsplit(prefactor * self._mobility._root(numbers, False), 2), self._shape, self._shape)

    def divM(self, prefactor=1.0):
        """By random finite differences at walls; elsewhere it is zero."""
        found = 2 * [np.zeros((self._count(), 3))]
        if self._axes[2] in _WORDS.values():
            way, step, motions = self._random.standard_normal(self._places.shape), self._delta * self._radius, []
            for places in (self._places + step / 2 * way, self._places - step / 2 * way, self._places):
                self._put(places)
                motions.append(self._motion(way, None))
            found = [prefactor / step * (ahead - behind) for ahead, behind in zip(*motions[:2], strict=True)]
        return self._shaped(found, self._shape, self._shape)

    def LangevinVelocities(self, dt, kbt, forces=None, torques=None):
        count = self._count()
        shapes = [np.shape(load) for load in (forces, torques) if load is not None] or [self._shape]
        parts = [self._motion(forces, torques)] if forces is not None or torques is not None else []
        parts += [self.sqrtMdotW(np.sqrt(2 * kbt / dt)), self.divM(kbt)] if kbt else []
        sums = [sum((_rows(part[kind]) for part in parts), np.zeros((count, 3))) for kind in range(1 + self._angular)]
        return self._shaped(sums, shapes[0], shapes[-1])

    def clean(self):
        self._mobility, self._places = None, None

    def _put(self, places):
        try:
            self._plan_and_put(places)
        except InputError as error:
            raise RuntimeError(str(error)) from error

    def _plan_and_put(self, places):
        """Plans the mobility again if necessary. In unbounded fluid the box is made to contain the spheres."""
        is_open, reach = self._axes[0] == "open", np.ptp(places, axis=0).max()
        if self._mobility is None or len(self._mobility.radii) != len(places) or (is_open and reach > self._room):
            self._room = 2 * reach + 4 * self._radius
            box = 3 * [self._room] if is_open else self._box
            options = {"boundaries": self._axes, "multipoles": "dipole" if self._angular else "monopole", **self._fluid}
            options |= {"strain": self._strain} if self._strain else {}
            self._mobility = Mobility(box, self._radius, count=len(places), rigid=False, **options)
        self._mobility.positions = places - self._origin

    def _count(self):
        if self._mobility is None:
            raise RuntimeError("there are no positions; call setPositions first")
        return len(self._places)

    def _motion(self, forces, torques):
        loads = {name: _rows(load) for name, load in (("forces", forces), ("torques", torques)) if load is not None}
        if any(len(load) != self._count() for load in loads.values()):
            raise RuntimeError(f"there are {self._count()} spheres; a force, or a torque, is needed for each")
        if torques is not None and not self._angular:
            raise RuntimeError("torques are given; initialize with includeAngular=True")
        motion = self._mobility(**loads)
        return motion.velocities, motion.angular_velocities

    def _shaped(self, motion, *shapes):
        linear, angular = (np.reshape(rows, shape) for rows, shape in zip([*motion, motion[0]][:2], shapes, strict=True))
        return linear, angular if self._angular else None


def _rows(array):
    rows = np.asarray(array, dtype=np.float64)
    if rows.size == 0 or rows.size % 3 or (rows.ndim != 1 and (rows.ndim != 2 or rows.shape[1] != 3)):
        raise RuntimeError(f"an array has the shape {rows.shape}; it needs to be (N, 3) or (3 N,)")
    return np.ascontiguousarray(rows.reshape(-1, 3))
