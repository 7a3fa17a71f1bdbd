"""Panels of spheres in unbounded fluid: settling velocity and spreading of a cloud, and the energy of bonds."""

import numpy as np

from ..panel import Panel
from ..style import colours
from ..text import shown
from . import motion

EXTENTS = (
    ("cloud_radius", "radius", "-"),
    ("cloud_major", "major", "--"),
    ("cloud_middle", "middle", "-."),
    ("cloud_minor", "minor", ":"),
)
ENERGIES = (("bond_energy", "of bonds"), ("trap_energy", "of traps"))


def extent(run):
    """Radius of gyration of each species, and its components along the principal axes."""
    if not motion.has_series(run):
        return None
    panel = Panel(run, run.progress[1:], ("extent of the spheres", "length"))
    for name, colour in zip(run.names, colours(len(run.names))):
        for quantity, part, line in EXTENTS:
            label = f"{shown(name)}, {part}" if len(run.names) > 1 else part
            panel.add(run.progress[0], run.get(f"{quantity}[{name}]"), label, colour=colour, line=line)
    return panel


def settling(run):
    """Velocity of a cloud along its force, over the Stokes velocity of one of its spheres."""
    if not motion.has_series(run) or set(run.scene.boundaries) != {"open"}:
        return None
    panel = Panel(run, run.progress[1:], ("velocity of the cloud / Stokes velocity", ""), level=0)
    for number, stokes in run.stokes_velocities():
        mean, square = run.vector("mean_velocity", number), float(stokes @ stokes)
        if mean is not None:
            options = {
                "quantities": ("settling_velocity",),
                "species": run.names[number],
                "factor": 1 / np.sqrt(square),
            }
            colour = colours(len(run.names))[number]
            panel.add(run.progress[0], mean @ stokes / square, motion.label(run, number), colour=colour, **options)
    return panel


def bonds(run):
    """Elastic energy of bonds and traps."""
    if not motion.has_series(run):
        return None
    panel = Panel(run, run.progress[1:], ("elastic energy", "force*length"), level=0)
    for (name, label), colour in zip(ENERGIES, colours(2)):
        panel.add(run.progress[0], run.get(name), label, colour=colour, quantities=(name,))
    return panel
