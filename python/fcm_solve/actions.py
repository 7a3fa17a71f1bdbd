"""Actions, carried out during a simulation at the steps of a trigger."""

from __future__ import annotations

from types import MethodType
from typing import TYPE_CHECKING

from . import _triggers
from ._errors import Error, InputError

if TYPE_CHECKING:
    from .simulation import Simulation


class Action:
    """Base class of actions with a state. Subclasses define `act`, and the other methods if they need them.

    Actions are added by `simulation.add(action, every=100)`, as are plain functions of the simulation.
    """

    def attach(self, simulation: Simulation) -> None:
        """Called when the action is added to a simulation, before anything else."""

    def act(self, simulation: Simulation) -> None:
        """Called once at each step of the trigger."""
        raise NotImplementedError

    def detach(self, simulation: Simulation) -> None:
        """Called when the action is removed, or the simulation is closed."""


class ActionList:
    """The actions of a simulation, each with its trigger, in the order in which they were added."""

    def __init__(self):
        self._entries = []

    def add(self, action, triggers, simulation):
        """Adds an action; changes nothing if its `attach` raises an exception."""
        if not callable(getattr(action, "act", None)) and not callable(action):
            raise InputError(f"{action!r} is not an action; it needs to be a function of the simulation, or to have act()")
        entry = _Entry(action, _triggers.of(triggers))
        if not self._has(action) and hasattr(action, "attach"):
            action.attach(simulation)
        self._entries.append(entry)

    def remove(self, action, simulation):
        """Removes an action, with all of its triggers."""
        if not self._has(action):
            raise Error(f"{action!r} is not an action of this simulation")
        self._entries = [entry for entry in self._entries if not _are_same(entry.action, action)]
        if hasattr(action, "detach"):
            action.detach(simulation)

    def remove_all(self, simulation):
        """Removes all actions, and raises the first error that one of them has raised."""
        errors = []
        for action in self.listed():
            try:
                self.remove(action, simulation)
            except Exception as error:  # noqa: BLE001
                errors.append(error)
        if errors:
            raise errors[0]

    def listed(self):
        """Each action once."""
        return tuple(entry.action for place, entry in enumerate(self._entries) if not self._has(entry.action, place))

    def _has(self, action, among=None):
        return any(_are_same(entry.action, action) for entry in self._entries[:among])

    def next_after(self, step, time_step):
        """The first step after `step` at which any action is due; infinity if there is none."""
        return min((entry.trigger.next_after(step, time_step) for entry in self._entries), default=float("inf"))

    def act(self, simulation):
        """Carries out the actions that are due at the present step, each once. Actions may add and remove actions."""
        done = []
        while waiting := [entry for entry in self._entries if not any(entry is other for other in done)]:
            done.append(waiting[0])
            waiting[0].act_if_due(simulation)


def _are_same(one, other):
    """Whether both are the same action: each access creates a new bound method, so they are compared by value."""
    return one is other or (isinstance(one, MethodType) and one == other)


class _Entry:
    def __init__(self, action, trigger):
        self.action, self.trigger, self._asked = action, trigger, None
        self._act = action.act if callable(getattr(action, "act", None)) else action

    def act_if_due(self, simulation):
        step = int(simulation.step)
        if step != self._asked:
            self._asked = step
            if self.trigger.is_due(simulation):
                self._act(simulation)
