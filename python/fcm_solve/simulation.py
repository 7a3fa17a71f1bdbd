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
    """A running scene, and its results in a folder.

    scene    a `Scene`, a dict, or the path of a scene file; of any kind
    out      the folder of the results; by default that of the scene. If the scene names none, nothing is written
    force    replace the results of an earlier run in that folder
    threads  number of threads, the same for all computations of a process; the number of cores by default
    comm     an mpi4py communicator whose ranks compute together: every call is then collective, functions of forces are
             called on the first rank alone, and arrays are those of the first rank, empty on the others

    Use it in a `with` block: the folder is locked until the end of the block, and a checkpoint is written on exit, also
    after Ctrl-C or another exception. Arrays are copies of the present state.
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
        """Resumes the run of a folder from its last checkpoint. Functions of forces have to be added again.

        Changed values of `fluid.viscosity` and of keys of `[repulsion]` in the folder's scene are accepted if `accept` names them.
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

    # Progress and plan.

    @property
    def step(self) -> StepCount:
        """Number of steps taken; `sim.step()` takes one more, `sim.step(10)` ten."""
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
        """The plan of the computation, as text."""
        return self._core.plan()

    # Running.

    def run(self, steps: int | None = None, time: float | None = None) -> None:
        """Advances by a number of steps or by a time or, with neither, to the scene's end.

        A run that goes beyond the scene's end moves that end. Scenes of the continuum model are carried out as a
        whole, without `steps` and `time`. Ctrl-C ends the run between two evaluations; a checkpoint is written
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

        Exactly one trigger sets the steps at which it is carried out, from the present one on:

        every       the steps 0, n, 2n, ...
        every_time  the first steps at or after the times 0, t, 2t, ...
        at          a step, or several
        when        the steps after which this function of the simulation is true; it is called after each step

        Actions may be added and removed at any time, also by actions. An exception in an action ends `run` after the step.
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
        """Decorator for a function of the simulation, which is called at the steps 0, `steps`, 2 `steps`, ..."""
        steps = _arrays.whole("steps of every()", steps, 1)
        return lambda function: self.add(function, every=steps)

    def checkpoint(self) -> None:
        """Writes a checkpoint of the present state."""
        self._core.checkpoint()

    def close(self) -> None:
        """Writes a checkpoint, releases the folder and removes all actions. The state stays readable."""
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
            raise Error("this simulation is closed; continue it with fcm_solve.Simulation.resume(folder)")

    @property
    def _is_first(self):
        """Whether this is the first rank, which holds all arrays."""
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
        """The present state, complete enough to continue the run from it bit for bit. Its arrays can be changed."""
        return Snapshot(self._core)

    def set_snapshot(self, snapshot: Snapshot) -> None:
        """Sets the state to that of a snapshot, at its step and time.

        From an unchanged snapshot the run continues exactly as before, to the last bit. If arrays of the snapshot were changed, the
        particles take these values, and their history is dropped: velocities are computed again. Records in the folder after that
        step are dropped. The snapshot itself is not changed, and may come from another simulation of the same kind with the same
        number of particles. If the state is refused, the simulation is unchanged.
        """
        self._check_open()
        self._core.restore(*snapshot._changes())


def _positive(name, value):
    if not value > 0:
        raise ValueError(f"{name} is {value}; it needs to be above 0")
    return value
