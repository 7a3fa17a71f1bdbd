"""Runs that start from files of this and other programs."""

import csv
import pathlib
import tempfile
import unittest

import h5py
import numpy as np
from program import run
from small_run import end_state

SHEARED = """[box]
edges = [8.0, 8.0, 8.0]
[fluid]
viscosity = 1.0
[[species]]
name = "a"
radius = 1.0
{count}
[particles]
{particles}
[flow]
kind = "shear"
rate = 1.0
[repulsion]
strength = 20.0
[hydrodynamics]
tolerance = 1e-2
[time]
step = 0.02
steps = {steps}
[output]
trajectory_every = {every}
checkpoint_every = 5
"""
RANDOM = {"count": "count = 12", "particles": "minimum_gap = 0.05", "steps": 10, "every": 5}


class Starts(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        self.out = self.folder / "out"

    def scene(self, name, **values):
        path = self.folder / f"{name}.toml"
        path.write_text(SHEARED.format(**(RANDOM | values)))
        return path

    def gaps(self, out):
        with open(out / "observables.csv") as file:
            return [float(row["smallest_gap"]) for row in csv.DictReader(file)]

    def test_a_start_from_a_sheared_run_is_the_same_structure(self):
        for every, said_frame in [(5, "frame 2 (of 3, from 0), step 10"), (0, "frame 0 (of 1, from 0), step 10")]:
            before, then, whole = (self.folder / f"{name}-{every}" for name in ("before", "then", "whole"))
            run(["run", self.scene("first", every=every), "--out", before])
            again = self.scene("again", count="", particles=f'initial = "file"\npath = "{before}"', every=5)
            said = run(["run", again, "--out", then])
            self.assertIn(f"start      12 particles of {before}, {said_frame}, time 0.2", said)
            self.assertEqual(self.gaps(then)[0], self.gaps(before)[-1])
            self.assertIn("strain = 0.2", (then / "scene.toml").read_text())
            run(["resume", then, "--steps", 20])
            run(["run", again, "--out", whole, "--set", "time.steps=20"])
            self.assertEqual(end_state(then, 20)[1:], end_state(whole, 20)[1:])

    def test_a_frame_that_is_asked_for_is_taken(self):
        run(["run", self.scene("first"), "--out", self.out])
        particles = f'initial = "file"\npath = "{self.out}"\nframe = 0'
        said = run(["run", self.scene("again", count="", particles=particles), "--out", self.folder / "again"])
        self.assertIn("frame 0 (of 3, from 0), step 0, time 0", said)
        self.assertEqual(self.gaps(self.folder / "again"), self.gaps(self.out))
        far = self.scene("far", count="", particles=particles.replace("frame = 0", "frame = 3"))
        said = run(["run", far, "--out", self.folder / "far"], expect=1)
        self.assertIn("particles.frame is 3, but it has 3 frames: 0 to 2, or from the end -1 to -3", said)

    def test_files_of_other_programs_are_read_as_they_mean_or_refused(self):
        path = self.folder / "start.h5"
        start = ["run", self.scene("again", count="", particles=f'initial = "file"\npath = "{path.name}"')]
        positions = np.array([[1.0, 1.0, 1.0], [5.0, 1.0, 1.0], [1.0, 5.0, 1.0], [5.0, 5.0, 5.0]])
        for data, words in [
            (positions.T, "has the shape (3, 4), but positions need (N, 3): it is likely (3, N)"),
            (positions.ravel(), "has the shape (12,)"),
            (positions.astype(complex), "complex numbers"),
            (positions.astype("S8"), "text"),
        ]:
            with h5py.File(path, "w") as file:
                file["positions"] = data
            self.assertIn(words, run([*start, "--out", self.out], expect=1))
        with h5py.File(path, "w") as file:
            group = file.create_group("particles/colloids")
            group["position/value"] = np.array([positions, positions + 0.5], dtype=np.float32)
            group["position/step"] = 100
            group["species"] = np.array([7] * 4, dtype=h5py.enum_dtype({"a": 7, "b": 8}, basetype="u1"))
            group["box/edges"] = [[8.0, 0.0, 0.0], [2.0, 8.0, 0.0], [0.0, 0.0, 8.0]]
            group["box"].attrs["boundary"] = ["periodic"] * 3
        self.assertIn("frame 1 (of 2, from 0), step 100", run([*start, "--out", self.out]))
        with h5py.File(self.out / "trajectory.h5") as file:
            np.testing.assert_array_equal(file["particles/all/position/value"][0], positions + 0.5)
            self.assertEqual(file["particles/all/box/strain/value"][0], 0.25)

    def test_bodies_of_a_run_are_where_it_left_them(self):
        rods = '[[bodies]]\nname = "rods"\nshape = "rod"\nspheres = 3\nradius = 0.4\ncount = 5'
        first = self.scene("first")
        first.write_text(first.read_text() + rods)
        run(["run", first, "--out", self.out], ranks=2)
        again = self.scene("again", particles=f'initial = "file"\npath = "{self.out}"')
        again.write_text(again.read_text() + rods)
        run(["run", again, "--out", self.folder / "again"], ranks=3)
        with h5py.File(self.out / "trajectory.h5") as before, h5py.File(self.folder / "again" / "trajectory.h5") as after:
            for name in ("position", "orientation"):
                last, start = (f[f"particles/all/{name}/value"][at] for f, at in ((before, -1), (after, 0)))
                np.testing.assert_allclose(start, last, atol=1e-13)
            np.testing.assert_array_equal(after["particles/all/body"][:], before["particles/all/body"][:])
        again.write_text(again.read_text().replace("spheres = 3", "spheres = 3\ngap = 0.01"))
        said = run(["run", again, "--out", self.folder / "others"], expect=1)
        self.assertIn('is 0.01 away from its place in body 0 of "rods"', said)


if __name__ == "__main__":
    unittest.main()
