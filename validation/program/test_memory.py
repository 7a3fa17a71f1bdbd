"""The peak memory of a run is as predicted, and a run that would need more than is available is refused before it allocates it."""

import os
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

# For run.py.
HEAVY = 60

# Forecasts are compared where the program has all cores.
os.environ.pop("RAYON_NUM_THREADS", None)


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
        statistics = scene.replace("steps = 2 }", "steps = 20 }").replace("[[species]]", "statistics.every = 1\n[[species]]")
        self.compare([self.scene(statistics.replace("checkpoint_every = 1 ", "checkpoint_every = 10 "))], 1, "statistics")
        self.compare([self.scene(scene.replace("checkpoint_every = 1 ", "checkpoint_every = 1, fields_every = 1 "))], 2, "fields")
        few = memory.spheres(500, "split", False).replace("checkpoint_every = 1 ", "checkpoint_every = 1, fields_every = 2 ")
        walls = few.replace("fluid.viscosity", 'box.boundaries = ["periodic", "walls", "periodic"]\nfluid.viscosity')
        self.compare([self.scene(walls)], 2, "fields between walls")
        sheared = "flow = { kind = \"shear\", rate = 1.0, lees_edwards = true }\nrepulsion.strength = 60.0\n"
        adaptive = scene.replace("steps = 2 }", "steps = 2, integrator = \"adaptive\" }")
        self.compare([self.scene(sheared + adaptive)], 2, "shear, adaptive steps")

    def test_grains_take_what_is_predicted(self):
        for name, words, _ in memory.cases(()):
            self.compare(words, 1, name)

    def refused(self, words, limit_kb=None, ranks=None):
        """Error message of a run that is refused at once; a limit on address space is always set."""
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
        said = self.refused(["check", many])
        self.assertIn("1000000000 spheres", said)
        self.assertIn("not placed", run(["check", many, "--ranks", 1]))

    def test_a_limit_on_addresses_or_data_is_kept(self):
        scene = self.scene(memory.spheres(16_000, "direct", True))
        said = self.refused(["run", scene, "--out", self.folder / "out"], limit_kb=270_000)
        self.assertIn("ulimit -v", said)
        self.assertIn("16000 spheres", said)

    def test_what_a_control_group_does_not_leave_is_refused(self):
        """The files of a control group, in place of those of the machine, visible only to this process."""
        groups = self.folder / "groups"
        groups.mkdir()
        for name, text in [("memory.max", "150000000"), ("memory.current", "60000000"), ("memory.stat", "inactive_file 9")]:
            (groups / name).write_text(text + "\n")
        inside = ["unshare", "--mount", "bash", "-c", 'mount --bind "$0" /sys/fs/cgroup && exec "$@"', groups]
        if subprocess.run([*inside, "true"], capture_output=True).returncode != 0:
            self.skipTest("private mounts are not available: unshare --mount, mount --bind")
        scene = self.scene(memory.spheres(8_000, "direct", True))
        command = [*inside, PROGRAM, "run", scene, "--out", self.folder / "out"]
        ended = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 1, ended.stderr)
        self.assertIn("the control group, /sys/fs/cgroup/memory.max leaves 90.0 MB", ended.stderr)
        self.assertIn("species.count", ended.stderr)

    def test_members_of_a_family_that_do_not_fit_are_refused(self):
        scene = ROOT / "scenes" / "disk-sweep.toml"
        out = ["--out", self.folder / "out"]
        sets = ["--set", "box.edges=[1e12, 1e12]", "--set", "output.observables_every=1"]
        self.assertIn("particles.area_fraction", self.refused(["check", scene, *sets]))
        self.assertIn("particles.area_fraction", self.refused(["run", scene, *sets, *out]))

    def test_disks_beyond_their_cells_are_refused(self):
        """Few disks in a large box, where rare large disks leave room for many small ones."""
        scene = ROOT / "scenes" / "granular-disks.toml"
        out = ["--out", self.folder / "out", "--set", "particles.length_unit=\"smallest\""]
        rare = ["--set", "species=[{radius=1.0, share=1.0}, {radius=1e6, share=1e-13}]", "--set", "box.edges=[1e6, 1e6]"]
        self.assertIn("particles.area_fraction", self.refused(["check", scene, *rare, *out[2:]]))
        dilute = ["--set", "box.edges=[2.5e5, 2.5e5]", "--set", "particles.area_fraction=1e-4", "--set", "species=[{radius=1.0, share=1.0}]"]
        said = self.refused(["run", scene, *dilute, *out], limit_kb=1_600_000)
        self.assertIn("particles.area_fraction", said)
        self.assertIn("ulimit -v", said)

    def test_columns_of_many_species_are_refused(self):
        species = "\n".join(f"[[species]]\nname = '{k}'\nradius = 1.0\ncount = 1\n" for k in range(2000))
        scene = f"[box]\nedges = [8000.0, 8000.0, 8000.0]\n[fluid]\nviscosity = 1.0\n{species}[time]\nstep = 0.1\nsteps = 1\n" \
                "[hydrodynamics]\nmultipoles = 'monopole'\nmethod = 'split'\ntolerance = 1e-2\n"
        said = self.refused(["run", self.scene(scene), "--out", self.folder / "out"])
        self.assertIn("fewer [[species]]", said)

    def test_problems_of_a_continuum_are_refused(self):
        scene = ROOT / "scenes" / "shear-cell-continuum.toml"
        many = f"cell.speeds={[1 + k for k in range(1000)]}"
        out = ["--out", self.folder / "out"]
        self.assertIn("cell.speeds", self.refused(["run", scene, "--set", many, "--set", "output.points=1000000", *out]))
        pressures = f"cell.pressures={[1 + k for k in range(1000)]}"
        self.assertIn("cell.pressures", self.refused(["check", scene, "--set", many, "--set", pressures]))
        self.assertIn("output.points", self.refused(["check", scene, "--set", "output.points=1000000000000"]))

    def test_spheres_of_a_benchmark_are_refused(self):
        self.assertIn("--particles", self.refused(["bench", "--particles", 4_000_000_000]))
        self.assertIn("--particles", self.refused(["bench", "--particles", 100_000_000], ranks=2))
        self.assertIn("--grid", self.refused(["bench", "--particles", 20, "--grid", 8192]))

    def test_grains_that_do_not_fit_are_refused(self):
        out = ["--out", self.folder / "out"]
        words = [ROOT / "scenes" / "shear-cell.toml", "--set", "grains.diameter=4e-6", "--set", "output.trajectory_every=0"]
        self.assertIn("grains", self.refused(["run", *words, *out]))
        self.assertIn("grains", self.refused(["check", *words]))
        words = [ROOT / "scenes" / "shear-cell-continuum.toml", "--set", "output.points=1000000",
                 "--set", f"cell.speeds={[1 + k for k in range(1000)]}"]
        self.assertIn("output.points", self.refused(["run", *words, *out]))


if __name__ == "__main__":
    unittest.main()
