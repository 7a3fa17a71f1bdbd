"""A panel of bars with errors, side by side in groups."""

import numpy as np

from .style import LIGHT, legend_above
from .units import labelled, upright


class Bars:
    """Bars with errors, grouped by category."""

    def __init__(self, run, categories, y):
        self.run, self.categories, self.y = run, categories, y
        self.groups = []
        self.quantities = set()

    def add(self, values, errors, label, colour):
        """Adds a bar for each category."""
        if np.isfinite(values).any():
            self.groups.append((values, errors, label, colour))

    def __bool__(self):
        return bool(self.groups)

    def draw(self, axes):
        """Draws the panel."""
        factor, unit = self.run.units.axis(self.y[1], *(values for values, *_ in self.groups))
        width = 0.8 / len(self.groups)
        for number, (values, errors, label, colour) in enumerate(self.groups):
            places = np.arange(len(values)) - 0.4 + width * (number + 0.5)
            errors = np.where(np.isfinite(errors), errors, 0) * factor
            style = {"capsize": 1.5, "error_kw": {"linewidth": 0.8}}
            axes.bar(places, values * factor, width, yerr=errors, color=colour, label=label, **style)
        axes.axhline(0, color=LIGHT, linewidth=0.7)
        axes.set_xticks(range(len(self.categories)), self.categories)
        axes.set_ylabel(upright(labelled(self.y[0], unit)))
        legend_above(axes)
