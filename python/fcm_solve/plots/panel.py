"""A panel of a figure: curves over a common axis, with their answers as bands."""

from dataclasses import dataclass, field

import numpy as np

from .answers import band, find, shade
from .style import GRAY, LIGHT, legend_above
from .units import labelled, upright


@dataclass
class Curve:
    """A curve, and its answer: a quantity of one of these names, of a species or of all."""

    x: np.ndarray
    y: np.ndarray
    label: str = ""
    colour: str = GRAY
    line: str = "-"
    error: np.ndarray | None = None
    quantities: tuple = ()
    species: str | None = None
    # Whether the answer is a value of this curve.
    answered: bool = True
    # Factor for the value of an answer with a unit.
    factor: float = 1.0


@dataclass
class Panel:
    """Curves of the same dimension over a common axis."""

    run: object
    x: tuple
    y: tuple
    curves: list = field(default_factory=list)
    log: tuple = (False, False)
    level: float | None = None

    def add(self, x, y, label="", **options):
        """Adds a curve, if it has a finite number."""
        if x is not None and y is not None and (np.isfinite(x) & np.isfinite(y)).any():
            self.curves.append(Curve(x, y, label, **options))

    @property
    def quantities(self):
        """The quantities of the answers of this panel."""
        return {name for curve in self.curves for name in curve.quantities}

    def __bool__(self):
        return bool(self.curves)

    def draw(self, axes):
        """Draws the panel."""
        x_factor, x_unit = self.run.units.axis(self.x[1], *(curve.x for curve in self.curves))
        y_factor, y_unit = self.run.units.axis(self.y[1], *(curve.y for curve in self.curves))
        for curve in self.curves:
            self._draw_curve(axes, curve, (x_factor, y_factor))
        axes.set_xlabel(labelled(self.x[0], x_unit))
        axes.set_ylabel(upright(labelled(self.y[0], y_unit)))
        self._scale(axes)
        if self.level is not None:
            axes.axhline(self.level, color=LIGHT, linewidth=0.7, zorder=0)
        self._draw_answers(axes, (x_factor, y_factor))
        legend_above(axes)

    def _draw_curve(self, axes, curve, factors):
        x, y = curve.x * factors[0], np.where(np.isfinite(curve.y), curve.y, np.nan) * factors[1]
        marker = "o" if np.count_nonzero(np.isfinite(y)) < 4 else ""
        axes.plot(x, y, curve.line, color=curve.colour, label=curve.label or None, marker=marker, markersize=3)
        if curve.error is not None:
            error = np.where(np.isfinite(curve.error), curve.error, 0) * factors[1]
            axes.fill_between(x, y - error, y + error, color=curve.colour, alpha=0.25, linewidth=0)

    def _scale(self, axes):
        for which, is_log in zip("xy", self.log):
            if is_log:
                axes.set(**{f"{which}scale": "log"})

    def _draw_answers(self, axes, factors):
        """Draws the value of each answer with its error as a band from the end of its transient on, and shades the transient
        that all of them leave out."""
        ends = []
        for curve in self.curves:
            answer = find(self.run.answers, curve.quantities, curve.species)
            if answer is None or not curve.answered or curve.x is not self.run.progress[0]:
                continue
            start, end = self.run.progress_at(answer.transient) * factors[0], np.nanmax(curve.x) * factors[0]
            factor = factors[1] * (curve.factor if answer.unit else 1.0)
            band(axes, (start, end), (answer.value * factor, answer.error * factor), curve.colour)
            ends.append(start)
        if ends:
            shade(axes, np.nanmin(self.curves[0].x) * factors[0], min(ends))
