"""Results of a run: a folder that the program or a `Simulation` has written, or is writing."""

from __future__ import annotations

import csv
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ._errors import Error
from ._extras import needed
from .answers import Answers, is_table, read
from .contacts import ContactSteps
from .fields import Fields
from .scene import Scene
from .trajectory import Trajectory

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas


def open(folder: str | PathLike) -> Run:
    """The results of the run in a folder, as far as they are written. Files are read on first access."""
    folder = Path(folder)
    if not (folder / "scene.toml").is_file():
        raise Error(f"{folder} holds no run: it has no scene.toml")
    return Run(folder)


class Run:
    """The results of a run. Each file is read on first access; to see later results, open the run again."""

    def __init__(self, folder):
        self.folder = Path(folder)

    @cached_property
    def scene(self) -> Scene:
        """The `Scene`."""
        return Scene.load(self.folder / "scene.toml")

    @cached_property
    def observables(self) -> Observables:
        """The time series."""
        return Observables(self._existing("observables.csv", "output.observables_every"))

    @cached_property
    def answers(self) -> Answers:
        """The answers: means in the steady state, with errors and verdicts."""
        path = self.folder / "summary.csv"
        if not path.is_file() or not is_table(path):
            raise Error(f"{self.folder} has no answers yet; a run writes them at its end, before that `fcm-solve stats` has them")
        return read(path)

    @cached_property
    def trajectory(self) -> Trajectory:
        """The particles, frame by frame."""
        return Trajectory(self._existing("trajectory.h5", "output.trajectory_every"))

    @cached_property
    def fields(self) -> Fields:
        """Velocity of the fluid at grid points of the box, by step."""
        return Fields(self.folder / "fields")

    @cached_property
    def contacts(self) -> ContactSteps:
        """The forces of contacts and bonds, by step; empty without `output.contacts_every`."""
        return ContactSteps(self.folder / "contacts")

    @cached_property
    def statistics(self) -> dict[str, pandas.DataFrame]:
        """Tables of averages as DataFrames, by name: from `[statistics]` or `fcm-solve stats`, and from runs of grains."""
        pandas = needed("pandas", "statistics")
        folders = [self.folder / name for name in ("statistics", "stats") if (self.folder / name).is_dir()]
        paths = [path for folder in [self.folder, *folders[:1]] for path in sorted(folder.glob("*.csv"))]
        tables = [path for path in paths if path.name != "observables.csv" and not is_table(path)]
        return {path.stem: pandas.read_csv(path) for path in tables}

    def plot(
        self, path: str | PathLike | None = None, by: str = "excess", only: str | None = None
    ) -> matplotlib.figure.Figure:
        """Draws an overview figure of the run, as `python -m fcm_solve plot` does: spheres, the time series and statistics of
        interest for its kind of scene, and the answers.

        path  file to save the figure to, with the suffix of PNG, SVG or PDF; not saved if left out
        by    quantity shown by colours, or the gray of disks: "excess" velocity over the fluid's, "speed", or "species"
        only  a quantity of the answers, such as "relative_viscosity", whose panel alone is drawn
        """
        needed("matplotlib", "plot()")
        from . import plots

        try:
            figure = plots.draw(self.folder, by, only)
            if path is not None:
                plots.save(figure, path)
        except plots.PlotError as error:
            raise Error(str(error)) from error
        return figure

    def _existing(self, name, key):
        path = self.folder / name
        if not path.is_file():
            raise Error(f"{path} does not exist; a run writes it if {key} is set")
        return path

    def __repr__(self):
        return f"<fcm_solve.Run in {self.folder}>"


class Observables:
    """The time series of a run."""

    def __init__(self, path):
        self._path = path

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame with a row for each time, which is the index, and columns for `step` and each number."""
        pandas = needed("pandas", "observables.to_pandas()")
        names, *lines = self._path.read_text().splitlines(keepends=True)
        # The last row of a running simulation may be incomplete.
        whole = [line for line in lines if line.endswith("\n")]
        columns = next(csv.reader([names]))
        numbers = np.loadtxt(whole, delimiter=",", ndmin=2) if whole else np.empty((0, len(columns)))
        table = pandas.DataFrame(numbers, columns=columns).astype({"step": np.int64})
        return table.set_index("time")
