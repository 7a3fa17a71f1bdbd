"""A run of a suspension: its scene, and the contents of its files. A file is identified by its contents, never by its
name."""

from functools import cached_property

import numpy as np

from .answers import read_answers
from .csv_table import read_table
from .error import PlotError
from .frames import Frames
from .units import Units


class Run:
    """The results in a folder. `notes` collects the parts left out of a figure, with reasons."""

    def __init__(self, folder, scene):
        self.folder, self.scene = folder, scene
        self.units = Units(scene.is_si)
        self.notes = []

    def _read(self, what, read):
        """The result of a function that reads a table or trajectory; None, with a note, if the file is damaged."""
        try:
            return read()
        except PlotError as error:
            self.notes.append(f"{what}: {error}")
        except ModuleNotFoundError as error:
            self.notes.append(f"{what}: needs {error.name}, which is not installed: pip install {error.name}")
        return None

    @cached_property
    def series(self):
        """The time series; None if it is absent."""
        path = self.folder / "observables.csv"
        table = self._read("time series", lambda: read_table(path))
        if table is not None and table.get("time") is not None:
            return table
        if not any(note.startswith("time series") for note in self.notes):
            lack = "no rows in" if path.is_file() else "no"
            self.notes.append(f"time series: {lack} {path}; a run writes it if output.observables_every is set")
        return None

    @cached_property
    def frames(self):
        """The trajectory; None if it is absent."""
        path = self.folder / "trajectory.h5"
        if not path.is_file():
            self.notes.append(f"spheres: no {path}; a run writes it if output.trajectory_every is set")
            return None
        return self._read("spheres", lambda: Frames(path))

    @cached_property
    def statistics(self):
        """The tables of statistics by name, written during the run or afterwards."""
        for name in ("statistics", "stats"):
            paths = sorted((self.folder / name).glob("*.csv"))
            tables = {path.stem: self._read("statistics", lambda path=path: read_table(path)) for path in paths}
            tables = {name: table for name, table in tables.items() if table is not None and len(table)}
            if tables:
                return tables
        return {}

    @cached_property
    def answers(self):
        """The answers, in the order of their file."""
        return self._read("answers", lambda: read_answers(self.folder)) or []

    def get(self, name):
        """A column of the time series; None if it is absent or has no numbers."""
        return self.series.get(name) if self.series is not None else None

    @cached_property
    def names(self):
        """The names of the species as in tables; a distribution of radii has a species for each class."""
        start, columns = "mean_velocity_x[", self.series.columns if self.series is not None else {}
        found = [name[len(start) : -1] for name in columns if name.startswith(start)]
        return found or [str(kind.get("name", number)) for number, kind in enumerate(self.scene.species, start=1)]

    @cached_property
    def kinds(self):
        """The index in the scene's list of each species."""
        places, names = [], self.names
        for place, kind in enumerate(self.scene.species):
            start = f"{kind.get('name', place + 1)} "
            count = 1
            if "distribution" in kind:
                same = [name.startswith(start) and name[len(start) :].isdigit() for name in names[len(places) :]]
                count = (same + [False]).index(False) or 1
            places += [place] * count
        return places[: len(names)]

    @cached_property
    def radii(self):
        """The radius of each species; NaN if it is unknown without a trajectory."""
        radii = []
        for number, place in enumerate(self.kinds):
            own = self.frames.radii[self.frames.species == number] if self.frames is not None else []
            radii.append(float(own[0] if len(own) else self.scene.species[place].get("radius", np.nan)))
        return radii

    def stokes_velocities(self):
        """Number and Stokes velocity (3,) of each species that is moved by forces and whose radius is known."""
        found = []
        for number, (place, radius) in enumerate(zip(self.kinds, self.radii)):
            velocity = self.scene.stokes_velocity(place, radius)
            if np.isfinite(velocity).all() and np.linalg.norm(velocity) > 0:
                found.append((number, velocity))
        return found

    def vector(self, quantity, number):
        """Time series of the three components of a species' quantity, (rows, 3); None if they are absent."""
        columns = [self.get(f"{quantity}_{axis}[{self.names[number]}]") for axis in "xyz"]
        return np.stack(columns, axis=1) if all(column is not None for column in columns) else None

    @cached_property
    def progress(self):
        """The values on the horizontal axis of time series, their label and their dimension: the strain of a flow that does
        not oscillate, accumulated over reversals; else the time."""
        strain, rate, time = self.get("strain"), self.scene.steady_rate, self.get("time")
        if strain is not None and not self.scene.oscillates:
            added = np.cumsum(np.abs(np.diff(strain, prepend=strain[0])))
            is_reversed = not np.allclose(added, np.abs(strain - strain[0]), atol=1e-12)
            return (added, "accumulated strain", "") if is_reversed else (np.abs(strain), "strain", "")
        if rate is not None:
            return np.abs(rate) * time, "strain", ""
        return time, "time", "time"

    def progress_at(self, time):
        """The value of `progress` at a time, by interpolation."""
        return float(np.interp(time, self.get("time"), self.progress[0]))
