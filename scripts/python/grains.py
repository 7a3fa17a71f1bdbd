"""Pictures of runs of grains: disks as the paper shows them, the shear cell's averages, the continuum's profiles."""

import csv
import tomllib

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.collections import EllipseCollection

import style

KINDS = ("granular-disks", "shear-cell", "shear-cell-continuum")


def scene_of(folder):
    """The scene of a run's folder."""
    return tomllib.loads((folder / "scene.toml").read_text())


def columns(path):
    """The columns of a CSV table, numbers as arrays."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([row[key] for row in rows]) if key == "wall" else np.array([float(row[key]) for row in rows]) for key in rows[0]}


def liquid(scene, y):
    """The liquid's velocity along x."""
    height = scene["box"]["edges"][1]
    flow = scene["flow"]
    if flow["kind"] == "shear":
        return flow["rate"] * (y - height / 2)
    return 4 * flow.get("peak", 0.0) * (y / height) * (1 - y / height)


class Disks:
    """The frames of a run of disks."""

    def __init__(self, folder, by):
        self.scene, self.by = scene_of(folder), by
        with h5py.File(folder / "trajectory.h5") as file:
            particles = file["particles/all"]
            self.time = particles["position/time"][:]
            self.positions, self.velocities = particles["position/value"][:], particles["velocity/value"][:]
            self.radii, self.species = particles["radius"][:], particles["species"][:]
        self.edges = self.scene["box"]["edges"]

    def shades(self, frame):
        """A gray for each disk: dark is fast, or of a large species."""
        if self.by == "species":
            return np.where(self.species > 0, 0.25, 0.8)
        position, velocity = self.positions[frame], self.velocities[frame]
        value = np.abs(velocity[:, 0])
        if self.by == "excess":
            value = np.hypot(velocity[:, 0] - liquid(self.scene, position[:, 1]), velocity[:, 1])
        scale = np.percentile(value, 99)
        return 0.88 - 0.75 * np.clip(value / scale if scale > 0 else value, 0, 1)

    def draw(self, axes, frame):
        """Disks that reach over an edge along x are shown on both sides."""
        axes.clear()
        length, height = self.edges
        x, y = self.positions[frame][:, 0] % length, self.positions[frame][:, 1]
        places = np.concatenate([np.stack([x + shift, y], axis=1) for shift in (-length, 0, length)])
        size = np.tile(2 * self.radii, 3)
        grays = np.tile(self.shades(frame), 3)
        disks = EllipseCollection(size, size, 0 * size, units="xy", offsets=places, transOffset=axes.transData)
        disks.set(facecolor=[(g, g, g) for g in grays], edgecolor="0.2", linewidth=0.2)
        axes.add_collection(disks)
        axes.set(xlim=(0, length), ylim=(0, height), aspect="equal", xticks=[], yticks=[])
        axes.set_title(f"{self.scene.get('title', '')}: time {self.time[frame]:.6g}")


def draw_disks(folder, picture, by):
    """The last frame, and the segregation in the course of time."""
    disks, series = Disks(folder, by), columns(folder / "observables.csv")
    figure, (left, right) = plt.subplots(1, 2, figsize=(style.PAGE, 3.4), layout="constrained")
    disks.draw(left, len(disks.time) - 1)
    right.plot(series["strain"], series["segregation"], color="0.2", label="segregation")
    right.plot(series["strain"], series["lane_peak"], color="C0", label="lanes' peak")
    right.set(xlabel="strain", ylim=(0, None))
    right.legend()
    figure.savefig(picture)


def animate_disks(folder, picture, by):
    """All frames as a GIF."""
    disks = Disks(folder, by)
    figure, axes = plt.subplots(figsize=(5, 5.2), layout="constrained")
    film = FuncAnimation(figure, lambda frame: disks.draw(axes, frame), frames=len(disks.time))
    film.save(picture, writer=PillowWriter(fps=8), dpi=80)


def draw_sweep(folder, picture):
    """Mean segregation over the seeds of each branch."""
    averages = columns(folder / "averages.csv")
    figure, axes = plt.subplots(figsize=(style.PAGE / 2, 2.8), layout="constrained")
    branches = np.stack([averages[key] for key in ("viscosity", "rate", "area_fraction")], axis=1)
    for branch in np.unique(branches, axis=0):
        rows = np.all(branches == branch, axis=1)
        mean, error = averages["segregation"][rows], np.nan_to_num(averages["segregation_error"][rows])
        label = "viscosity {:g}, rate {:g}, area fraction {:g}".format(*branch)
        axes.plot(averages["strain"][rows], mean, label=label)
        axes.fill_between(averages["strain"][rows], mean - error, mean + error, alpha=0.2)
    axes.set(xlabel="strain", ylabel="segregation", ylim=(0, None))
    axes.legend()
    figure.savefig(picture)


def draw_cell(folder, picture):
    """Wall stresses in the course of time, profiles across the gap, and the map of the solid fraction."""
    series = columns(folder / "observables.csv")
    figure, axes = plt.subplots(2, 2, figsize=(style.PAGE, 5), layout="constrained")
    for wall in ("bottom", "top"):
        axes[0, 0].plot(series["time"], series[f"wall_stress_normal[{wall}]"], label=f"normal, {wall}")
    axes[0, 0].plot(series["time"], series["wall_stress_along[top]"], label="shear, top")
    axes[0, 0].set(xlabel="time", ylabel="wall stress")
    axes[0, 0].legend()
    profile, cells = columns(folder / "profile.csv"), columns(folder / "map.csv")
    axes[0, 1].plot(profile["solid_fraction"], profile["y"])
    axes[0, 1].set(xlabel="solid fraction", ylabel="y")
    axes[1, 0].plot(profile["velocity_x"], profile["y"], label="velocity along x")
    axes[1, 0].plot(np.sqrt(np.maximum(profile["temperature"], 0)), profile["y"], label="root of temperature")
    axes[1, 0].set(ylabel="y")
    axes[1, 0].legend()
    z, y = np.unique(cells["z"]), np.unique(cells["y"])
    mesh = axes[1, 1].pcolormesh(z, y, cells["solid_fraction"].reshape(len(y), len(z)), cmap="gray_r")
    axes[1, 1].set(xlabel="z", ylabel="y", aspect="equal", title="solid fraction, averaged along the flow")
    figure.colorbar(mesh, ax=axes[1, 1], shrink=0.5)
    figure.suptitle(scene_of(folder).get("title", folder.name))
    figure.savefig(picture)


def draw_continuum(folder, picture):
    """Profiles of every case."""
    profile = columns(folder / "profile.csv")
    figure, axes = plt.subplots(1, 3, figsize=(style.PAGE, 2.6), layout="constrained")
    cases = np.stack([profile["speed"], profile["pressure"]], axis=1)
    for speed, pressure in np.unique(cases, axis=0):
        rows = np.all(cases == (speed, pressure), axis=1)
        label = f"U = {speed:g}, P = {pressure:g}"
        for panel, key, scale in zip(axes, ("solid_fraction", "velocity", "temperature"), (1, speed, speed**2)):
            panel.plot(profile[key][rows] / scale, profile["y"][rows], label=label)
    for panel, name in zip(axes, ("solid fraction", "velocity / U", "temperature / U²")):
        panel.set_xlabel(name)
    axes[0].set_ylabel("y")
    axes[0].legend()
    figure.savefig(picture)


def draw(folder, picture, by, animate):
    """Draws a run of grains as its kind has it."""
    scene = scene_of(folder)
    if scene["kind"] == "shear-cell":
        draw_cell(folder, picture)
    elif scene["kind"] == "shear-cell-continuum":
        draw_continuum(folder, picture)
    elif "sweep" in scene:
        draw_sweep(folder, picture)
    elif animate:
        animate_disks(folder, picture, by)
    else:
        draw_disks(folder, picture, by)
