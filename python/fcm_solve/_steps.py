"""Step counter that advances the simulation when it is called."""


class StepCount(int):
    """Number of steps taken. A call takes further steps: `sim.step()`, `sim.step(10)`."""

    def __new__(cls, number, simulation):
        count = super().__new__(cls, number)
        count._simulation = simulation
        return count

    def __call__(self, steps=1):
        """Takes steps, and records what is due."""
        self._simulation.run(steps=steps)

    def __reduce__(self):
        return int, (int(self),)
