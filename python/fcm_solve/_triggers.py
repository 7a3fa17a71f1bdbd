"""Triggers: the steps at which actions are due."""

import math

from . import _arrays
from ._errors import InputError

# Tolerance for round-off of times and intervals, as a fraction of a step.
_ROUND_OFF = 1e-9


class EveryStep:
    """The steps 0, n, 2n, ..."""

    def __init__(self, steps):
        self._steps = _arrays.whole("every", steps, 1)

    def next_after(self, step, time_step):
        return (step // self._steps + 1) * self._steps

    def is_due(self, simulation):
        return simulation.step % self._steps == 0


class EveryTime:
    """The first steps at or after the times 0, t, 2t, ..."""

    def __init__(self, interval):
        self._interval = _arrays.number("every_time", interval)
        if not self._interval > 0:
            raise InputError(f"every_time is {self._interval}; it needs to be above 0")

    def next_after(self, step, time_step):
        passed = math.floor(step * time_step / self._interval + _ROUND_OFF)
        return max(step + 1, math.ceil((passed + 1) * self._interval / time_step - _ROUND_OFF))

    def is_due(self, simulation):
        step, time_step = int(simulation.step), simulation._core.time_step()
        return step == 0 or self.next_after(step - 1, time_step) == step


class AtSteps:
    """A list of steps."""

    def __init__(self, steps):
        listed = [steps] if isinstance(steps, int) or not hasattr(steps, "__iter__") else steps
        self._steps = sorted({_arrays.whole("a step of at", step, 0) for step in listed})
        if not self._steps:
            raise InputError("at has no steps; give at least one")

    def next_after(self, step, time_step):
        return next((due for due in self._steps if due > step), math.inf)

    def is_due(self, simulation):
        return int(simulation.step) in self._steps


class When:
    """The steps after which a function of the simulation is true."""

    def __init__(self, function):
        if not callable(function):
            raise InputError(f"when is {function!r}; it needs to be a function of the simulation")
        self._function = function

    def next_after(self, step, time_step):
        return step + 1

    def is_due(self, simulation):
        return bool(self._function(simulation))


_KINDS = {"every": EveryStep, "every_time": EveryTime, "at": AtSteps, "when": When}


def of(given):
    """The trigger for the one keyword that is given."""
    named = {name: value for name, value in given.items() if value is not None}
    if len(named) != 1:
        found = " and ".join(named) or "none"
        raise InputError(f"an action has one trigger, of {', '.join(_KINDS)}; found {found}")
    [(name, value)] = named.items()
    return _KINDS[name](value)
