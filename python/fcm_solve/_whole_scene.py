"""Scenes without time steps, which are carried out as a whole: those of the continuum model."""

import logging

from . import _core
from ._errors import Error

_log = logging.getLogger("fcm_solve")
NO_STEPS = "scenes of this kind have no steps"


class WholeScene:
    """Stands for the simulation of a scene without time steps; supports `run` alone."""

    def __init__(self, scene, folder, goes_on):
        self._scene, self._folder, self._goes_on = scene, folder, goes_on

    def run(self, steps, time):
        """Carries out the scene; its messages go to the logger `fcm_solve`."""
        if steps is not None or time is not None:
            raise Error(f"{NO_STEPS}: run() carries them out as a whole")
        scene = (self._scene.to_toml(), self._scene._name)
        _core.carry_out(scene, self._folder, self._goes_on, _log.info)

    def cautions(self):
        return []

    warnings = cautions

    def close(self):
        """Does nothing: the results are complete at any time."""

    def __getattr__(self, name):
        raise Error(f"{NO_STEPS}: run() carries them out as a whole")
