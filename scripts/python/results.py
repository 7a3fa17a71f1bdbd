"""Reads the folder that a run leaves behind. What a file says is taken from inside it, never from its name."""

import pathlib
import tomllib

import h5py
import numpy as np


class Results:
    """The scene, the time series and the frames of a run."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        with h5py.File(self.folder / "observables.h5") as file:
            self.scene = tomllib.loads(file["parameters/scene"][()].decode())
            series = file["observables"]
            self.time = series["mean_velocity/time"][:]
            self.mean_velocity = series["mean_velocity/value"][:]
            self.velocity_variance = series["velocity_variance/value"][:]
            self.smallest_gap = series["smallest_gap/value"][:]
            self.viscosity = series["relative_viscosity/value"][:] if "relative_viscosity" in series else None
            # By species; a place, then the radius of gyration and its parts along the principal axes.
            self.cloud = series["cloud/value"][:, :, 3:] if "cloud" in series else None
        with h5py.File(self.folder / "trajectory.h5") as file:
            particles = file["particles/all"]
            self.species = particles["species"][:]
            self.radii = particles["radius"][:]
            self.lattice = particles["box/edges/value"][-1]
        self.title = self.scene.get("title", self.folder.name)
        self.names = [kind["name"] for kind in self.scene["species"]]

    def last_frame(self):
        """Time, positions (N, 3) and velocities (N, 3) of the last frame."""
        with h5py.File(self.folder / "trajectory.h5") as file:
            particles = file["particles/all"]
            last = len(particles["position/step"]) - 1
            return [particles[name][last] for name in ("position/time", "position/value", "velocity/value")]

    def origin(self, positions):
        """Where the box begins: at the origin, but where it is open on both sides, so that these positions are in its middle."""
        boundaries = self.scene["box"].get("boundaries", ["periodic"] * 3)
        middle = 0.5 * (positions.min(axis=0) + positions.max(axis=0) - np.diagonal(self.lattice))
        return np.where([boundary == "open" for boundary in boundaries], middle, 0.0)

    def statistics(self):
        """The tables of statistics, made during the run or afterwards: lists of columns by table and column. Empty if there
        are none."""
        for name in ("statistics", "stats"):
            path = self.folder / name / "statistics.h5"
            if path.exists():
                with h5py.File(path) as file:
                    tables = {key: group for key, group in file.items() if key not in ("h5md", "parameters")}
                    return {key: {name: data[()] for name, data in group.items()} for key, group in tables.items()}
        return {}

    def volume_fraction(self):
        """The share of the box that particles fill."""
        return float(np.sum(4 / 3 * np.pi * self.radii**3) / np.linalg.det(self.lattice))

    def stokes_velocities(self):
        """Velocity of each species' spheres, alone in unbounded fluid, under the force and weight of the scene."""
        gravity = np.array(self.scene.get("gravity", {}).get("acceleration", [0.0] * 3))
        viscosity = self.scene["fluid"]["viscosity"]
        velocities = []
        for kind in self.scene["species"]:
            radius = kind["radius"]
            weight = 4 / 3 * np.pi * radius**3 * kind.get("density_difference", 0.0) * gravity
            force = np.array(kind.get("force", [0.0] * 3)) + weight
            velocities.append(force / (6 * np.pi * viscosity * radius))
        return np.array(velocities)

    def settling(self):
        """Of each species that settles: its index, and in units of its Stokes velocity the mean velocity along it and the
        standard deviations along and across it, as functions of time."""
        for index, stokes in enumerate(self.stokes_velocities()):
            speed = np.linalg.norm(stokes)
            if speed > 0:
                direction = stokes / speed
                mean = self.mean_velocity[:, index] @ direction / speed
                variance = self.velocity_variance[:, index]
                along = variance @ direction**2
                across = (variance.sum(axis=1) - along) / 2
                yield index, mean, np.sqrt(along) / speed, np.sqrt(np.maximum(across, 0)) / speed
