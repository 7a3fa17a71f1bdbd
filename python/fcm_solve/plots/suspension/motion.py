"""Panels on the motion of the spheres: settling, fluctuations, gaps, segregation."""

import numpy as np

from ..bars import Bars
from ..panel import Panel
from ..style import colours
from ..text import shown

PARALLEL, PERPENDICULAR = "velocity_fluctuation_parallel", "velocity_fluctuation_perpendicular"
ROUND_OFF = 1e-6


def settling(run):
    """Mean velocity of each species along its Stokes velocity, in units of the Stokes velocity."""
    is_diffusing = run.scene.thermal_energy > 0 and run.scene.height_axis is not None
    if not has_series(run) or is_diffusing or set(run.scene.boundaries) == {"open"}:
        return None
    panel = Panel(run, run.progress[1:], ("settling velocity / Stokes velocity", ""), level=0)
    for number, mean, speed, _ in _along_stokes(run):
        options = {
            "quantities": ("settling_velocity", "hindered_settling_function"),
            "species": run.names[number],
            "factor": 1 / speed,
        }
        colour = colours(len(run.names))[number]
        panel.add(run.progress[0], mean / speed, label(run, number), colour=colour, **options)
    return panel


def fluctuations(run):
    """Standard deviations of the velocity: along and across the direction of settling, or in total without settling. They
    are left out for Brownian motion, where they depend on the time step."""
    if not has_series(run) or run.scene.thermal_energy > 0:
        return None
    found = list(_along_stokes(run))
    if not found:
        return _total_fluctuations(run)
    panel = Panel(run, run.progress[1:], ("velocity fluctuation / Stokes velocity", ""), level=0)
    for number, _, speed, variance in found:
        colour, direction = colours(len(run.names))[number], _direction(run, number)
        along = variance @ direction**2
        across = (variance.sum(axis=1) - along) / 2
        for values, name, line, quantity in ((along, "along", "-", PARALLEL), (across, "across", ":", PERPENDICULAR)):
            text = _label_of_part(run, number, name)
            spread = np.sqrt(np.maximum(values, 0)) / speed
            options = {"quantities": (quantity,), "species": run.names[number], "factor": 1 / speed}
            panel.add(run.progress[0], spread, text, colour=colour, line=line, **options)
    # A pair that settles side by side fluctuates by round-off alone.
    return panel if any(np.nanmax(curve.y) > ROUND_OFF for curve in panel.curves) else None


def _label_of_part(run, number, part):
    """The label of a component along or across: with the species if they are few, else the species or the line style."""
    if len(run.names) == 1:
        return part
    if len(run.names) == 2:
        return f"{label(run, number)}, {part}"
    is_last = number == run.stokes_velocities()[-1][0]
    return label(run, number) if part == "along" else "dotted: across" if is_last else ""


def _total_fluctuations(run):
    panel = Panel(run, run.progress[1:], ("velocity fluctuation", "length/time"), level=0)
    for number in range(len(run.names)):
        variance = run.vector("velocity_variance", number)
        if variance is not None:
            spread = np.sqrt(np.maximum(variance.sum(axis=1), 0))
            panel.add(run.progress[0], spread, label(run, number), colour=colours(len(run.names))[number])
    return panel if any(curve.y.any() for curve in panel.curves) else None


def _along_stokes(run):
    """For each settling species: its number, its mean velocity along its Stokes velocity, the magnitude of the Stokes
    velocity, and the variance."""
    for number, stokes in run.stokes_velocities():
        mean, variance = run.vector("mean_velocity", number), run.vector("velocity_variance", number)
        if mean is not None and variance is not None:
            speed = float(np.linalg.norm(stokes))
            yield number, mean @ (stokes / speed), speed, variance


def _direction(run, number):
    stokes = dict(run.stokes_velocities())[number]
    return stokes / np.linalg.norm(stokes)


def smallest_gap(run):
    """The smallest gap between surfaces."""
    if not has_series(run):
        return None
    panel = Panel(run, run.progress[1:], ("smallest gap", "length"), level=0)
    panel.add(run.progress[0], run.get("smallest_gap"))
    return panel


def segregation(run):
    """Segregation of the species: 0 if they are mixed."""
    if not has_series(run):
        return None
    panel = Panel(run, run.progress[1:], ("segregation of the species", ""), level=0)
    panel.add(run.progress[0], run.get("segregation"), colour=colours(1)[0], quantities=("segregation",))
    return panel if len({curve.y.std() for curve in panel.curves} - {0.0}) else None


def fluctuation_tensor(run):
    """Components of the fluctuation tensor of each species, from the statistics."""
    summary = run.statistics.get("summary")
    columns = ("quantity", "species", "value", "error")
    if run.scene.thermal_energy > 0 or summary is None or not summary.has(*columns):
        return None
    names = [f"T_{component}" for component in ("xx", "yy", "zz", "xy", "xz", "yz")]
    rows = {(q, s): i for i, (q, s) in enumerate(zip(summary["quantity"], summary["species"]))}
    species = [s for q, s in rows if q == names[0] and all((name, s) in rows for name in names)]
    bars = Bars(run, [name[2:] for name in names], ("fluctuation tensor", "length^2/time^2"))
    for name, colour in zip(species, colours(len(species))):
        chosen = [rows[component, name] for component in names]
        bars.add(summary["value"][chosen], summary["error"][chosen], shown(name), colour)
    return bars


def has_series(run):
    """Whether there is a time series."""
    return run.series is not None


def label(run, number):
    """The label of a species; None if there is only one."""
    return shown(run.names[number]) if len(run.names) > 1 else ""
