"""Frames of a trajectory, which may be read while it still grows."""

import os
from contextlib import contextmanager

import numpy as np

from .error import PlotError, damage

os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")


class Frames:
    """The particles of a run, by frame."""

    def __init__(self, path):
        self.path = path
        with self._particles() as particles:
            columns = [particles[f"position/{name}"] for name in ("step", "time", "value")]
            self.count = min(len(column) for column in columns)
            self.times = columns[1][: self.count]
            self.radii, self.species = particles["radius"][:], particles["species"][:]
            if not len(self.radii) == len(self.species) == columns[2].shape[1] > 0:
                raise ValueError("its columns are of different lengths")
        if self.count == 0:
            raise PlotError(f"{path} has no frame yet; if the run is still in progress, try again later")

    def last(self):
        """The last frame whose numbers are all finite: its number, positions and velocities (N, 3)."""
        for frame in range(self.count - 1, max(-1, self.count - 6), -1):
            positions, velocities = self.read(frame)
            if np.isfinite(positions).all() and np.isfinite(velocities).all():
                return frame, positions, velocities
        raise PlotError(f"{self.path} is damaged: its last frames have positions that are not numbers")

    def read(self, frame):
        """Positions and velocities (N, 3) of a frame."""
        with self._particles() as particles:
            return tuple(particles[f"{name}/value"][frame].astype(float) for name in ("position", "velocity"))

    def lattice(self, frame):
        """The vectors of the box of a frame as rows, (3, 3)."""
        with self._particles() as particles:
            lattice = particles["box/edges/value"][frame]
            if lattice.shape != (3, 3) or not np.isfinite(lattice).all():
                raise ValueError("it has no lattice vectors")
            return lattice.astype(float)

    @contextmanager
    def _particles(self):
        """The group of all particles, while the file is open."""
        import h5py

        with damage(self.path), h5py.File(self.path, "r", locking=False) as file:
            yield file["particles/all"]
