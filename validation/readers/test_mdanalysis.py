"""MDAnalysis reads the trajectories of every kind of scene."""

import pathlib
import tempfile
import unittest

import h5py
import MDAnalysis
import numpy as np

from runs import SCENES, folder

# MDAnalysis computes in single precision; a tilted box goes through lengths and angles and back.
SINGLE = 4 * np.finfo(np.float32).eps


def opened(path, **how):
    with h5py.File(path) as file:
        count = len(file["particles/all/id"])
    universe = MDAnalysis.Universe.empty(count, trajectory=True)
    return universe.load_new(str(path), convert_units=False, **how)


class MDAnalysisReads(unittest.TestCase):
    def compare(self, path, universe):
        with h5py.File(path) as file:
            particles = file["particles/all"]
            stored = {name: particles[f"{name}/value"][:] for name in ("position", "velocity", "box/edges")}
            steps, times = particles["position/step"][:], particles["position/time"][:]
        self.assertEqual(len(universe.trajectory), len(steps))
        self.assertGreater(len(steps), 2)
        for frame in universe.trajectory:
            number = frame.frame
            self.assertEqual((frame.time, frame.data["step"]), (times[number], steps[number]))
            np.testing.assert_array_equal(frame.positions, stored["position"][number].astype(np.float32))
            np.testing.assert_array_equal(frame.velocities, stored["velocity"][number].astype(np.float32))
            edges = stored["box/edges"][number]
            # Angles are in degrees, with similar precision near 90.
            np.testing.assert_allclose(frame.triclinic_dimensions, edges, rtol=0, atol=90 * SINGLE * edges.max())
        self.assertEqual(number, len(steps) - 1)

    def test_all_frames_of_every_kind_of_scene(self):
        for name in SCENES:
            with self.subTest(name):
                path = folder(name) / "trajectory.h5"
                self.compare(path, opened(path, format="H5MD"))

    def test_the_sheared_box_tilts_to_both_sides(self):
        universe = opened(folder("sheared") / "trajectory.h5", format="H5MD")
        angles = [frame.dimensions[5] for frame in universe.trajectory]
        self.assertLess(min(angles), 70)
        self.assertGreater(max(angles), 110)

    def test_a_name_that_ends_in_h5md_needs_no_format(self):
        with tempfile.TemporaryDirectory() as place:
            path = pathlib.Path(place) / "trajectory.h5md"
            path.symlink_to(folder("sheared") / "trajectory.h5")
            self.compare(path, opened(path))
