"""Stages of evaluations and steps inside and outside of parallel loops."""

import json
import pathlib
import subprocess
import tempfile
import unittest

from program import PROGRAM

SCENE = """
box.edges = [18.0, 18.0, 18.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 1.0, lees_edwards = true }
contacts.friction = 0.5
hydrodynamics = { tolerance = 1e-2, lubrication = true }
time = { step = 0.005, steps = 20 }
[[species]]
radius = 1.0
count = 250
"""


def lines(*words):
    """The lines of a benchmark on one thread."""
    ended = subprocess.run([PROGRAM, "bench", *words, "--threads", "1"], check=True, capture_output=True, text=True)
    return [json.loads(line) for line in ended.stdout.splitlines()]


class Stages(unittest.TestCase):
    def check(self, shares, names):
        """Checks that parts add up to the whole, and that estimates lie between the serial time and that of one thread."""
        stages = {stage["stage"]: stage for stage in shares["stages"]}
        self.assertLessEqual(names, set(stages))
        self.assertAlmostEqual(sum(stage["seconds"] for stage in stages.values()) / shares["seconds"], 1.0)
        self.assertAlmostEqual(sum(stage["serial_share"] for stage in stages.values()), shares["serial_share"])
        for stage in stages.values():
            self.assertAlmostEqual(stage["parallel"] + stage["serial"], stage["seconds"])
            self.assertGreaterEqual(stage["largest_over_mean"], 1.0 - 1e-12)
        for estimate in shares["estimates"]:
            self.assertGreater(estimate["seconds"], shares["serial_share"] * shares["seconds"])
        self.assertEqual([estimate["threads"] for estimate in shares["estimates"]], [2, 4, 8, 16, 32, 64, 128])

    def test_an_evaluation_with_lists_searches_and_a_repeated_one_does_not(self):
        [line] = lines("--serial", "--particles", "2000", "--repeats", "2")
        names = {"arrangement", "stencils", "neighbour lists", "exchange", "spreading", "transforms", "interpolation", "pair corrections"}
        of_lists = {}
        for kind in ("with_lists", "repeated"):
            self.check(line[kind], names)
            of_lists[kind] = next(stage["loops"] for stage in line[kind]["stages"] if stage["stage"] == "neighbour lists")
        self.assertGreater(of_lists["with_lists"], of_lists["repeated"])

    def test_a_step_has_the_stages_of_its_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.toml"
            path.write_text(SCENE)
            [line] = lines("--step", str(path), "--repeats", "2")
        self.assertEqual(line["particles"], 250)
        names = {"integration", "migration", "contacts", "lists of near pairs", "assembly of near pairs", "preconditioner",
                 "coupled solve", "spreading", "transforms"}
        self.check(line["step"], names)
        self.check(line["observables"], {"observables"})


if __name__ == "__main__":
    unittest.main()
