"""Complete and partial results of every scene that the program provides are drawn."""

import os
import pathlib
import subprocess
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

import matplotlib.image
import numpy as np

from program import ROOT, run
from test_scenes import SMALLER

# For run.py.
HEAVY = 75

PLOT = ROOT / "scripts" / "plot"
# Pictures need only a few rows.
SHORTER = {
    "tutorial": {"time.steps": 20},
    "extension": {"time.duration": 0.04},
    "couette": {"box.edges": "[8.0, 8.0, 8.0]", "time.duration": 0.06},
    "granular-disks": {"box.edges": "[30.0, 30.0]", "time.strain": 1.0},
    "disk-sweep": {"box.edges": "[30.0, 30.0]", "time.strain": 1.0},
    "poiseuille-disks": {"box.edges": "[30.0, 30.0]", "time.strain": 1.0},
}
SETTLING = {
    "box.edges": "[14.0, 14.0, 14.0]",
    "species[0].count": 20,
    "time.steps": 4,
    "output.trajectory_every": 1,
    "output.observables_every": 1,
}
NAMES = """
[box]
edges = [20.0, 20.0, 20.0]
[fluid]
viscosity = 1.0
[gravity]
acceleration = [0.0, 0.0, -1.0]
[[species]]
distribution = { kind = "log-normal", mean = 1.0, deviation = 0.2, classes = 4 }
volume_fraction = 0.05
density_difference = 1.0
[[species]]
name = "gro\u00df, $x_1$ \u7389"
radius = 1.5
count = 5
force = [0.0, 0.0, 3.0]
[time]
step = 0.02
steps = 4
[output]
trajectory_every = 1
observables_every = 1
[statistics]
every = 1
"""


def made(scene, out, sets):
    """Runs a scene on one thread."""
    words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
    run(["run", scene, "--out", out, "--threads", 1, *words])
    return out


def draw(*words):
    """The completed process of the plot command."""
    return subprocess.run([PLOT, *map(str, words)], capture_output=True, text=True)


class Plots(unittest.TestCase):
    def assert_drawn(self, folder, *words, left_out=()):
        """Draws without error messages, except for these notes on omitted parts."""
        drawn = draw(folder, *words)
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""), drawn.stdout)
        lines = drawn.stdout.splitlines()
        self.assertEqual(len(lines), 1 + len(left_out), drawn.stdout)
        for line, part in zip(lines, left_out):
            self.assertIn(part, line)
        image = matplotlib.image.imread(lines[-1].removeprefix("picture    "))[..., :3]
        share = np.mean((image - image[0, 0]) ** 2 > 0.01)
        self.assertGreater(share, 0.005, "a picture of nearly one colour")

    def assert_refused(self, message, *words):
        """Asserts an error of one line that names the missing part."""
        drawn = draw(*words)
        self.assertEqual((drawn.returncode, drawn.stdout), (1, ""))
        self.assertEqual(len(drawn.stderr.splitlines()), 1, drawn.stderr)
        self.assertTrue(drawn.stderr.startswith("error: ") and message in drawn.stderr, drawn.stderr)

    def test_every_scene_has_a_picture(self):
        scenes = [*sorted((ROOT / "scenes").glob("*.toml")), ROOT / "docs" / "src" / "tutorial.toml"]
        self.assertGreaterEqual(len(scenes), len(SMALLER))
        with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(max(2, os.cpu_count() or 2)) as pool:

            def drawn(scene):
                sets = SHORTER.get(scene.stem, SMALLER.get(scene.stem, {}))
                self.assert_drawn(made(scene, pathlib.Path(folder) / scene.stem, sets))

            works = {scene.stem: pool.submit(drawn, scene) for scene in scenes}
            for name, work in works.items():
                with self.subTest(scene=name):
                    work.result()

    def test_what_a_run_has_not_written_is_left_out_and_named(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = ROOT / "scenes" / "settling.toml"
            no_frames = made(scene, pathlib.Path(folder) / "no-frames", SETTLING | {"output.trajectory_every": 0})
            self.assert_drawn(no_frames, left_out=["output.trajectory_every"])
            no_series = made(scene, pathlib.Path(folder) / "no-series", SETTLING | {"output.observables_every": 0})
            self.assert_drawn(no_series, left_out=["output.observables_every"])
            (no_series / "trajectory.h5").unlink()
            self.assert_refused("output.observables_every", no_series)
            one = made(scene, pathlib.Path(folder) / "one", SETTLING | {"species[0].count": 1, "time.steps": 1})
            self.assert_drawn(one)

    def test_distributions_and_names_of_any_letters_are_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "names.toml"
            scene.write_text(NAMES, encoding="utf-8")
            out = made(scene, pathlib.Path(folder) / "out", {})
            self.assert_drawn(out)
            self.assert_drawn(out, "--by", "species")

    def test_an_output_that_is_full_is_an_error_of_one_line(self):
        with tempfile.TemporaryDirectory() as folder:
            out = made(ROOT / "scenes" / "pair-settling.toml", pathlib.Path(folder) / "out", {"time.steps": 2})
            with open("/dev/full", "w") as full:
                drawn = subprocess.run([PLOT, out], stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual(drawn.returncode, 1)
            self.assertRegex(drawn.stderr, r"^error: .*picture\.png was drawn, but the message can't be written: No space left.*\n$")
