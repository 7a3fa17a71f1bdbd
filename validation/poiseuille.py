"""Suspensions between walls: layers at the walls of a Couette flow (Yeo & Maxey, J. Fluid Mech. 649, 205, 2010) and its
viscosity, compared with fits to bulk suspensions (Eilers, Kolloid-Z. 97, 313, 1941; Morris & Boulay, J. Rheol. 43, 1213, 1999);
the blunted velocity profile of a Poiseuille flow, and the migration of spheres to its centre (Nott & Brady, J. Fluid Mech. 275,
157, 1994)."""

import sys
from concurrent.futures import ThreadPoolExecutor

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from support.page import save, table, write_section
from support.program import results, rows_of

FULL = "--full" in sys.argv[1:]
SIZE, HEIGHT = (16.0, 12.0) if FULL else (14.0, 10.0)
FRACTIONS = (0.2, 0.3, 0.4) if FULL else (0.2, 0.3)
# In strains of the mean flow; averages exclude the first part.
STRAIN, SETTLED = (80.0, 30.0) if FULL else (50.0, 20.0)
STEP = 0.05
# Strength of a repulsion that keeps gaps of about 0.01, as in these papers; without it gaps at 40% shrink without limit.
STRENGTH = 400.0
# Allowed relative difference of the viscosity from Eilers' fit at the volume fraction in the middle. The other fit is below the
# high-frequency viscosity of disordered spheres at 40%, which is 4.3 (docs/src/lubrication.md).
VISCOSITY = 0.15
# In the middle the velocity of a Poiseuille flow is HEIGHT / 2 without spheres, and the mean shear rate 1.
COUETTE, POISEUILLE = 'kind = "shear", rate = 1.0', f'kind = "poiseuille", pressure_gradient = {4 / HEIGHT}'
# Smallest ratio of the peak at the walls to the middle: layers are weak at 20% and grow with the volume fraction.
LAYER = 1.05
# Range of its height in radii.
PLACE = (0.7, 1.5)


def scene(flow, fraction):
    """Neutrally buoyant spheres of radius 1 between walls, in a flow whose mean shear rate is 1."""
    steps = round(STRAIN / STEP)
    return f"""seed = 2
box = {{ edges = [{SIZE}, {SIZE}, {HEIGHT}], boundaries = ["periodic", "periodic", "walls"] }}
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.01 }}
flow = {{ {flow} }}
repulsion = {{ strength = {STRENGTH}, range = 0.05 }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ integrator = "implicit", step = {STEP}, steps = {steps} }}
output = {{ trajectory_every = 0, observables_every = 1, checkpoint_every = 0 }}
statistics = {{ every = 2, from = {SETTLED}, bins = {round(5 * HEIGHT)} }}
[[species]]
name = "sphere"
radius = 1.0
volume_fraction = {fraction}
"""


def result(case):
    """Columns of the time series and of the profile."""
    flow, fraction = case
    with results(scene(flow, fraction)) as out:
        series, profile = rows_of(out / "observables.csv"), rows_of(out / "statistics" / "profile.csv")
    profile = [row for row in profile if row["species"] == "all"]
    return tuple({key: np.array([float(row[key]) for row in rows]) for key in rows[0] if key != "species"} for rows in (series, profile))


def bulk_viscosities(fraction):
    """The fits of Eilers, with close packing at 0.64, and of Morris and Boulay, with 0.68."""
    eilers = (1 + 1.25 * fraction / (1 - fraction / 0.64)) ** 2
    packed = fraction / 0.68
    return eilers, 1 + 2.5 * fraction / (1 - packed) + 0.1 * packed**2 / (1 - packed) ** 2


def symmetric(values):
    """The mean of both halves of a profile."""
    return 0.5 * (values + values[::-1])


def couette(fraction, found, axes):
    series, profile = found
    settled = series["time"] >= SETTLED
    viscosity = np.mean([series[f"wall_shear_stress_x[{wall}]"][settled] for wall in ("lower", "upper")])
    z, phi = profile["z"], symmetric(profile["volume_fraction"])
    near = z < 2.0
    peak, middle = phi[near].max(), phi[np.abs(z - HEIGHT / 2) < HEIGHT / 5].mean()
    where = z[near][phi[near].argmax()]
    axes.plot(phi, z, label=f"{fraction:.0%}")
    eilers, other = bulk_viscosities(middle)
    faults = []
    if abs(viscosity / eilers - 1) > VISCOSITY:
        faults.append(f"viscosity at {fraction:.0%}")
    if not (PLACE[0] < where < PLACE[1] and peak > LAYER * middle):
        faults.append(f"layer at the walls at {fraction:.0%}")
    numbers = [f"{viscosity:.2f}", f"{eilers:.2f}", f"{other:.2f}", f"{where:.1f}", f"{peak / fraction:.2f}", f"{middle / fraction:.2f}"]
    return [f"{fraction:.0%}", *numbers], faults


def poiseuille(fraction, found, axes):
    series, profile = found
    z, velocity, slip = profile["z"], profile["velocity_x"], profile["slip_x"]
    middle = np.abs(z - HEIGHT / 2) < HEIGHT / 8
    plain = np.nanmean((velocity - slip)[middle])
    faster = np.nanmean(velocity[middle]) / plain
    quarter = np.abs(np.abs(z - HEIGHT / 2) - HEIGHT / 4) < HEIGHT / 8
    blunted = faster * np.nanmean((velocity - slip)[quarter]) / np.nanmean(velocity[quarter])
    part = len(series["time"]) // 4
    migration = series["migration_z[sphere]"]
    first, last = migration[0], migration[-part:].mean()
    axes.plot(velocity / plain, z, "-", label=f"{fraction:.0%}")
    faults = [] if faster < 1 else [f"slower flow at {fraction:.0%}"]
    faults += [] if blunted < 1 else [f"blunted flow at {fraction:.0%}"]
    return [f"{fraction:.0%}", f"{faster:.3f}", f"{blunted:.3f}", f"{first:.3f}", f"{last:.3f}"], faults


def main():
    figure, (layers, speeds) = plt.subplots(1, 2, figsize=(8, 3.6), sharey=True)
    cases = [(flow, fraction) for flow in (COUETTE, POISEUILLE) for fraction in FRACTIONS]
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(cases, two.map(result, cases)))
    sheared = [couette(fraction, found[COUETTE, fraction], layers) for fraction in FRACTIONS]
    driven = [poiseuille(fraction, found[POISEUILLE, fraction], speeds) for fraction in FRACTIONS]
    layers.set(xlabel="volume fraction, Couette", ylabel="z / a")
    speeds.set(xlabel="velocity / centre velocity without spheres, Poiseuille")
    layers.legend()
    figure.tight_layout()
    save(figure, "channel.png")
    faults = [fault for _, found in sheared + driven for fault in found]
    layered = [float(row[5]) / float(row[6]) for row, _ in sheared]
    faults += [] if layered == sorted(layered) else ["growth of the layers with the volume fraction"]
    verdict = "Not found: " + ", ".join(faults) + "." if faults else "All are found."
    lines = [
        f"Couette flow of spheres of radius 1 between walls {HEIGHT:g} radii apart over a strain of {STRAIN:g}: the stress on the walls relative",
        "to that of the fluid alone, fits to bulk suspensions (Eilers 1941, Morris & Boulay 1999) at the volume fraction in the",
        "middle, and the peak of the profile near the walls.",
        "",
        *table(["volume fraction", "viscosity", "Eilers", "Morris & Boulay", "peak at z / a", "peak / mean", "middle / mean"],
               [row for row, _ in sheared]),
        "",
        "Poiseuille flow: the mean velocity of the spheres in the middle quarter relative to that of the flow without spheres,",
        "the ratio of this to the same half-way to the walls, and the second moment of the heights relative to that of a",
        "uniform distribution, initially and in the last quarter of the run.",
        "",
        *table(["volume fraction", "middle", "middle / half-way", "second moment, initial", "last"], [row for row, _ in driven]),
        "",
        "![Profiles between walls](figures/channel.png)",
        "",
        f"Expected are a viscosity within {VISCOSITY:.0%} of the fit of Eilers, peaks {PLACE[0]:g} to {PLACE[1]:g} radii from the walls that",
        f"exceed the middle by at least {LAYER - 1:.0%} and grow with the volume fraction, and a slower and blunted Poiseuille flow.",
        f"{verdict}",
    ]
    write_section("walls.md", "poiseuille", "Suspensions between walls", lines)
    print("\n".join(lines))
    if faults:
        raise SystemExit("failed: " + ", ".join(faults))


if __name__ == "__main__":
    main()
