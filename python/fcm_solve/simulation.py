"""Simulations of scenes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any
from warnings import warn

from . import _arrays, _core
from ._communicator import handle
from ._errors import Caution, Error
from ._steps import StepCount
from ._whole_scene import NO_STEPS, WholeScene
from .actions import Action, ActionList
from .forces import OwnForces
from .scene import Scene, scene_of
from .snapshots import Snapshot
from .state import State


class Simulation(State, OwnForces):
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
        self._begin(comm, is_resumed=False)

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
        simulation._begin(comm, is_resumed=True)
        return simulation

    def _begin(self, comm, is_resumed):
        self._comm, self._is_resumed = comm, is_resumed
        self._actions = ActionList()
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

        A run that goes beyond the scene's end moves that end. Scenes of the continuum model are carried out as a
        whole, without `steps` and `time`. Ctrl-C ends the run between two evaluations; the checkpoint is written
        before `KeyboardInterrupt` is raised.
        """
        self._check_open()
        if isinstance(self._core, WholeScene):
            self._core.run(steps, time)
            return
        last = self._last(steps, time)
        self._actions.act(self)
        while (now := self._core.clock()[0]) < last:
            self._core.run_to(min(last, self._actions.next_after(now, self._core.time_step())))
            if self._core.clock()[0] == now:
                return
            self._actions.act(self)

    def _last(self, steps, time):
        now, _ = self._core.clock()
        if steps is not None and time is not None:
            raise ValueError("steps and time are given; give one of them")
        if time is not None:
            steps = round(_positive("time", _arrays.number("time", time)) / self._core.time_step())
        elif steps is None:
            return self._core.end()
        return now + _arrays.whole("steps", steps, 0)

    # Actions.

    def add(
        self,
        action: Action | Callable[[Simulation], Any],
        *,
        every: int | None = None,
        every_time: float | None = None,
        at: int | Iterable[int] | None = None,
        when: Callable[[Simulation], Any] | None = None,
    ) -> Any:
        """Adds an action, and returns it: a function of the simulation, or an object such as an `Action`, `Logger` or `Writer`.

        One trigger says when it is carried out, once at each of these steps, from the present one on:

        every       the steps 0, n, 2n, ...
        every_time  the first steps at or after the times 0, t, 2t, ...
        at          a step, or several
        when        the steps after which this function of the simulation is true; it is called after each step

        Actions may be added and removed at any time, also by actions. What an action raises ends `run` after the step.
        """
        if isinstance(self._core, WholeScene):
            raise Error(NO_STEPS)
        self._check_open()
        self._actions.add(action, {"every": every, "every_time": every_time, "at": at, "when": when}, self)
        return action

    def remove(self, action: Action | Callable[[Simulation], Any]) -> None:
        """Removes an action, with all of its triggers."""
        self._actions.remove(action, self)

    @property
    def actions(self) -> tuple:
        """The actions, in the order in which they were added."""
        return self._actions.listed()

    def every(self, steps: int) -> Callable[[Callable], Callable]:
        """Decorates a function of the simulation that is called at the steps 0, `steps`, 2 `steps`, ..."""
        steps = _arrays.whole("steps of every()", steps, 1)
        return lambda function: self.add(function, every=steps)

    def checkpoint(self) -> None:
        """Writes a checkpoint of the state now."""
        self._core.checkpoint()

    def close(self) -> None:
        """Writes a checkpoint, leaves the folder to others and gives all actions back. The state stays readable."""
        if not self._is_closed:
            self._is_closed = True
            try:
                self._actions.remove_all(self)
            finally:
                self._core.close()
            for warning in self._core.warnings():
                warn(warning, Caution, stacklevel=2)

    def _check_open(self):
        if self._is_closed:
            raise Error("this simulation is closed; go on with fcm_solve.Simulation.resume(folder)")

    @property
    def _is_first(self):
        """Whether this is the first rank, which has all arrays."""
        return self._comm is None or self._comm.rank == 0

    def _agree(self, error):
        """Raises the error of the first rank, if it has one, on all ranks. Collective."""
        said = None if self._comm is None else self._comm.bcast(None if error is None else str(error))
        if self._is_first and error is not None:
            raise error
        if said is not None:
            raise Error(said)

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # Snapshots.

    def get_snapshot(self) -> Snapshot:
        """The state now, with all that the run needs to go on from it bit for bit. Its arrays can be changed."""
        return Snapshot(self._core)

    def set_snapshot(self, snapshot: Snapshot) -> None:
        """Goes back, or on, to the state of a snapshot, at its step and time.

        Unchanged, the run goes on from it as it did, to the last bit. Where arrays of the snapshot were changed, particles are where
        and as these say, and nothing is left of how they moved before: velocities are computed again. What was recorded in the
        folder after that step is dropped. The snapshot stays what it is, and may be one of another simulation of the same kind with
        as many particles. A state that is refused leaves all as it was.
        """
        self._check_open()
        self._core.restore(*snapshot._changes())


def _positive(name, value):
    if not value > 0:
        raise ValueError(f"{name} is {value}; it needs to be above 0")
    return value
