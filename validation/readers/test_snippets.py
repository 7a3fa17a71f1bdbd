"""The snippets of the documentation for other programs work as printed."""

import contextlib
import gc
import pathlib
import shutil
import tempfile
import unittest

import h5py
import matplotlib
import numpy as np
from matplotlib.image import imread

from program import ROOT, run
from runs import folder
from snippets import PAGE, STARTS, blocks, section, snippets
from test_fields import pvbatch

matplotlib.use("Agg")


class Snippets(unittest.TestCase):
    def setUp(self):
        self.snippets = snippets()
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name) / "straight"
        shutil.copytree(folder("straight"), self.folder)

    def stored(self, name):
        with h5py.File(self.folder / "trajectory.h5") as file:
            return file[f"particles/all/{name}"][:]

    def run_snippet(self, name, number=0):
        """Runs a snippet in the run's folder and returns its variables."""
        names = {}
        with contextlib.chdir(self.folder), contextlib.redirect_stdout(None):
            exec(compile(self.snippets[name][number], f"{PAGE.name}, {name}", "exec"), names)
        return names

    def assert_drawn(self, name):
        """Asserts that a picture has more than one colour."""
        self.assertGreater(np.ptp(imread(self.folder / name)), 0.1, name)

    def test_every_snippet_is_tested(self):
        counts = {name: len(found) for name, found in self.snippets.items()}
        tested = {"h5py": 1, "pandas": 1, "xarray": 1, "MDAnalysis": 2, "ParaView": 1, "pyvista": 1}
        tested[STARTS] = 1
        self.assertEqual(counts, tested)
        self.assertEqual(PAGE.read_text().count("```python"), sum(tested.values()))

    def test_h5py(self):
        names = self.run_snippet("h5py")
        self.assertEqual(names["positions"].shape, (7, 25, 3))
        time, path = names["time"], names["unwrapped"]
        # Displacements between frames are much smaller than the box: a jump would mean wrapped positions.
        speed = np.abs(self.stored("velocity/value")).max()
        self.assertLess(np.abs(np.diff(path, axis=0)).max(), 2 * speed * np.diff(time).max())

    def test_pandas(self):
        names = self.run_snippet("pandas")
        with h5py.File(self.folder / "observables.h5") as file:
            np.testing.assert_array_equal(names["series"].index, file["observables/smallest_gap/time"])
            np.testing.assert_array_equal(names["series"]["smallest_gap"], file["observables/smallest_gap/value"])
        self.assertIn("heavy", names["summary"].loc["mean_velocity_z"].index)
        self.assert_drawn("smallest_gap.png")

    def test_xarray(self):
        velocity = self.run_snippet("xarray")["velocity"]
        with h5py.File(self.folder / "observables.h5") as file:
            stored = file["observables/mean_velocity/value"][:]
            time = file["observables/mean_velocity/time"][:]
        np.testing.assert_array_equal(velocity["value"].sel(axis="y", species=0), stored[:, 0, 1])
        np.testing.assert_array_equal(velocity["time"], time)

    def test_mdanalysis(self):
        names = self.run_snippet("MDAnalysis")
        self.assertEqual(len(names["universe"].trajectory), 7)
        np.testing.assert_array_equal(names["universe"].atoms.radii, self.stored("radius"))
        results = names["pairs"].results
        self.assertEqual(results.rdf[results.bins < 1.9].sum(), 0, "spheres of radius 1 do not overlap")
        self.assertGreater(results.rdf[results.bins > 2].sum(), 0)

    def test_mdanalysis_reads_files_of_before_without_their_units(self):
        path = self.folder / "trajectory.h5"
        with h5py.File(path, "r+") as file:
            for name, unit in {"position/value": "length", "position/time": "time", "radius": "length"}.items():
                file[f"particles/all/{name}"].attrs["unit"] = unit
        with self.assertRaisesRegex(RuntimeError, "not recognized"):
            self.run_snippet("MDAnalysis")
        gc.collect()  # closes the file that it had opened
        self.run_snippet("MDAnalysis", 1)
        self.assertEqual(len(self.run_snippet("MDAnalysis")["universe"].trajectory), 7)

    def test_pyvista(self):
        names = self.run_snippet("pyvista")
        self.assertEqual(names["plane"].bounds[:4], (0, 16, 0, 12))
        # Twenty-five spheres of radius 1; their facets lie within them.
        self.assertAlmostEqual(names["spheres"].volume / 25, 4 / 3 * np.pi, delta=0.1)
        self.assert_drawn("plane.png")

    def test_starts_from_files_are_the_same_in_each_format(self):
        """The files of the page, with two spheres: each gives the run these positions, radii and species."""
        self.run_snippet(STARTS)
        [table], texts = blocks("csv", section(STARTS)), blocks("text", section(STARTS))
        files = {"start.csv": table, "start.xyz": texts[0], "start.lammps": texts[1], "start.h5": None, "start.h5md": None}
        sets = {
            "box": "{ edges = [20.0, 20.0, 20.0] }",
            "species": '[{ name = "large", radius = 1, count = 1 }, { name = "small", radius = 1, count = 1 }]',
            "time": "{ step = 0.01, steps = 1 }",
            "output.trajectory_every": 1,
        }
        starts = []
        for name, text in files.items():
            path, out = self.folder / name, self.folder / f"{name}-run"
            if text is not None:
                path.write_text(text)
            words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
            run(["run", ROOT / "scenes" / "shear.toml", "--out", out, *words, "--set", f'particles={{ initial = "file", path = "{path}" }}'])
            with h5py.File(out / "trajectory.h5") as file:
                particles = file["particles/all"]
                starts.append((particles["position/value"][0].tolist(), particles["species"][:].tolist()))
        self.assertEqual(sorted(zip(*starts[0])), [([2.0, 2.0, 2.0], 0), ([12.0, 2.0, 2.0], 1)])
        for name, start in zip(files, starts):
            self.assertEqual(sorted(zip(*start)), sorted(zip(*starts[0])), name)

    def test_paraview(self):
        script = self.folder / "slice.py"
        script.write_text(self.snippets["ParaView"][0])
        pvbatch(script.name, cwd=self.folder)
        for number in range(3):
            self.assert_drawn(f"slice-{number}.png")
