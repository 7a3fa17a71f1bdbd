"""Cases and scenes in other units, and those that cannot be planned or placed."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

from program import ROOT, command

sys.path.insert(0, str(ROOT / "validation"))
import units

TINY = """
box.edges = [10.0, 10.0, 10.0]
fluid.viscosity = 1.0
time = { step = 0.01, steps = 1 }
species = [{ name = "large", radius = 1.0, count = 1, force = [0.0, 0.0, -1.0] },
           { name = "small", radius = 0.1, count = 1 }]
"""


class Units(unittest.TestCase):
    def test_answers_have_the_same_digits_in_any_units(self):
        for tolerance, allowed in units.ALLOWED.items():
            for lubrication in (False, True):
                self.assertLess(units.worst_answer(lubrication, tolerance, 0.3, units.SYSTEMS[8:27:18]), allowed)

    def test_runs_are_the_same_in_si_units(self):
        for kind in units.KINDS:
            with self.subTest(kind=kind):
                self.assertLess(units.worst_run(kind, units.OF_RUNS[:1]), units.ALLOWED_OF_RUN)


class Planning(unittest.TestCase):
    def check(self, *sets):
        """Output of `check` for a scene with these keys, within a time too short for a search through all grids."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.toml"
            path.write_text(TINY)
            words = [word for one in sets for word in ("--set", one)]
            ended = subprocess.run(command(["check", path, *words]), capture_output=True, text=True, timeout=20)
        return ended.stdout + ended.stderr

    def test_any_scene_is_planned_or_refused(self):
        direct = 'hydrodynamics.method="direct"'
        for radius in (0.05, 0.01, 0.001, 1e-9):
            self.assertIn("method     split", self.check(f"species[1].radius={radius}"))
        self.assertIn("method     direct", self.check("species[1].radius=0.01", direct))
        self.assertIn("the smallest radius, 1e-6, needs", self.check("species[1].radius=1e-6", direct))
        for edges in ("[1e9, 1e9, 1e9]", "[1e9, 10.0, 10.0]"):
            self.assertIn("grid  ", self.check(f"box.edges={edges}"))
        self.assertIn("1000 x 1000 x 1000", self.check("hydrodynamics.grid=[1000, 1000, 1000]", direct))
        said = self.check("hydrodynamics.grid=[65536, 65536, 65536]", direct)
        self.assertTrue("leave it out, or take fewer" in said or "memory" in said, said)
        self.assertIn("the transform takes up to 1048576 points along an axis", self.check("hydrodynamics.grid=[1152921504606846976, 8, 8]"))


class Overlaps(unittest.TestCase):
    CASE = {"box": [10.0] * 3, "viscosity": 1.0, "radii": 1.0, "forces": [[1.0, 0.0, 0.0]] * 2}

    def said(self, positions, **more):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "case.json"
            path.write_text(json.dumps(self.CASE | {"positions": positions} | more))
            ended = subprocess.run(command(["mobility", path]), capture_output=True, text=True, timeout=20)
        return ended.returncode, ended.stderr

    def test_spheres_that_overlap_are_named(self):
        overlapping, touching = [[1.0, 2.0, 2.0], [9.5, 2.0, 2.0]], [[1.0, 2.0, 2.0], [3.0, 2.0, 2.0]]
        name = "spheres 0 and 1, counted from 0, overlap by 0.500 radii of the smaller"
        code, said = self.said(overlapping, lubrication=True)
        self.assertEqual(code, 1)
        self.assertIn(f": {name}; lubrication acts between spheres that are apart", said)
        code, said = self.said(overlapping)
        self.assertEqual(code, 0)
        self.assertIn(f"warning: {name}", said)
        for lubrication in (False, True):
            self.assertEqual(self.said(touching, lubrication=lubrication), (0, ""))

    def test_spheres_at_one_point_are_refused_with_lubrication(self):
        code, said = self.said([[1.0] * 3] * 2, lubrication=True)
        self.assertEqual(code, 1)
        self.assertIn("overlap by 2.000 radii", said)


if __name__ == "__main__":
    unittest.main()
