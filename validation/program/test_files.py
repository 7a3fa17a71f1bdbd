"""The files of a run as other programs read them: every HDF5 file opens in h5py and has the documented content."""

import json
import pathlib
import re
import shutil
import tempfile
import tomllib
import unittest
import xml.etree.ElementTree

import h5py
import numpy as np

from program import ROOT, answered, mobility, run

STEP = 0.025
SETS = {
    "box.edges": "[16.0, 16.0, 16.0]",
    "species[0].count": 40,
    "time.step": STEP,
    "time.steps": 6,
    "output.trajectory_every": 2,
    "output.fields_every": 3,
    "output.checkpoint_every": 2,
}


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.place.name) / "out"
        sets = [word for key, value in SETS.items() for word in ("--set", f"{key}={value}")]
        run(["run", ROOT / "scenes" / "settling.toml", "--out", cls.out, *sets], ranks=2)

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def test_every_file_opens_and_says_where_it_comes_from(self):
        files = sorted(self.out.rglob("*.h5"))
        names = {str(path.relative_to(self.out)) for path in files}
        fields = {f"fields/velocity-{step:010}.h5" for step in (0, 3, 6)}
        self.assertEqual(names, {"trajectory.h5", "observables.h5"} | fields)
        for path in files:
            with h5py.File(path) as file:
                file.visititems(lambda _, item: item[()] if isinstance(item, h5py.Dataset) else None)
                parameters = file["parameters"]
                scene = tomllib.loads(parameters["scene"][()].decode())
                self.assertEqual(scene["species"][0]["count"], 40)
                self.assertEqual(parameters.attrs["ranks"], 2)
                self.assertEqual(parameters.attrs["seed"], 1)
                self.assertTrue(parameters.attrs["program"].startswith("fcm-solve "))

    def test_the_trajectory_is_h5md(self):
        with h5py.File(self.out / "trajectory.h5") as file:
            self.assertEqual(list(file["h5md"].attrs["version"]), [1, 1])
            particles = file["particles/all"]
            self.assertEqual(particles["box"].attrs["dimension"], 3)
            self.assertEqual(list(particles["box"].attrs["boundary"]), [b"periodic"] * 3)
            np.testing.assert_array_equal(particles["position/step"], [0, 2, 4, 6])
            np.testing.assert_allclose(particles["position/time"], STEP * np.arange(0, 7, 2), rtol=1e-15)
            shapes = {"position": 3, "image": 3, "velocity": 3, "angular_velocity": 3, "stresslet": 5}
            for name, width in shapes.items():
                self.assertEqual(particles[name]["value"].shape, (4, 40, width))
                np.testing.assert_array_equal(particles[name]["step"], particles["position/step"])
            np.testing.assert_array_equal(particles["id"], np.arange(40))
            positions = particles["position/value"][:]
            self.assertTrue(np.all((positions >= 0) & (positions < 16)))
            np.testing.assert_allclose(particles["box/edges/value"][-1], 16 * np.eye(3))

    def test_the_trajectory_keeps_the_rules_of_h5md(self):
        """Specification 1.1: texts of a fixed length, one clock for all elements of a group; and no `unit`, which would
        be the name of one, such as nm, by the module `units`."""
        with h5py.File(self.out / "trajectory.h5") as file:
            self.assertNotIn("modules", file["h5md"])
            texts = {"h5md/creator": "name", "h5md/author": "name", "particles/all/box": "boundary"}
            for group, name in texts.items():
                kind = h5py.check_string_dtype(file[group].attrs.get_id(name).dtype)
                self.assertIsNotNone(kind.length, f"{group}: {name}")
            self.assertEqual(file["h5md/creator"].attrs["name"], b"fcm-solve")
            clock = [file["particles/all/position"][name] for name in ("step", "time")]
            objects = []
            file["particles"].visititems(lambda path, item: objects.append(item))
            for item in objects:
                self.assertNotIn("unit", item.attrs, item.name)
                if isinstance(item, h5py.Group) and "value" in item:
                    self.assertEqual([item["step"], item["time"]], clock, item.name)
            self.assertEqual(file["particles/all/velocity/value"].attrs["dimensions"], "length/time")

    def test_velocities_are_the_rate_of_change_of_unwrapped_positions(self):
        with h5py.File(self.out / "trajectory.h5") as file:
            particles = file["particles/all"]
            places = particles["position/value"][:] + 16 * particles["image/value"][:]
            time, velocity = particles["position/time"][:], particles["velocity/value"][:]
        moved = (places[3] - places[1]) / (time[3] - time[1])
        # Central difference over 0.2 time units, in which velocities change by a few per cent.
        np.testing.assert_allclose(moved, velocity[2], atol=0.02 * np.abs(velocity[2]).max())

    def test_the_series_are_the_same_in_both_files(self):
        table = np.genfromtxt(self.out / "observables.csv", delimiter=",", names=True, deletechars="")
        self.assertEqual(table["step"].tolist(), list(range(7)))
        with h5py.File(self.out / "observables.h5") as file:
            observables = file["observables"]
            np.testing.assert_array_equal(observables["mean_velocity/value"][:, 0, 2], table["mean_velocity_z[heavy]"])
            for name in ("smallest_gap", "iterations", "residual", "evaluations", "divergence", "seconds_per_step"):
                np.testing.assert_array_equal(observables[name]["value"], table[name])
        with h5py.File(self.out / "trajectory.h5") as file:
            mean = file["particles/all/velocity/value"][-1].mean(axis=0)
        # A sum of forty numbers in another order.
        self.assertAlmostEqual(mean[2] / table["mean_velocity_z[heavy]"][-1], 1, delta=1e-13)

    def test_the_field_is_named_by_its_xdmf_file_and_has_no_mean(self):
        frames = list(self.named_by_xdmf(self.out))
        self.assertEqual([time for time, *_ in frames], [STEP * step for step in (0, 3, 6)])
        self.assertEqual([kind for _, kind, _ in frames], ["3DCoRectMesh"] * 3)
        for _, _, places in frames:
            (velocity,) = places
            with h5py.File(self.out / velocity) as file:
                velocity, repeated = file["velocity"][:], file["repeated/velocity"][:]
            np.testing.assert_array_equal(repeated, np.pad(velocity, [(0, 1)] * 3 + [(0, 0)], mode="wrap"))
            # The wavevector 0 is absent; f32 rounds the rest.
            self.assertLess(np.abs(velocity.mean(axis=(0, 1, 2))).max(), 1e-6 * np.abs(velocity).max())

    def test_fields_of_a_sheared_run_are_curved_meshes_of_the_same_size(self):
        """Readers assume that all frames are like the first. The lattice is remapped at a strain of 1/2."""
        out = self.out.with_name("sheared")
        sets = SETS | {"species[0].count": 20, "flow": '{ kind = "shear", rate = 8.0, lees_edwards = true }'}
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        run(["run", ROOT / "scenes" / "settling.toml", "--out", out, *words])
        frames = list(self.named_by_xdmf(out))
        self.assertEqual([kind for _, kind, _ in frames], ["3DSMesh"] * 3)
        shapes = set()
        for (time, _, places), strain in zip(frames, [0, -0.4, 0.2]):
            with h5py.File(out / places[0]) as file:
                self.assertAlmostEqual(file.attrs["strain"], strain, delta=1e-12)
                place = file["repeated/position"][-1, -1, -1]
                shapes |= {file["repeated/position"].shape, file["repeated/velocity"].shape}
            np.testing.assert_allclose(place, [16 + 16 * strain, 16, 16], rtol=1e-14)
        self.assertEqual(len(shapes), 1)

    def named_by_xdmf(self, folder):
        """Time, kind of mesh and files of each frame."""
        for grid in xml.etree.ElementTree.parse(folder / "fields.xdmf").iterfind(".//Grid/Grid"):
            files = [item.text.split(":")[0] for item in grid.iter("DataItem") if ".h5" in item.text]
            yield float(grid.find("Time").get("Value")), grid.find("Topology").get("TopologyType"), files

    def test_a_case_in_hdf5_is_one_in_json(self):
        case = {
            "box": [16.0, 12.0, 12.0],
            "viscosity": 2.0,
            "positions": [[2.0, 3.0, 4.0], [5.0, 3.5, 4.0]],
            "radii": [1.0, 1.3],
            "forces": [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]],
            "multipoles": "dipole",
        }
        answer = mobility(case, self.place.name)
        path, out = pathlib.Path(self.place.name) / "case.h5", pathlib.Path(self.place.name) / "answer.h5"
        with h5py.File(path, "w") as file:
            for name, value in case.items():
                file[name] = value
        run(["mobility", path, "--out", out])
        with h5py.File(out) as file:
            for name in ("velocities", "angular_velocities", "strain_rates", "stresslets"):
                np.testing.assert_array_equal(file[name], answer[name])

    def test_the_documented_case_is_one(self):
        page = (ROOT / "docs" / "src" / "file-formats.md").read_text()
        case = json.loads(re.search(r"```json\n(.*?)```", page, re.DOTALL)[1])
        velocities = np.array(mobility(case, self.place.name, tolerance=1e-4)["velocities"]) * 6 * np.pi
        # Four radii apart on the line of centres: 1 + 3/2 / r - 1 / r^3 - 15/4 / r^4 in free space; images of the box
        # subtract 2.8373 / L for each of the two. The neglected terms are below a hundredth.
        expected = 1 + 3 / 8 - 1 / 64 - 15 / 1024 - 2 * 2.8373 / 40
        np.testing.assert_allclose(velocities, [[0, 0, -expected]] * 2, atol=0.01)

    def test_info_describes_the_folder(self):
        """Progress of the run, and the frames of its files; damage to any of them is an error."""
        said = run(["info", self.out])
        with h5py.File(self.out / "trajectory.h5") as file:
            frames = len(file["particles/all/position/step"])
        self.assertRegex(said, rf"steps +\d+, all of them taken\ntrajectory.h5 +frames {frames}, steps 0 to")
        told = answered(["info", "--json", self.out])
        self.assertEqual([file["name"] for file in told["files"]][:2], ["trajectory.h5", "observables.h5"])
        self.assertEqual(told["files"][0]["frames"]["count"], frames)
        self.assertEqual(run(["info", "--scene", self.out]), (self.out / "scene.toml").read_text())
        with tempfile.TemporaryDirectory() as place:
            copy = shutil.copytree(self.out, pathlib.Path(place) / "copy")
            content = bytearray((copy / "trajectory.h5").read_bytes())
            (copy / "trajectory.h5").write_bytes(content[: len(content) // 2])
            self.assertIn("trajectory.h5", run(["info", copy], expect=1))

    def test_info_describes_every_file(self):
        for path in self.out.rglob("*.h5"):
            self.assertIn("fcm-solve", run(["info", path]))
