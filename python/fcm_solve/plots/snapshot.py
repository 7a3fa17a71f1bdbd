"""Image of the spheres at the end of a run, coloured by velocity or species."""

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from . import spheres
from .style import colours
from .text import shown
from .units import labelled

PIXELS = 900


class Snapshot:
    """Image of the particles of a frame, with colours by velocity or species."""

    def __init__(self, run, by, pixels=PIXELS):
        # Velocities of Brownian motion depend on the time step and are not meaningful.
        self.run, self.by, self.pixels = run, "species" if run.scene.thermal_energy > 0 else by, pixels
        self.frames = run.frames

    def draw(self, axes, bar=True):
        """Draws the last frame."""
        frame, positions, velocities = self.frames.last()
        self.draw_frame(axes, frame, positions, velocities)
        if bar:
            self._draw_bar(axes)

    def draw_frame(self, axes, frame, positions, velocities):
        """Draws a frame."""
        lattice = self.frames.lattice(frame)
        positions = positions - self._origin(positions, lattice)
        image, extent = spheres.render(positions, self.frames.radii, self._colours(velocities), lattice, self.pixels)
        axes.add_collection(LineCollection(spheres.corners(lattice), colors="0.6", linewidths=0.8, zorder=0))
        axes.imshow(image, origin="lower", extent=extent, interpolation="antialiased", zorder=1)
        axes.set_axis_off()
        factor, unit = self.run.units.scale("time", [self.frames.times[-1]])
        axes.set_title(f"time {self.frames.times[frame] * factor:.4g} {unit}".rstrip())

    def _origin(self, positions, lattice):
        """The corner of the box: the origin, except along open axes, where the positions are centred in the box."""
        middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0) - np.diagonal(lattice))
        return np.where([boundary == "open" for boundary in self.run.scene.boundaries], middle, 0.0)

    def _colours(self, velocities):
        self.norm, self.label = None, None
        if self.by == "species":
            self.palette = colours(max(len(self.run.names), int(self.frames.species.max()) + 1))
            return np.array([matplotlib.colors.to_rgba(self.palette[number]) for number in self.frames.species])
        values, self.label, dimension = self._values(velocities)
        factor, unit = self.run.units.scale(dimension, values)
        values, self.label = values * factor, labelled(self.label, unit)
        # The colour scale leaves out the slowest and fastest 1 %, since outliers would give all others one colour.
        low, high = np.percentile(values, [1, 99])
        margin = 0.0 if high - low > 1e-6 * max(abs(low), abs(high)) else 0.5 * max(abs(high), 1e-300)
        self.norm = matplotlib.colors.Normalize(low - margin, high + margin, clip=True)
        return matplotlib.colormaps["viridis"](self.norm(values))

    def _values(self, velocities):
        """The values shown by colours, their label and their dimension."""
        moving = self.run.stokes_velocities()
        if self.by == "speed":
            return np.linalg.norm(velocities, axis=1), "speed", "length/time"
        if moving:
            _, stokes = max(moving, key=lambda item: np.linalg.norm(item[1]))
            return velocities @ stokes / (stokes @ stokes), "settling velocity / Stokes velocity", ""
        axis = int(np.argmax(np.abs(velocities).mean(axis=0)))
        return velocities[:, axis], f"velocity along {'xyz'[axis]}", "length/time"

    def _draw_bar(self, axes):
        if self.norm is not None:
            mappable = matplotlib.cm.ScalarMappable(self.norm, "viridis")
            bar = axes.figure.colorbar(
                mappable, cax=axes.inset_axes([0.2, -0.04, 0.6, 0.025]), orientation="horizontal"
            )
            bar.set_label(self.label)
            return
        if len(self.run.names) < 2:
            return
        handles = [Line2D([], [], marker="o", linestyle="", color=colour, markersize=5) for colour in self.palette]
        names = [shown(name) for name in self.run.names]
        axes.legend(handles, names, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=min(4, len(names)))
