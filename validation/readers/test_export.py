"""Other programs read what `fcm-solve export` writes, of every kind of scene."""

import functools
import pathlib
import shutil
import tempfile
import unittest

import gsd.hoomd
import h5py
import numpy as np
import pyvista
from ovito.io import import_file

from program import run
from runs import SCENES, folder

PLACE = tempfile.TemporaryDirectory()
# Positions in GSD, and those shifted back from its origin here, are in single precision.
SINGLE = 4 * np.finfo(np.float32).eps
# OVITO reads decimal numbers to within the last bits.
DECIMAL = 4 * np.finfo(float).eps


@functools.cache
def exported(name, to):
    """The file that a run is exported to."""
    out = pathlib.Path(PLACE.name) / f"{name}.{'pvd' if to == 'vtp' else to}"
    run(["export", folder(name), "--to", to, "--out", out])
    return out


@functools.cache
def stored(name):
    """Arrays of all frames of the trajectory."""
    with h5py.File(folder(name) / "trajectory.h5") as file:
        particles = file["particles/all"]
        data = {key: particles[key][:] for key in ("id", "species", "radius", "position/step", "position/time")}
        values = [key for key in particles if key in ("position", "image", "velocity", "angular_velocity", "stresslet")]
        data |= {key: particles[f"{key}/value"][:] for key in values}
        data["periodic"] = particles["box"].attrs["boundary"] == b"periodic"
        return data | {"edges": particles["box/edges/value"][:], "strain": particles["box/strain/value"][:]}


class Exported(unittest.TestCase):
    def each(self, compare):
        """Compares the export of every kind of scene with its trajectory."""
        for name in SCENES:
            with self.subTest(name):
                self.assertGreater(len(stored(name)["position"]), 2)
                compare(name, stored(name))

    def compare_with_centred(self, positions, images, data, frame):
        """Positions in a box around the origin, single precision, unwrapped."""
        edges = data["edges"][frame]
        expected = data["position"][frame] + data["image"][frame] @ edges - edges.sum(axis=0) / 2
        size = SINGLE * (edges.max() + np.abs(data["image"][frame] @ edges).max())
        np.testing.assert_allclose(positions + images @ edges, expected, rtol=0, atol=size)

    def test_gsd(self):
        self.each(self.gsd)

    def gsd(self, name, data):
        with gsd.hoomd.open(exported(name, "gsd")) as frames:
            self.assertEqual(len(frames), len(data["position"]))
            for number, frame in enumerate(frames):
                frame.validate()
                particles, edges = frame.particles, data["edges"][number]
                self.assertEqual(frame.configuration.step, data["position/step"][number])
                self.assertEqual(frame.log["time"][0], data["position/time"][number])
                box = [*np.diag(edges), data["strain"][number], 0, 0]
                np.testing.assert_array_equal(frame.configuration.box, np.float32(box))
                self.compare_with_centred(particles.position, particles.image, data, number)
                inside = np.linalg.solve(edges.T, particles.position.T)
                self.assertLessEqual(np.abs(inside).max(), 0.5 + SINGLE)
                np.testing.assert_array_equal(particles.diameter, np.float32(2 * data["radius"]))
                np.testing.assert_array_equal(particles.typeid, data["species"])
                np.testing.assert_array_equal(particles.velocity, np.float32(data["velocity"][number]))
                for key in {"angular_velocity", "stresslet"} & data.keys():
                    np.testing.assert_array_equal(frame.log[f"particles/{key}"], np.float32(data[key][number]))

    def test_gsd_has_the_names_of_species(self):
        with gsd.hoomd.open(exported("straight", "gsd")) as frames:
            self.assertEqual(frames[-1].particles.types[0], "heavy")

    def test_ovito_reads_gsd(self):
        self.each(self.ovito_reads_gsd)

    def ovito_reads_gsd(self, name, data):
        pipeline = import_file(str(exported(name, "gsd")))
        self.assertEqual(pipeline.source.num_frames, len(data["position"]))
        for number in range(pipeline.source.num_frames):
            read = pipeline.compute(number)
            np.testing.assert_allclose(read.cell[:, :3], data["edges"][number].T, rtol=SINGLE, atol=SINGLE)
            images = data["image"][number]
            positions = np.asarray(read.particles.positions)
            off = positions - (data["position"][number] - data["edges"][number].sum(axis=0) / 2)
            # The same position, or that of an image.
            steps = off @ np.linalg.inv(data["edges"][number])
            np.testing.assert_allclose(steps, np.rint(steps), rtol=0, atol=2 * SINGLE)
            self.assertEqual(positions.shape, images.shape)
            np.testing.assert_array_equal(read.particles["Radius"], np.float32(data["radius"]))

    def test_ovito_reads_xyz(self):
        self.each(self.ovito_reads_xyz)

    def ovito_reads_xyz(self, name, data):
        pipeline = import_file(str(exported(name, "xyz")))
        self.assertEqual(pipeline.source.num_frames, len(data["position"]))
        for number in range(pipeline.source.num_frames):
            read = pipeline.compute(number)
            self.assertEqual(read.cell.pbc, tuple(data["periodic"]))
            self.assertEqual(read.attributes["Time"], data["position/time"][number])
            np.testing.assert_allclose(read.particles["Radius"], data["radius"], rtol=SINGLE)
            np.testing.assert_array_equal(read.particles["Particle Identifier"], data["id"])
            for found, expected in [
                (read.cell[:, :3], data["edges"][number].T),
                (read.particles.positions, data["position"][number]),
                (read.particles["Velocity"], data["velocity"][number]),
            ]:
                np.testing.assert_allclose(found, expected, rtol=DECIMAL, atol=0)

    def test_numbers_of_xyz_are_exact(self):
        self.each(self.exact_numbers_of_xyz)

    def exact_numbers_of_xyz(self, name, data):
        lines = exported(name, "xyz").read_text().splitlines()
        count = len(data["id"])
        for number, frame in enumerate(np.reshape(lines, (-1, count + 2))):
            rows = np.array([row.split() for row in frame[2:]], dtype=float)
            np.testing.assert_array_equal(rows[:, 1:4], data["position"][number])
            np.testing.assert_array_equal(rows[:, 4], data["radius"])

    def test_pyvista_reads_vtp(self):
        self.each(self.pyvista_reads_vtp)

    def pyvista_reads_vtp(self, name, data):
        reader = pyvista.get_reader(str(exported(name, "vtp")))
        self.assertEqual(reader.time_values, list(data["position/time"]))
        for number, time in enumerate(reader.time_values):
            reader.set_active_time_value(time)
            mesh = reader.read()[0]
            self.assertEqual(mesh.n_cells, len(data["id"]))
            np.testing.assert_array_equal(mesh.points, data["position"][number])
            np.testing.assert_array_equal(mesh.field_data["lattice"], data["edges"][number])
            for key in ("id", "species", "radius"):
                np.testing.assert_array_equal(mesh[key], data[key])
            for key in {"velocity", "angular_velocity", "stresslet"} & data.keys():
                np.testing.assert_array_equal(mesh[key], data[key][number])

    def test_frames_and_times_are_chosen(self):
        times = stored("straight")["position/time"]
        for words, expected in [
            (["--frames", "1::2"], times[1::2]),
            (["--frames", "-1"], times[-1:]),
            (["--from", times[2], "--until", times[4]], times[2:5]),
            (["--frames", "::2", "--from", times[3]], times[4::2]),
        ]:
            with self.subTest(words):
                out = pathlib.Path(PLACE.name) / "chosen.pvd"
                run(["export", folder("straight"), "--to", "vtp", "--out", out, *words])
                self.assertEqual(pyvista.get_reader(str(out)).time_values, list(expected))
        self.assertIn("no whole frame", run(["export", folder("straight"), "--to", "xyz", "--frames", "99"], expect=1))

    def test_damaged_frames_are_named_and_left_out(self):
        with tempfile.TemporaryDirectory() as place:
            moved = pathlib.Path(place) / "run"
            shutil.copytree(folder("straight"), moved)
            with h5py.File(moved / "trajectory.h5", "r+") as file:
                file["particles/all/position/value"][2, 0, 0] += 0.5
            said = run(["export", moved, "--to", "xyz"])
            self.assertRegex(said, "warning: .*trajectory.h5 is damaged: frame 2 .* particles/all/position")
            self.assertIn("6 frames in", said)
            self.assertEqual((moved / "trajectory.xyz").read_text().count("Step="), 6)
            alone = run(["export", moved, "--to", "gsd", "--frames", "2"], expect=1)
            self.assertIn("no whole frame", alone)
            self.assertFalse((moved / "trajectory.gsd").exists())
