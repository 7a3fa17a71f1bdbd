"""Draws a page to judge a run by: its spheres at the end, coloured by velocity, its time series, and its statistics:
fluctuations and pair distributions, or profiles across a channel or a layer, or how a cloud unfolds. Of grains: the disks and how they segregate, or the averages of a shear cell."""

import argparse
import os
import pathlib
import subprocess

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

import grains
import spheres
import style
from results import Results

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = pathlib.Path(os.environ.get("FCM_SOLVE", TARGET / "release" / "fcm-solve"))


def draw_spheres(axes, run):
    time, positions, velocities = run.last_frame()
    positions = positions - run.origin(positions)
    speeds = run.stokes_velocities()
    mover = int(np.argmax(np.linalg.norm(speeds, axis=1)))
    unit = np.linalg.norm(speeds[mover])
    if unit > 0:
        value, label = velocities @ speeds[mover] / unit**2, "settling velocity / Stokes velocity"
    else:
        value, label = velocities[:, 0], "velocity along x"
    # The fastest and slowest hundredth would leave all others one colour.
    norm = plt.Normalize(*np.percentile(value, [1, 99]), clip=True)
    colours = plt.cm.viridis(norm(value))
    image, extent = spheres.render(positions, run.radii, colours, run.lattice, pixels=900)
    axes.add_collection(LineCollection(spheres.corners(run.lattice), colors="0.6", linewidths=0.8, zorder=0))
    axes.imshow(image, origin="lower", extent=extent, interpolation="antialiased", zorder=1)
    axes.set_axis_off()
    axes.set_title(f"{run.title}: time {time:.3g}")
    bar = plt.colorbar(plt.cm.ScalarMappable(norm, "viridis"), ax=axes, orientation="horizontal", shrink=0.6, pad=0.02)
    bar.set_label(label)


def draw_velocities(axes, run):
    settling = list(run.settling())
    for index, mean, along, across in settling:
        colour = f"C{index}"
        axes.plot(run.time, mean, color=colour, label=f"{run.names[index]}: mean")
        axes.plot(run.time, along, "--", color=colour, label="fluctuation along")
        axes.plot(run.time, across, ":", color=colour, label="fluctuation across")
    if not settling:
        for index, name in enumerate(run.names):
            fluctuation = np.sqrt(run.velocity_variance[:, index].sum(axis=1))
            axes.plot(run.time, fluctuation, color=f"C{index}", label=f"{name}: fluctuation")
    axes.set_ylabel("velocity / Stokes velocity" if settling else "velocity")
    axes.set_ylim(bottom=min(0, axes.get_ylim()[0]))
    axes.legend()


def draw_gap(axes, run):
    """The smallest gap, and in shear the viscosity."""
    axes.plot(run.time, run.smallest_gap, color="0.3")
    axes.axhline(0, color="0.7", linewidth=0.8)
    axes.set_ylabel("smallest gap")
    axes.set_xlabel("time")
    if run.viscosity is not None:
        other = axes.twinx()
        other.spines.right.set_visible(True)
        other.plot(run.time, run.viscosity, color="C1")
        other.set_ylabel("relative viscosity", color="C1")


def draw_fluctuations(axes, summary):
    """The fluctuation tensor of each species."""
    components = ["xx", "yy", "zz", "xy", "xz", "yz"]
    rows = {(q.decode(), s.decode()): i for i, (q, s) in enumerate(zip(summary["quantity"], summary["species"]))}
    species = [name for quantity, name in rows if quantity == "T_xx"]
    for index, name in enumerate(species):
        chosen = [rows[f"T_{component}", name] for component in components]
        places = np.arange(6) + 0.8 * (index + 0.5) / len(species) - 0.4
        errors = np.nan_to_num(summary["error"][chosen], posinf=0)
        axes.bar(places, summary["value"][chosen], 0.8 / len(species), yerr=errors, capsize=2, label=name)
    axes.axhline(0, color="0.7", linewidth=0.8)
    axes.set_xticks(range(6), components)
    axes.set_ylabel("fluctuation tensor of velocity")
    axes.legend()


def draw_pairs(axes, pairs):
    """The pair distribution of each pair of species."""
    names = list(zip(pairs["first"], pairs["second"]))
    for pair in dict.fromkeys(names):
        rows = [name == pair for name in names]
        label = " - ".join(name.decode() for name in dict.fromkeys(pair))
        axes.plot(pairs["distance"][rows], pairs["g"][rows], label=label)
    axes.axhline(1, color="0.7", linewidth=0.8)
    axes.set_xlabel("distance")
    axes.set_ylabel("g(r)")
    axes.legend()


def draw_profile(axes, profile):
    """Volume fraction and the velocity along the flow by height, of all spheres."""
    axis = next(name for name in ("x", "y", "z") if name in profile)
    rows = profile["species"] == profile["species"][-1]
    height, fraction = profile[axis][rows], profile["volume_fraction"][rows]
    error = np.nan_to_num(profile["volume_fraction_error"][rows], posinf=0)
    axes.fill_between(height, fraction - error, fraction + error, color="C0", alpha=0.3, linewidth=0)
    axes.plot(height, fraction, color="C0")
    axes.set_xlabel(f"height along {axis}")
    axes.set_ylabel("volume fraction", color="C0")
    velocities = {name: profile[f"velocity_{name}"][rows] for name in ("x", "y", "z")}
    along = max(velocities, key=lambda name: np.nanmean(np.abs(velocities[name])))
    other = axes.twinx()
    other.spines.right.set_visible(True)
    other.plot(height, velocities[along], color="C1")
    other.set_ylabel(f"velocity along {along}", color="C1")


def draw_cloud(axes, run):
    """The radius of gyration of each species and its parts along its principal axes."""
    for index, name in enumerate(run.names):
        for part, style_of_line, values in zip(("radius", "major", "middle", "minor"), ("-", "--", "-.", ":"), run.cloud[:, index].T):
            axes.plot(run.time, values, style_of_line, color=f"C{index}", label=f"{name}: {part}")
    axes.set_xlabel("time")
    axes.set_ylabel("extent of the cloud")
    axes.legend()


def make_statistics(run):
    """Statistics of the trajectory, if the run made none; nothing if the program isn't there."""
    tables = run.statistics()
    if not tables and PROGRAM.exists():
        subprocess.run([PROGRAM, "stats", run.folder], check=True, stdout=subprocess.DEVNULL)
        tables = run.statistics()
    return tables


def draw(run, path):
    tables = make_statistics(run)
    figure = plt.figure(figsize=(style.PAGE, 6.0 if tables else 3.8), layout="constrained")
    upper, *lower = figure.subfigures(2 if tables else 1, 1, height_ratios=[3.8, 2.2] if tables else [1], squeeze=False)[:, 0]
    left, right = upper.subfigures(1, 2, width_ratios=[4, 3])
    draw_spheres(left.subplots(), run)
    above, below = right.subplots(2, sharex=True)
    draw_velocities(above, run)
    draw_gap(below, run)
    for part in lower:
        left, right = part.subplots(1, 2)
        draw_fluctuations(left, tables["summary"])
        if "pairs" in tables:
            draw_pairs(right, tables["pairs"])
        elif "profile" in tables:
            draw_profile(right, tables["profile"])
        else:
            draw_cloud(right, run)
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(prog="scripts/plot", description=__doc__)
    parser.add_argument("folder", type=pathlib.Path, help="the results of a run")
    parser.add_argument("picture", type=pathlib.Path, nargs="?", help="where it goes: .png, .svg or .pdf [its picture.png]")
    parser.add_argument("--by", choices=("excess", "speed", "species"), default="excess", help="what the gray of disks says")
    parser.add_argument("--animate", action="store_true", help="all frames of disks, as a GIF")
    arguments = parser.parse_args()
    style.use()
    picture = arguments.picture or arguments.folder / ("picture.gif" if arguments.animate else "picture.png")
    if grains.scene_of(arguments.folder).get("kind") in grains.KINDS:
        grains.draw(arguments.folder, picture, arguments.by, arguments.animate)
    else:
        draw(Results(arguments.folder), picture)
    print(f"picture    {picture}")


if __name__ == "__main__":
    main()
