"""Panels of suspensions: each is about one quantity, and there is none where a run has nothing of it."""

from . import boundaries, brownian, clouds, contacts, motion, oscillation, pairs, stress

# In the order in which they are shown.
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
    brownian.displacements,
    brownian.osmotic_pressure,
    motion.fluctuations,
    motion.segregation,
    contacts.numbers,
    motion.smallest_gap,
    motion.fluctuation_tensor,
    pairs.distribution,
)
# Panels of a page.
MOST = 8


def panels(run):
    """The panels of a run, the most telling ones first."""
    found = (make(run) for make in PANELS)
    return [panel for panel in found if panel][:MOST]
