"""Panels on contacts of rough spheres."""

from ..panel import Panel
from ..style import colours
from . import motion

SHARES = (
    ("contacts_per_particle", "contacts of a sphere"),
    ("frictional_contacts", "share with friction"),
    ("sliding_contacts", "share that slides"),
)


def numbers(run):
    """Number of contacts per sphere, and the fractions of frictional and of sliding contacts."""
    if not motion.has_series(run):
        return None
    panel = Panel(run, run.progress[1:], ("contacts", ""), level=0)
    for (name, label), colour in zip(SHARES, colours(3)):
        panel.add(run.progress[0], run.get(name), label, colour=colour, quantities=(name,))
    return panel
