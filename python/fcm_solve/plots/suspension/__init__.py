"""Panels of suspensions: each shows one quantity, and is left out if the run has no data for it."""

from ..error import PlotError
from . import boundaries, brownian, clouds, contacts, motion, oscillation, pairs, stress

# Functions that make panels, in the order in which they are shown.
PANELS = (
    stress.viscosity,
    oscillation.stress_against_strain,
    oscillation.moduli,
    stress.driven_rate,
    stress.normal_stresses,
    boundaries.profile,
    boundaries.pressure_gradient,
    clouds.settling,
    motion.settling,
    clouds.extent,
    clouds.bonds,
    boundaries.heights,
    boundaries.flux,
    boundaries.migration,
    boundaries.slip,
    brownian.displacements,
    brownian.osmotic_pressure,
    motion.fluctuations,
    boundaries.wall_stress,
    motion.segregation,
    contacts.numbers,
    motion.smallest_gap,
    motion.fluctuation_tensor,
    pairs.distribution,
)
# Largest number of panels of a page.
MOST = 8


def panels(run):
    """The panels of a run, the most informative first."""
    return _made(run)[:MOST]


def panels_of(run, quantity):
    """The panels on a quantity of the answers."""
    made = _made(run)
    bare = quantity.removeprefix("reduced_")
    found = [panel for panel in made if bare in panel.quantities]
    if not found:
        known = sorted({name for panel in made for name in panel.quantities})
        raise PlotError(f"{run.folder} has no series of {quantity}; it has {', '.join(known) or 'none'}")
    return found


def _made(run):
    return [panel for panel in (make(run) for make in PANELS) if panel]
