"""Disks: their positions, and their segregation over the strain."""

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure

from ..answers import band, find, read_answers, shade
from ..csv_table import read_table
from ..error import PlotError
from ..frames import Frames
from ..sheet import in_rows, sheet
from ..style import GRAY, PAGE, colours, legend_above
from ..units import Units

FRAMES_A_SECOND = 8


class Disks:
    """The frames of a run of disks."""

    def __init__(self, folder, scene, by):
        self.scene, self.by = scene, by
        self.frames = Frames(folder / "trajectory.h5")
        self.edges = [float(edge) for edge in scene.section("box")["edges"]]

    def draw(self, axes, frame):
        """Draws a frame. Disks that cross an edge along x are shown on both sides."""
        axes.clear()
        length, height = self.edges
        positions, velocities = self.frames.read(frame)
        x, y = positions[:, 0] % length, positions[:, 1]
        places = np.concatenate([np.stack([x + shift, y], axis=1) for shift in (-length, 0, length)])
        size, grays = np.tile(2 * self.frames.radii, 3), np.tile(self._shades(positions, velocities), 3)
        disks = EllipseCollection(size, size, 0 * size, units="xy", offsets=places, offset_transform=axes.transData)
        disks.set(facecolor=[(g, g, g) for g in grays], edgecolor="0.2", linewidth=0.2)
        axes.add_collection(disks)
        axes.set(xlim=(0, length), ylim=(0, height), aspect="equal", xticks=[], yticks=[])
        axes.spines[["top", "right"]].set_visible(True)
        axes.set_title(f"time {self.frames.times[frame]:.6g}")

    def _shades(self, positions, velocities):
        """A gray for each disk: dark for fast disks, or for large species."""
        if self.by == "species":
            return np.where(self.frames.species > 0, 0.25, 0.8)
        value = np.linalg.norm(velocities[:, :2], axis=1)
        if self.by == "excess":
            value = np.hypot(velocities[:, 0] - self._liquid(positions[:, 1]), velocities[:, 1])
        scale = np.percentile(value, 99)
        return 0.88 - 0.75 * np.clip(value / scale if scale > 0 else value, 0, 1)

    def _liquid(self, y):
        """The liquid's velocity along x."""
        height, flow = self.edges[1], self.scene.section("flow")
        if self.scene.flow == "shear":
            return flow["rate"] * (y - height / 2)
        return 4 * flow.get("peak", 0.0) * (y / height) * (1 - y / height)


def draw(folder, scene, by):
    """Draws the last frame, and the segregation over the strain; one of both if the other was not written."""
    series = read_table(folder / "observables.csv")
    has_series = series is not None and series.get("segregation") is not None and series.get("strain") is not None
    disks = Disks(folder, scene, by) if (folder / "trajectory.h5").is_file() else None
    if disks is None and not has_series:
        raise PlotError(
            f"{folder} has neither time series nor trajectory; set output.observables_every and run it again"
        )
    parts = [part for part in (disks, series if has_series else None) if part is not None]
    answers = read_answers(folder)
    figure, axes = sheet(in_rows(len(parts)), 3.3, answers, Units(scene.is_si), PAGE if len(parts) == 2 else PAGE / 2)
    if disks is not None:
        disks.draw(axes[0], disks.frames.last()[0])
    if has_series:
        _draw_segregation(axes[-1], series, find(answers, ("segregation",), None))
    figure.suptitle(scene.title)
    return figure


def _draw_segregation(axes, series, answer):
    marker = "o" if len(series) < 4 else ""
    for name, label, colour in (
        ("segregation", "segregation", GRAY),
        ("lane_peak", "peak of the lanes", colours(1)[0]),
    ):
        if series.get(name) is not None:
            axes.plot(series["strain"], series[name], color=colour, label=label, marker=marker, markersize=3)
    if answer is not None and series.get("time") is not None:
        start, end = np.interp(answer.transient, series["time"], series["strain"]), series["strain"].max()
        band(axes, (start, end), (answer.value, answer.error), GRAY)
        shade(axes, series["strain"].min(), start)
    axes.set(xlabel="strain", ylabel="order", ylim=(0, None))
    legend_above(axes)


def animation(folder, scene, by):
    """A function that writes all frames as a GIF to a path."""
    disks = Disks(folder, scene, by)

    def write(path):
        figure = Figure(figsize=(5, 5.2), layout="constrained")
        axes = figure.subplots()
        film = FuncAnimation(figure, lambda frame: disks.draw(axes, frame), frames=disks.frames.count)
        film.save(path, writer=PillowWriter(fps=FRAMES_A_SECOND), dpi=80)

    return write
