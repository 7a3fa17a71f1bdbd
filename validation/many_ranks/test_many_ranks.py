"""More processes than cores, particles, lines and planes agree with a single one."""

import csv
import pathlib
import re
import tempfile
import unittest

import h5py
import numpy as np

from program import ROOT, mobility, run
from test_ranks import DIFFERENCE, TIGHT, case, relative_difference

# Statistics subtract nearly equal numbers.
STATISTICS = 1e-9

NUMBER = re.compile(r"-?\d+(\.\d+)?(e-?\d+)?")

SETS = {
    "box.edges": "[12.0, 12.0, 12.0]",
    "species[0].count": 10,
    "hydrodynamics.tolerance": TIGHT,
    "output.trajectory_every": 2,
    "output.fields_every": 2,
    "output.checkpoint_every": 2,
    "statistics.every": 1,
}


def start(folder, steps, ranks=None):
    """Ten settling spheres with every kind of output."""
    words = [word for key, value in SETS.items() for word in ("--set", f"{key}={value}")]
    run(["run", ROOT / "scenes/settling.toml", "--out", folder, *words, "--set", f"time.steps={steps}"], ranks)


def last_frame(folder):
    """Particles and fluid at a run's end."""
    with h5py.File(folder / "trajectory.h5") as file:
        particles = file["particles/all"]
        frame = [particles[name]["value"][-1] for name in ("position", "velocity", "stresslet")]
    with h5py.File(max((folder / "fields").glob("velocity-*.h5"))) as file:
        return [*frame, file["velocity"][()]]


def statistics(folder, name):
    """All numbers of a table."""
    with open(folder / "statistics" / f"{name}.csv") as file:
        words = [word for row in csv.reader(file) for word in row]
    return np.array([float(word) for word in words if NUMBER.fullmatch(word)])


class ManyRanks(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)

    def test_two_spheres_on_64(self):
        two = case(7, multipoles="monopole", torques=[])
        two.update({name: two[name][:2] for name in ("positions", "radii", "forces")})
        alone, many = (mobility(two, self.folder, ranks, TIGHT)["velocities"] for ranks in (None, 64))
        self.assertLess(relative_difference(alone, many), DIFFERENCE["f64"])

    def test_a_run_that_goes_on_with_other_numbers_of_ranks(self):
        one, many = self.folder / "one", self.folder / "many"
        start(one, 4)
        start(many, 2, ranks=16)
        run(["resume", many, "--steps", 3], ranks=13)
        run(["resume", many, "--steps", 4], ranks=2)
        for alone, together in zip(last_frame(one), last_frame(many)):
            self.assertLess(relative_difference(alone, together), DIFFERENCE["f64"])
        for name in ("summary", "lags", "concentration"):
            alone, together = statistics(one, name), statistics(many, name)
            self.assertTrue(len(alone) > 20 and len(together) == len(alone), name)
            self.assertLess(np.abs(together - alone).max(), STATISTICS * np.abs(alone).max(), name)

    def test_a_cloud_whose_box_grows(self):
        """In unbounded fluid: the box and its grid follow the spheres, on any number of ranks and after resuming on another number."""
        sets = {"species[0].count": 12, "particles.radius": 6.0, "flow": '{kind="shear", rate=1.0}', "time.step": 0.1,
                "output.checkpoint_every": 3, "output.trajectory_every": 3, "hydrodynamics.tolerance": TIGHT}
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        frames = []
        for ranks in (None, 2, 3, 7):
            folder = self.folder / f"{ranks}"
            run(["run", ROOT / "scenes/cloud.toml", "--out", folder, *words, "--set", "time.duration=0.6"], ranks)
            run(["resume", folder, "--steps", 9], 3 if ranks == 7 else ranks)
            with h5py.File(folder / "trajectory.h5") as file:
                particles = file["particles/all"]
                frames.append([particles[name]["value"][-1] for name in ("position", "velocity", "box/edges")])
                edges = particles["box/edges/value"][:]
        self.assertFalse(np.array_equal(edges[0], edges[-1]))
        for frame in frames[1:]:
            np.testing.assert_array_equal(frame[2], frames[0][2])
            for alone, together in zip(frames[0][:2], frame):
                self.assertLess(relative_difference(alone, together), DIFFERENCE["f64"])
