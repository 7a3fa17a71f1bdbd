"""Panels on stresses: viscosity, normal stress differences and particle pressure, rates under a given stress."""

import numpy as np

from ..panel import Panel
from ..style import colours
from .motion import has_series

NORMAL = (
    ("first_normal_stress_difference", "N\u2081"),
    ("second_normal_stress_difference", "N\u2082"),
    ("particle_pressure", "particle pressure"),
)


def viscosity(run):
    """Viscosity relative to that of the fluid, in shear or extension."""
    if not has_series(run) or run.scene.oscillates:
        return None
    name = "relative extensional viscosity" if "extension" in run.scene.flow else "relative viscosity"
    panel = Panel(run, run.progress[1:], (name, ""))
    options = {"quantities": ("relative_viscosity", "relative_extensional_viscosity"), "colour": colours(1)[0]}
    panel.add(run.progress[0], run.get("relative_viscosity"), **options)
    return panel


def normal_stresses(run):
    """Normal stress differences and particle pressure, divided by viscosity and rate if the rate is constant."""
    if not has_series(run):
        return None
    rate = run.scene.steady_rate or _constant(run.get("extension_rate")) or _constant(run.get("shear_rate"))
    label = ("stress / (viscosity \u00d7 rate)", "") if rate else ("stress", "force/length^2")
    unit = run.scene.viscosity * abs(rate) if rate else 1.0
    panel = Panel(run, run.progress[1:], label, level=0)
    for (name, text), colour in zip(NORMAL, colours(len(NORMAL))):
        values = run.get(name)
        if values is not None and values.any():
            panel.add(run.progress[0], values / unit, text, colour=colour, quantities=(name,), factor=1 / unit)
    return panel


def driven_rate(run):
    """Shear rate under a given stress, or from a table."""
    if not has_series(run) or run.scene.oscillates:
        return None
    panel = Panel(run, run.progress[1:], ("rate of shear", "1/time"), level=0)
    panel.add(run.progress[0], run.get("shear_rate"), colour=colours(2)[1], quantities=("shear_rate",))
    return panel


def _constant(values):
    """The common magnitude of all nonzero values; None if they differ."""
    if values is None:
        return None
    values = np.abs(values[np.isfinite(values) & (values != 0)])
    return float(values[-1]) if values.size and np.ptp(values) <= 1e-9 * values[-1] else None
