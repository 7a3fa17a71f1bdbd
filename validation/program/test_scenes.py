"""Every scene that the program provides runs at a small size."""

import pathlib
import re
import tempfile
import unittest

import h5py
import numpy as np

from program import ROOT, run

# Settings that make each scene small; a scene without an entry runs unchanged.
SMALLER = {
    "settling": {"box.edges": "[16.0, 16.0, 16.0]", "species[0].count": 100, "time.steps": 5},
    "silica-in-water": {"box.edges": "[40e-6, 40e-6, 40e-6]", "time.steps": 5},
    "suspension": {"species[0].volume_fraction": 0.02, "species[1].count": 5, "time.steps": 5},
    "shear": {"box.edges": "[12.0, 12.0, 12.0]", "time.duration": 0.025},
    "pair-settling": {"time.steps": 5},
    "segregation": {"box.edges": "[12.0, 12.0, 12.0]", "time.duration": 0.125},
    "dense": {"time.duration": 0.05},
    "reversal": {"flow.reversal_at": "[0.025]", "time.duration": 0.05},
    "thickening": {"time.duration": 3.0},
    "couette": {"box.edges": "[10.0, 10.0, 12.0]", "time.duration": 0.06},
    "poiseuille": {"box.edges": "[10.0, 10.0, 10.0]", "time.duration": 0.3},
    "sediment": {"species[0].count": 20, "time.duration": 0.2},
    "cloud": {"species[0].count": 20, "time.duration": 0.2},
    "chain": {"time.duration": 0.2},
    "filament": {"box.edges": "[34.0, 34.0, 34.0]", "filaments[0].count": 3, "time.duration": 0.2},
    "extension": {"time.duration": 0.1},
    "colloid": {"time.duration": 0.2, "statistics.every": 1, "statistics.from": 0.0},
    "brownian-shear": {"time.duration": 0.2, "statistics.every": 1, "statistics.from": 0.0},
    "colloid-sediment": {"species[0].count": 20, "time.duration": 0.2, "statistics.every": 1, "statistics.from": 0.0},
    "orientations": {"species[0].count": 10, "time.duration": 0.5, "statistics.every": 1},
    "squirmers": {"box.edges": "[11.0, 11.0, 11.0]", "time.duration": 0.5},
    "bodies": {"species[0].count": 5, "bodies[0].count": 4, "bodies[1].count": 3, "time.duration": 0.2},
    "rollers": {"bodies[0].count": 4, "time.duration": 0.05},
    "rods": {"box.edges": "[20.0, 20.0, 20.0]", "bodies[0].volume_fraction": 0.02, "time.strain": 0.02},
    "magnetic-chains": {"box.edges": "[12.0, 12.0, 12.0]", "species[0].count": 20, "time.duration": 0.5},
    "granular-disks": {"time.strain": 1.0},
    "disk-sweep": {"time.strain": 1.0},
    "poiseuille-disks": {"time.strain": 1.0},
    "family": {"time.strain": 0.05},
    "shear-cell": {"time.steps": 3, "time.transient": 0},
}
# Scenes of grains and families run in one process.
ALONE = {"family", "granular-disks", "disk-sweep", "poiseuille-disks", "shear-cell", "shear-cell-continuum"}


class Scenes(unittest.TestCase):
    def test_every_scene_runs(self):
        scenes = sorted((ROOT / "scenes").glob("*.toml"))
        self.assertGreaterEqual(len(scenes), len(SMALLER))
        for scene in scenes:
            sets = [word for key, value in SMALLER.get(scene.stem, {}).items() for word in ("--set", f"{key}={value}")]
            with self.subTest(scene=scene.stem), tempfile.TemporaryDirectory() as folder:
                run(["check", scene])
                run(["check", scene, *sets])
                ranks = None if scene.stem in ALONE else 2
                out = pathlib.Path(folder) / "out"
                run(["run", scene, "--out", out, *sets], ranks)

    def test_two_spheres_side_by_side_fall_as_the_theory_says(self):
        """Forces alone give 1 + 3/4 (a/r) + 1/2 (a/r)^3 in free space; the images of the box subtract 2.8373 a/L for
        each of the two spheres. The terms neglected in both are below a hundredth at a distance of three radii."""
        with tempfile.TemporaryDirectory() as folder:
            run(["run", ROOT / "scenes" / "pair-settling.toml", "--out", f"{folder}/out", "--set", "time.steps=2"])
            with h5py.File(f"{folder}/out/trajectory.h5") as file:
                velocity = file["particles/all/velocity/value"][0]
        np.testing.assert_allclose(velocity[0], velocity[1] * [-1, -1, 1], atol=2e-3)
        expected = 1 + 0.75 / 3 + 0.5 / 27 - 2 * 2.8373 / 32
        self.assertAlmostEqual(-velocity[0, 2], expected, delta=0.01)


class Documentation(unittest.TestCase):
    def test_the_page_on_the_command_line_has_every_command(self):
        commands = re.search(r"^Commands:\n(.*?)^\n", run(["--help"]), re.DOTALL | re.MULTILINE)[1]
        existing = set(re.findall(r"^  ([a-z-]+)", commands, re.MULTILINE)) - {"help"}
        page = (ROOT / "docs" / "src" / "command-line.md").read_text()
        self.assertEqual(set(re.findall(r"^\| `fcm-solve ([a-z-]+)", page, re.MULTILINE)), existing)
