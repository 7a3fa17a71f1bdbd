"""The number of steps taken, which takes more when it is called."""


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
