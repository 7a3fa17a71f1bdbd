"""Steps that are counted, and functions that are called at some of them."""


class StepCount(int):
    """The number of steps taken. Called, it takes more: `sim.step()`, `sim.step(10)`."""

    def __new__(cls, number, simulation):
        count = super().__new__(cls, number)
        count._simulation = simulation
        return count

    def __call__(self, steps=1):
        """Takes steps, and records what is due."""
        self._simulation.run(steps=steps)

    def __reduce__(self):
        return int, (int(self),)


class Watcher:
    """A function that is called every so many steps, once at each."""

    def __init__(self, steps, function):
        self._steps, self._function, self._called = steps, function, -1

    def next_after(self, step):
        return (step // self._steps + 1) * self._steps

    def call_if_due(self, step, simulation):
        if step % self._steps == 0 and step != self._called:
            self._called = step
            self._function(simulation)
