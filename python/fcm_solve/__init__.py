"""Particles in viscous flow by the force-coupling method.

Mobility    the mobility of spheres at given positions, planned once
Scene       a checked scene file: the description of a computation
Simulation  a running scene, with callbacks and user-defined forces
Logger, Writer, Action  actions carried out during a simulation, at the steps of a trigger
run_family  many runs over seeds and values of keys, and the means over the seeds
open        the results of a run, for pandas and xarray
report      an HTML page about a run; show displays it in a notebook
"""

import os

# Allows other programs to read the files of a run while they are written. HDF5 reads this variable when it is loaded.
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")

from ._core import __version__  # noqa: E402
from ._errors import Caution, Error, InputError  # noqa: E402
from .actions import Action  # noqa: E402
from .answers import Answer, Answers  # noqa: E402
from .families import run_family  # noqa: E402
from .loggers import Logger, Writer  # noqa: E402
from .mobility import Drift, Mobility, Motion, Noise, Plan  # noqa: E402
from .neighbours import Neighbours  # noqa: E402
from .pages import report, show  # noqa: E402
from .results import Run, open  # noqa: A004, E402
from .scene import Scene  # noqa: E402
from .simulation import Simulation  # noqa: E402
from .snapshots import Snapshot  # noqa: E402

__all__ = [
    "Action",
    "Answer",
    "Answers",
    "Caution",
    "Drift",
    "Error",
    "InputError",
    "Logger",
    "Mobility",
    "Motion",
    "Neighbours",
    "Noise",
    "Plan",
    "Run",
    "Scene",
    "Simulation",
    "Snapshot",
    "Writer",
    "__version__",
    "open",
    "report",
    "run_family",
    "show",
]
