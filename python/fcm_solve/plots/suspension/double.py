"""Profiles of two quantities over a common vertical axis of heights."""

import numpy as np

from ..style import colours
from ..units import labelled, upright


class DoubleProfile:
    """Profiles of the volume fraction, with its error, and of a streamwise velocity."""

    quantities = frozenset()

    def __init__(self, run, axis, heights, fraction):
        self.run, self.axis, self.heights, self.fraction = run, axis, heights, fraction
        self.error = self.velocity = self.along = None

    def draw(self, axes):
        """Draws the panel."""
        factor, unit = self.run.units.axis("length", self.heights)
        heights, (first, second) = self.heights * factor, colours(2)
        if self.error is not None:
            error = np.where(np.isfinite(self.error), self.error, 0)
            axes.fill_betweenx(
                heights, self.fraction - error, self.fraction + error, color=first, alpha=0.25, linewidth=0
            )
        axes.plot(self.fraction, heights, color=first)
        axes.set_ylabel(upright(labelled(self.axis, unit)))
        axes.set_xlabel("volume fraction", color=first)
        axes.set_xlim(left=0)
        if self.velocity is not None and np.isfinite(self.velocity).any():
            self._draw_velocity(axes.twiny(), heights, second)

    def _draw_velocity(self, axes, heights, colour):
        factor, unit = self.run.units.axis("length/time", self.velocity)
        axes.spines.top.set_visible(True)
        has_gaps = not np.isfinite(self.velocity).all()
        axes.plot(self.velocity * factor, heights, "--", color=colour, marker="o" if has_gaps else "", markersize=2)
        axes.set_xlabel(labelled(f"velocity along {self.along}", unit), color=colour)
