"""Panels of oscillatory flow: stress against strain, and the moduli."""

import numpy as np

from ..bars import Bars
from ..style import colours
from ..units import labelled, upright


MODULI = ("storage_modulus", "loss_modulus")


class Loops:
    """Stress of the suspension against the strain; the last period is the darkest."""

    quantities = frozenset(MODULI)

    def __init__(self, run, strain, stress):
        self.run, self.strain, self.stress = run, strain, stress

    def draw(self, axes):
        """Draws the panel."""
        factor, unit = self.run.units.axis("force/length^2", self.stress)
        axes.plot(self.strain, self.stress * factor, color="0.8", linewidth=0.8)
        last = self.run.get("time") >= self._start_of_last_period()
        axes.plot(self.strain[last], self.stress[last] * factor, color=colours(1)[0], label="last period")
        axes.locator_params(axis="x", nbins=5)
        axes.set(xlabel="strain", ylabel=upright(labelled("shear stress", unit)))

    def _start_of_last_period(self):
        time = self.run.get("time")
        period = 2 * np.pi / float(self.run.scene.section("flow")["oscillation"]["frequency"])
        return time[-1] - period


def stress_against_strain(run):
    """The Lissajous curve of stress and strain."""
    strain, stress = run.get("strain"), run.get("shear_stress")
    return Loops(run, strain, stress) if run.scene.oscillates and strain is not None and stress is not None else None


def moduli(run):
    """Storage and loss moduli of the harmonics, from the statistics."""
    table = run.statistics.get("harmonics")
    columns = ("harmonic", *MODULI)
    if table is None or not table.has(*columns):
        return None
    bars = Bars(
        run, [f"{number:g}" for number in table["harmonic"].tolist()], ("modulus of the harmonic", "force/length^2")
    )
    bars.quantities = set(MODULI)
    for name, label, colour in zip(MODULI, ("storage modulus G\u2032", "loss modulus G\u2033"), colours(2)):
        errors = table.get(f"{name}_error")
        bars.add(table[name], errors if errors is not None else 0 * table[name], label, colour)
    return bars
