"""What a run takes at its peak is what was predicted, and what can't be had is refused before it is taken."""

import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

from program import PROGRAM, ROOT, run

sys.path.insert(0, str(ROOT / "validation"))

import memory  # noqa: E402
from support.peak import measured, predicted  # noqa: E402


class Memory(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def scene(self, text):
        path = self.folder / "scene.toml"
        path.write_text(text)
        return path

    def compare(self, words, ranks, name):
        for rank, (said, found) in enumerate(zip(predicted(PROGRAM, words, ranks), measured(PROGRAM, words, ranks))):
            with self.subTest(scene=name, rank=f"{rank} of {ranks}"):
                self.assertLess(abs(said / found - 1), memory.ALLOWED, f"{said / 1e6} MB predicted, {found / 1e6} found")

    def test_spheres_take_what_is_predicted(self):
        for count, method, lubrication in [(1_000, "split", True), (1_000, "direct", False), (8_000, "split", False),
                                           (8_000, "split", True), (8_000, "direct", True)]:
            words = [self.scene(memory.spheres(count, method, lubrication))]
            for ranks in (1, 2):
                self.compare(words, ranks, f"{count} spheres, {method}, lubrication {lubrication}")

    def test_other_parts_of_a_run_take_what_is_predicted(self):
        scene = memory.spheres(8_000, "split", False)
        statistics = scene.replace("steps = 2 }", "steps = 40 }").replace("[[species]]", "statistics.every = 1\n[[species]]")
        self.compare([self.scene(statistics.replace("checkpoint_every = 1 ", "checkpoint_every = 20 "))], 1, "statistics")
        self.compare([self.scene(scene.replace("checkpoint_every = 1 ", "checkpoint_every = 1, fields_every = 1 "))], 2, "fields")
        sheared = "flow = { kind = \"shear\", rate = 1.0, lees_edwards = true }\nrepulsion.strength = 60.0\n"
        adaptive = scene.replace("steps = 2 }", "steps = 2, integrator = \"adaptive\" }")
        self.compare([self.scene(sheared + adaptive)], 2, "shear, adaptive steps")

    def test_grains_take_what_is_predicted(self):
        for name, words, _ in memory.cases(()):
            self.compare(words, 1, name)

    def refused(self, words, limit_kb=None, ranks=None):
        """What is said of a run that is refused at once; a limit on address space is there in any case."""
        launcher = ["mpirun", "-n", str(ranks)] if ranks else []
        command = ["bash", "-c", f'ulimit -v {limit_kb or 8_000_000}; exec "$@"', "bash", *launcher, PROGRAM, *map(str, words)]
        began = time.monotonic()
        ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 1, ended.stderr)
        self.assertLess(time.monotonic() - began, 30)
        self.assertNotIn("panic", ended.stderr)
        return ended.stderr

    def test_what_a_machine_does_not_have_is_refused(self):
        grid = memory.spheres(1_000, "direct", False).replace("lubrication", "grid = [2000, 2000, 2000], lubrication")
        out = self.folder / "out"
        for ranks in (None, 2):
            said = self.refused(["run", self.scene(grid), "--out", out], ranks=ranks)
            self.assertIn("hydrodynamics.grid", said)
            self.assertIn("GB", said)
        self.assertIn("warning", run(["check", self.scene(grid), "--ranks", 2]))
        many = memory.spheres(1_000_000_000, "split", True).replace("trajectory_every = 1", "trajectory_every = 0")
        many = self.scene(many)
        self.assertIn("1000000000 spheres", self.refused(["run", many, "--out", out]))
        self.assertIn("not placed", run(["check", many]))

    def test_a_limit_on_addresses_or_data_is_kept(self):
        scene = self.scene(memory.spheres(8_000, "direct", True))
        said = self.refused(["run", scene, "--out", self.folder / "out"], limit_kb=270_000)
        self.assertIn("ulimit -v", said)
        self.assertIn("8000 spheres", said)

    def test_grains_that_do_not_fit_are_refused(self):
        out = ["--out", self.folder / "out"]
        words = [ROOT / "scenes" / "shear-cell.toml", "--set", "grains.diameter=4e-6", "--set", "output.trajectory_every=0"]
        self.assertIn("grains", self.refused(["run", *words, *out]))
        self.assertIn("warning", run(["check", *words]))
        words = [ROOT / "scenes" / "shear-cell-continuum.toml", "--set", "output.points=1000000",
                 "--set", f"cell.speeds={[1 + k for k in range(1000)]}"]
        self.assertIn("output.points", self.refused(["run", *words, *out]))


if __name__ == "__main__":
    unittest.main()
