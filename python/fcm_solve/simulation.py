"""Simulations of scenes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any
from warnings import warn

import numpy as np

from . import _arrays, _core
from ._communicator import handle
from ._errors import Caution, Error
from ._steps import StepCount, Watcher
from ._whole_scene import WholeScene
from .scene import Scene, scene_of
from .state import State

LoadFunction = Callable[[np.ndarray, float], Any]


class Simulation(State):
    """A scene that is run, and its results in a folder.

    scene    a `Scene`, a dict, or the path of a scene file; of any kind
    out      the folder of the results. If it is left out, that of the scene; if it names none, nothing is written
    force    replace the results of a former run in that folder
    threads  threads that compute; the same for all that a process computes. As many as there are cores if left out
    comm     an mpi4py communicator whose ranks work together: every call is then collective, functions of forces are
             called on the first rank alone, and arrays are those of the first rank, empty on the others

    Use it in a `with` block: the folder is held until its end, and a checkpoint is written when it is left, also by
    Ctrl-C or another exception. Arrays are copies of the state at the time.
    """

    def __init__(
        self,
        scene: Scene | dict[str, Any] | str | PathLike,
        out: str | PathLike | None = None,
        force: bool = False,
        threads: int | None = None,
        comm: Any = None,
    ) -> None:
        checked, force = scene_of(scene), _arrays.flag("force", force)
        _core.start_threads(None if threads is None else _arrays.whole("threads", threads, 1))
        folder = None if out is None else (fspath(out), force)
        if checked.is_whole:
            self._core = WholeScene(checked, folder, False)
        else:
            self._core = _core.Simulation.start((checked.to_toml(), checked._name), folder, handle(comm))
        self._begin()

    @classmethod
    def resume(
        cls, folder: str | PathLike, threads: int | None = None, comm: Any = None, accept: Sequence[str] = ()
    ) -> Simulation:
        """The run of a folder, from its last checkpoint. Functions of forces are to be added again.

        Other values of `fluid.viscosity` and of keys of `[repulsion]` in the folder's scene are taken if `accept` names them.
        """
        _core.start_threads(None if threads is None else _arrays.whole("threads", threads, 1))
        simulation = cls.__new__(cls)
        kept = Path(folder) / "scene.toml"
        if kept.exists() and Scene.load(kept).is_whole:
            simulation._core = WholeScene(Scene.load(kept), (fspath(folder), False), True)
        else:
            simulation._core = _core.Simulation.resume(fspath(folder), list(accept), handle(comm))
        simulation._begin()
        return simulation

    def _begin(self):
        self._watchers = []
        self._is_closed = False
        for caution in self._core.cautions():
            warn(caution, Caution, stacklevel=3)

    # How far it is.

    @property
    def step(self) -> StepCount:
        """Steps taken, a number; `sim.step()` takes one more, `sim.step(10)` ten."""
        return StepCount(self._core.clock()[0], self)

    @property
    def time(self) -> float:
        """The time."""
        return self._core.clock()[1]

    @property
    def end(self) -> int:
        """The step at which the scene ends."""
        return self._core.end()

    @property
    def plan(self) -> str:
        """How it is computed, in words."""
        return self._core.plan()

    # Running.

    def run(self, steps: int | None = None, time: float | None = None) -> None:
        """Takes so many steps more, or steps until so much more time has passed, or goes on to the scene's end.

        A run that goes beyond the scene's end moves that end. Sweeps and the continuum model are carried out as a
        whole, without `steps` and `time`. Ctrl-C ends the run between two evaluations; the checkpoint is written
        before `KeyboardInterrupt` is raised.
        """
        if self._is_closed:
            raise Error("this simulation is closed; go on with fcm_solve.Simulation.resume(folder)")
        if isinstance(self._core, WholeScene):
            self._core.run(steps, time)
            return
        last = self._last(steps, time)
        self._call_watchers()
        while self._core.clock()[0] < last:
            now = self._core.clock()[0]
            self._core.run_to(min([last, *(watcher.next_after(now) for watcher in self._watchers)]))
            self._call_watchers()

    def _last(self, steps, time):
        now, _ = self._core.clock()
        if steps is not None and time is not None:
            raise ValueError("steps and time are given; give one of them")
        if time is not None:
            steps = round(_positive("time", _arrays.number("time", time)) / self._core.time_step())
        elif steps is None:
            return self._core.end()
        return now + _arrays.whole("steps", steps, 0)

    def every(self, steps: int) -> Callable[[Callable], Callable]:
        """Decorates a function of the simulation that is called at the steps 0, `steps`, 2 `steps`, ..."""
        steps = _arrays.whole("steps of every()", steps, 1)

        def watched(function):
            self._watchers.append(Watcher(steps, function))
            return function

        return watched

    def _call_watchers(self):
        step = self._core.clock()[0]
        for watcher in self._watchers:
            watcher.call_if_due(step, self)

    def checkpoint(self) -> None:
        """Writes a checkpoint of the state now."""
        self._core.checkpoint()

    def close(self) -> None:
        """Writes a checkpoint and leaves the folder to others. The state stays readable."""
        if not self._is_closed:
            self._is_closed = True
            self._core.close()
            for warning in self._core.warnings():
                warn(warning, Caution, stacklevel=2)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # Forces.

    def force(self, function: LoadFunction) -> LoadFunction:
        """Adds a force of your own to the others, as a decorator or by a call.

        `function(positions, time)` is given positions (N, 3) in the order of the ids, which go on beyond the box as if
        there were no periodicity, and returns the forces (N, 3). It is called at each evaluation of the mobility, of
        which a step takes one or several, each with its own positions and time. What it raises ends the step, which is
        not taken, and reaches the caller. For suspensions.
        """
        return self._add("force", function, False)

    def torque(self, function: LoadFunction) -> LoadFunction:
        """The same of torques (N, 3)."""
        return self._add("torque", function, True)

    def _add(self, name, function, torques):
        def loads(positions, time):
            return _arrays.rows(f"the {name} of {function.__name__}", function(positions, time), len(positions))

        self._core.add_loads(loads, torques)
        return function


def _positive(name, value):
    if not value > 0:
        raise ValueError(f"{name} is {value}; it needs to be above 0")
    return value
