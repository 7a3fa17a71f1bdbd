"""A cloud of spheres that settles in unbounded fluid: its initial velocity against 6 N a / 5 R + 1 (Ekiel-Jezewska, Metzger &
Guazzelli, Phys. Fluids 18, 038104, 2006), and its evolution.

With --full also a larger cloud of monopoles, which becomes a torus and breaks up (Metzger, Nicolas & Guazzelli, J. Fluid
Mech. 580, 283, 2007); times are in units of the radius over the initial velocity."""

import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from support.page import save, table, write_section
from support.program import results, rows_of

FULL = "--full" in sys.argv[1:]
SEEDS = (1, 2, 3, 4)
# The scene that the program provides, until the cloud has fallen by many radii.
SMALL = {"count": 250, "radius": 20.0, "multipoles": "dipole", "tolerance": 1e-3, "step": 0.04, "steps": 1000}
# Nearly point forces: the radius of the cloud is 60 times that of a sphere.
LARGE = {"count": 1500, "radius": 60.0, "multipoles": "monopole", "tolerance": 1e-2, "step": 0.3, "steps": 3000}
SHOWN = 5
# Relative scatter of the velocity of one random cloud of 250 spheres, and the relative effect of the minimum gap.
SCATTER, DISTANCE = 0.02, 0.02


def velocity(cloud):
    """The formula, in units of the Stokes velocity."""
    return 6 * cloud["count"] / (5 * cloud["radius"]) + 1


def scene(cloud, seed):
    repulsion = "repulsion = { strength = 30.0, range = 0.25 }" if cloud["multipoles"] == "dipole" else ""
    return f"""seed = {seed}
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
particles = {{ initial = "cloud", radius = {cloud["radius"]}, minimum_gap = 0.1 }}
hydrodynamics = {{ multipoles = "{cloud["multipoles"]}", tolerance = {cloud["tolerance"]} }}
{repulsion}
time = {{ step = {cloud["step"]}, steps = {cloud["steps"]} }}
output = {{ trajectory_every = {cloud["steps"] // SHOWN}, observables_every = {cloud["steps"] // SHOWN}, checkpoint_every = 0 }}
[[species]]
name = "heavy"
radius = 1.0
count = {cloud["count"]}
force = [0.0, 0.0, {-6 * np.pi}]
"""


def result(cloud, seed, *overrides):
    """Rows of the time series, and the positions of each frame."""
    with results(scene(cloud, seed), overrides) as out:
        rows = [{key: float(value) for key, value in row.items()} for row in rows_of(out / "observables.csv")]
        with h5py.File(out / "trajectory.h5") as file:
            return rows, file["particles/all/position/value"][:]


def at_first():
    """The mean velocity of clouds at random, and its standard error."""
    still = ("time.steps=0", "output.trajectory_every=1", "output.observables_every=1")
    found = [-result(SMALL, seed, *still)[0][0]["mean_velocity_z[heavy]"] for seed in SEEDS]
    return np.mean(found), np.std(found, ddof=1) / np.sqrt(len(found))


def course(cloud, name, title):
    """A table of the evolution of a cloud, and pictures of it from the side and from below."""
    rows, frames = result(cloud, 1)
    unit, first = cloud["radius"] / velocity(cloud), -rows[0]["mean_velocity_z[heavy]"]
    figure, axes = plt.subplots(2, len(frames), figsize=(2.2 * len(frames), 4.6), sharex="row", sharey="row")
    for (side, below), frame, row in zip(axes.T, frames, rows):
        # Centred at the median, since the tail shifts the mean.
        x, y, z = ((frame - np.median(frame, axis=0)) / cloud["radius"]).T
        side.plot(x, z, ".", markersize=1.5, color="0.2")
        below.plot(x, y, ".", markersize=1.5, color="0.2")
        side.set(title=f"t V / R = {row['time'] / unit:.0f}", aspect="equal", xlim=(-3, 3), ylim=(-2, 4))
        below.set(aspect="equal", xlim=(-3, 3), ylim=(-3, 3))
    axes[0, 0].set_ylabel("z / R")
    axes[1, 0].set_ylabel("y / R")
    figure.tight_layout()
    save(figure, name)
    size = [[row[f"cloud_{axis}[heavy]"] / cloud["radius"] for axis in ("radius", "major", "minor")] for row in rows]
    lines = [
        [f"{row['time'] / unit:.0f}", f"{-row['cloud_z[heavy]'] / cloud['radius']:.1f}", f"{-row['mean_velocity_z[heavy]'] / first:.3f}"]
        + [f"{length:.2f}" for length in lengths]
        for row, lengths in zip(rows, size)
    ]
    header = ["t V / R", "distance / R", "velocity / initial", "radius / R", "longest semi-axis / R", "shortest / R"]
    return ["", title, "", *table(header, lines), "", f"![A settling cloud](figures/{name})"]


def main():
    found, error = at_first()
    formula = velocity(SMALL)
    off = abs(found / formula - 1)
    holds = off < 3 * SCATTER / np.sqrt(len(SEEDS)) + DISTANCE
    agreement = "agree" if holds else "do not agree"
    lines = [
        f"The initial velocity of clouds of {SMALL['count']} rigid spheres at random positions in a ball of {SMALL['radius']:g} radii, as in the",
        f"scene `cloud`, is {found:.2f} ± {error:.2f} Stokes velocities; the formula \\\\(6 N a / 5 R + 1\\\\) gives {formula:.2f}. They",
        f"{agreement} within the expected scatter.",
        *course(SMALL, "cloud.png", "Evolution of the first cloud; its radius and semi-axes are those of the ellipsoid "
                "with its gyration tensor:"),
    ]
    if FULL:
        title = (f"{LARGE['count']} point-like spheres in a ball of {LARGE['radius']:g} radii: the cloud becomes a torus and "
                 "breaks up; means include the spheres left behind:")
        lines += course(LARGE, "cloud-torus.png", title)
    write_section("walls.md", "cloud", "A cloud", lines)
    print("\n".join(lines))
    if not holds:
        raise SystemExit(f"failed: the velocity differs by {off:.1%}")


if __name__ == "__main__":
    main()
