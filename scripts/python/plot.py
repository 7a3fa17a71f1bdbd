"""Draws a run: its spheres at the end, coloured by velocity, and its time series."""

import argparse
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

import spheres
from results import Results


def draw_spheres(axes, run):
    time, positions, velocities = run.last_frame()
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
    image, extent = spheres.render(positions, run.radii, colours, run.edges, pixels=900)
    axes.add_collection(LineCollection(spheres.corners(run.edges), colors="0.6", linewidths=0.8, zorder=0))
    axes.imshow(image, origin="lower", extent=extent, interpolation="antialiased", zorder=1)
    axes.set_axis_off()
    axes.set_title(f"{run.title}: time {time:.3g}", fontsize=10)
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
    axes.legend(fontsize=8)


def draw(run, path):
    figure = plt.figure(figsize=(11, 5.6), layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=[5, 4])
    draw_spheres(left.subplots(), run)
    upper, lower = right.subplots(2, sharex=True)
    draw_velocities(upper, run)
    lower.plot(run.time, run.smallest_gap, color="0.3")
    lower.axhline(0, color="0.7", linewidth=0.8)
    lower.set_xlabel("time")
    lower.set_ylabel("smallest gap")
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(prog="scripts/plot", description=__doc__)
    parser.add_argument("folder", type=pathlib.Path, help="the results of a run")
    parser.add_argument("picture", type=pathlib.Path, nargs="?", help="where the picture goes [its picture.png]")
    arguments = parser.parse_args()
    picture = arguments.picture or arguments.folder / "picture.png"
    draw(Results(arguments.folder), picture)
    print(f"picture    {picture}")


if __name__ == "__main__":
    main()
