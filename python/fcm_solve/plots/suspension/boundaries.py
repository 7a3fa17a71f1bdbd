"""Panels of channels and layers: profiles across, heights, flux and migration."""

import numpy as np

from ..panel import Panel
from ..slabs import slab_means, volume_fractions
from ..style import colours
from ..text import shown
from . import motion
from .double import DoubleProfile

AXES = "xyz"
# Number of slabs of a profile from frames.
SLABS = 24


def profile(run):
    """Profiles of volume fraction and streamwise velocity across the channel or layer, from the statistics or from the
    frames of the second half of the run."""
    axis = run.scene.height_axis
    if axis is None:
        return None
    table = run.statistics.get("profile")
    if table is not None and table.has("species", AXES[axis], "volume_fraction"):
        return _of_statistics(run, table, axis)
    return _of_frames(run, axis) if run.frames is not None else None


def _of_statistics(run, table, axis):
    rows = table.where(species=table["species"][-1])
    velocities = {name: rows.get(f"velocity_{AXES[name]}") for name in range(3) if name != axis}
    velocities = {name: values for name, values in velocities.items() if values is not None}
    along = max(velocities, key=lambda name: np.nanmean(np.abs(velocities[name])), default=None)
    along = along if run.scene.flow != "none" else None
    found = DoubleProfile(run, AXES[axis], rows[AXES[axis]], rows["volume_fraction"])
    found.error = rows.get("volume_fraction_error")
    if along is not None:
        found.velocity, found.along = velocities[along], AXES[along]
    return found


def _of_frames(run, axis):
    frames = run.frames
    last, positions, _ = frames.last()
    low, high = 0.0, frames.lattice(last)[axis, axis]
    if run.scene.boundaries[axis] != "walls":
        high = max(high, (positions[:, axis] + frames.radii).max())
    edges = np.linspace(low, high, SLABS + 1)
    chosen = range(last // 2, last + 1, max(1, (last - last // 2) // 20))
    area = abs(np.linalg.det(frames.lattice(last))) / frames.lattice(last)[axis, axis]
    read = [frames.read(frame) for frame in chosen]
    fractions = [volume_fractions(positions[:, axis], frames.radii, edges, area) for positions, _ in read]
    found = DoubleProfile(run, AXES[axis], 0.5 * (edges[1:] + edges[:-1]), np.mean(fractions, axis=0))
    if run.scene.flow != "none":
        along = 0 if axis != 0 else 1
        heights, speeds = (np.concatenate(columns) for columns in zip(*((p[:, axis], v[:, along]) for p, v in read)))
        found.velocity, found.along = slab_means(heights, speeds, edges), AXES[along]
    return found


def heights(run):
    """Mean and standard deviation of the heights of each species."""
    if not motion.has_series(run) or run.scene.height_axis is None:
        return None
    axis = AXES[run.scene.height_axis]
    panel = Panel(run, run.progress[1:], (f"height {axis}, mean \u00b1 deviation", "length"))
    for name, colour in zip(run.names, colours(len(run.names))):
        mean, deviation = run.get(f"height_mean[{name}]"), run.get(f"height_deviation[{name}]")
        label = shown(name) if len(run.names) > 1 else ""
        panel.add(run.progress[0], mean, label, colour=colour, quantities=("mean_height",), species=name)
        for sign in (-1, 1) if mean is not None and deviation is not None else ():
            values = mean + sign * deviation
            panel.add(
                run.progress[0], values, colour=colour, line=":", quantities=("height_deviation",), answered=False
            )
    return panel


def flux(run):
    """Volume of spheres through a cross-section, per area and time."""
    return _by_species(
        run, [f"particle_flux_{axis}" for axis in AXES], ("particle flux", "length/time"), "particle_flux"
    )


def slip(run):
    """Mean velocity of the spheres along walls, relative to the flow of the fluid without spheres."""
    if run.scene.flow == "none" or run.scene.boundaries.count("walls") != 1:
        return None
    axis = "x" if run.scene.boundaries[0] == "periodic" else "y"
    return _by_species(run, [f"mean_velocity_{axis}"], ("slip velocity", "length/time"), "slip_velocity")


def wall_stress(run):
    """Shear stress on each wall, in the direction of the flow."""
    if not motion.has_series(run) or run.scene.flow == "none":
        return None
    axis = "x" if run.scene.boundaries[0] == "periodic" else "y"
    panel = Panel(run, run.progress[1:], ("wall stress", "force/length^2"), level=0)
    for wall, colour in zip(("lower", "upper"), colours(2)):
        options = {"colour": colour, "quantities": (f"{wall}_wall_shear_stress",)}
        panel.add(run.progress[0], run.get(f"wall_shear_stress_{axis}[{wall}]"), f"{wall} wall", **options)
    return panel


def migration(run):
    """The migration of spheres to the middle: 1 for a uniform distribution."""
    return _by_species(run, [f"migration_{axis}" for axis in AXES], ("migration", ""), "migration")


def pressure_gradient(run):
    """Pressure gradient that maintains the constant flux."""
    if not motion.has_series(run):
        return None
    panel = Panel(run, run.progress[1:], ("pressure gradient", "force/length^3"))
    options = {"colour": colours(1)[0], "quantities": ("pressure_gradient",)}
    panel.add(run.progress[0], run.get("pressure_gradient"), **options)
    return panel


def _by_species(run, columns, y, answer):
    if not motion.has_series(run):
        return None
    panel = Panel(run, run.progress[1:], y, level=0)
    for name, colour in zip(run.names, colours(len(run.names))):
        for column in columns:
            label = shown(name) if len(run.names) > 1 else ""
            options = {"colour": colour, "quantities": (answer,), "species": name}
            panel.add(run.progress[0], run.get(f"{column}[{name}]"), label, **options)
    return panel
