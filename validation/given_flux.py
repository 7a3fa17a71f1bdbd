"""A suspension between walls with a given flux, compared with the same suspension under a given pressure gradient: the ratio of the flux of
spheres to the pressure gradient, one of which is given while the other fluctuates."""

import sys

import numpy as np
from support.page import table, write_section
from support.program import series

FULL = "--full" in sys.argv[1:]
SIZE, HEIGHT = 14.0, 10.0
FRACTIONS = (0.2, 0.3) if FULL else (0.2,)
# In strains of the mean flow of the fluid alone under the pressure gradient; means exclude the first part.
STRAIN, SETTLED = (100.0, 20.0) if FULL else (24.0, 8.0)
STEP = 0.05
PRESSURE = 4 / HEIGHT
# About the mean velocity under the pressure gradient, so that the shear rates are similar.
MEAN_VELOCITY = {0.2: 1.7, 0.3: 1.1}
BLOCKS = 8
# Allowed difference of means: standard errors, and a relative part for the single migration across the channel in each run.
ERRORS, APART = 3.0, 0.02


def scene(flow, fraction):
    return f"""seed = 2
box = {{ edges = [{SIZE}, {SIZE}, {HEIGHT}], boundaries = ["periodic", "periodic", "walls"] }}
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.01 }}
flow = {{ kind = "poiseuille", {flow} }}
repulsion = {{ strength = 60.0, range = 0.05 }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ integrator = "implicit", step = {STEP}, steps = {round(STRAIN / STEP)} }}
output = {{ trajectory_every = 0, observables_every = 1, checkpoint_every = 0 }}
[[species]]
name = "sphere"
radius = 1.0
volume_fraction = {fraction}
"""


def series_of(flow, fraction):
    """The flux of spheres and, if there is one, the pressure gradient, in the settled part of a run."""
    rows = [row for row in series(scene(flow, fraction)) if row["time"] >= SETTLED]
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return columns["particle_flux_x[sphere]"], columns.get("pressure_gradient")


def mean(values):
    """The mean of a series, and its error by blocks."""
    blocks = [block.mean() for block in np.array_split(values, BLOCKS)]
    return np.mean(values), np.std(blocks, ddof=1) / BLOCKS**0.5


def compared(fraction):
    velocity = MEAN_VELOCITY[fraction]
    spheres, gradient = series_of(f"mean_velocity = {velocity}", fraction)
    driven, _ = series_of(f"pressure_gradient = {PRESSURE}", fraction)
    viscosity = mean(gradient / (12 * velocity / HEIGHT**2))
    kept, given = mean(spheres / gradient), mean(driven / PRESSURE)
    error = np.hypot(kept[1], given[1])
    faults = []
    if abs(kept[0] - given[0]) > ERRORS * error + APART * given[0]:
        faults.append(f"the flux of spheres at {fraction:.0%}")
    if not viscosity[0] > 1 + 2.5 * fraction:
        faults.append(f"the viscosity at {fraction:.0%}")
    numbers = [f"{value:.3f} ± {spread:.3f}" for value, spread in (viscosity, kept, given)]
    return [f"{fraction:.0%}", *numbers], faults


def main():
    rows = [compared(fraction) for fraction in FRACTIONS]
    faults = [fault for _, found in rows for fault in found]
    verdict = "Not found: " + ", ".join(faults) + "." if faults else "Both are found."
    lines = [
        f"Spheres of radius 1 between walls {HEIGHT:g} radii apart, over a strain of {STRAIN:g} of which the first {SETTLED:g} is excluded: the",
        "pressure gradient at a given mean velocity relative to that of the fluid alone, which is the apparent viscosity; and",
        "the flux of spheres over the pressure gradient, times the viscosity of the fluid, with either the flux or the pressure",
        "gradient given.",
        "",
        *table(["volume fraction", "apparent viscosity", "spheres, flux given", "spheres, pressure gradient given"], [row for row, _ in rows]),
        "",
        f"Expected are a viscosity above Einstein's and fluxes of spheres that agree within {ERRORS:g} errors and {APART:.0%}. {verdict}",
    ]
    write_section("walls.md", "given-flux", "A given flux", lines)
    print("\n".join(lines))
    if faults:
        raise SystemExit("failed: " + ", ".join(faults))


if __name__ == "__main__":
    main()
