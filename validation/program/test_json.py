"""Output for other programs: values as JSON, the schema of scenes, manual pages."""

import pathlib
import tempfile
import unittest

from program import ROOT, answered, run

SMALL = ("--set", "time.steps=4", "--set", "output.trajectory_every=1")


class Values(unittest.TestCase):
    def test_every_scene_is_outlined_as_its_lines_say(self):
        for scene in sorted((ROOT / "scenes").glob("*.toml")):
            with self.subTest(scene=scene.stem):
                outline = answered(["check", scene, "--json", "--no-trial"])
                if outline.get("kind") == "family":
                    self.assertEqual(outline["runs"], sum(point["runs"] for point in outline["points"]))
                    continue
                lines = dict(line.split(None, 1) for line in run(["check", scene, "--no-trial"]).splitlines())
                count = "problems" if "problems" in outline else "particles"
                named = lines.get("particles") or lines.get("disks") or lines.get("grains") or lines.get("problems")
                self.assertEqual(str(outline[count]), named.split(",")[0])
                self.assertGreater(outline["memory_bytes"][0], 1e6)
                self.assertIsInstance(outline["warnings"], list)

    def test_memory_of_each_rank_and_the_plan_are_values(self):
        scene = ROOT / "scenes" / "settling.toml"
        tried = answered(["check", scene, "--json"])
        self.assertGreater(tried["seconds_of_run"], 100 * tried["seconds_per_step"])
        # Mostly 101 frames of 124 bytes per sphere.
        self.assertAlmostEqual(tried["output_bytes"] / (101 * 3200 * 124), 1.05, delta=0.15)
        self.assertNotIn("seconds_of_run", answered(["check", scene, "--json", "--no-trial"]))
        outline = answered(["check", scene, "--json", "--ranks", 3])
        self.assertGreater(outline["seconds_of_run"], 100 * outline["seconds_per_step"])
        self.assertTrue(1 / 3 < outline["efficiency"] <= 1.0 and outline["ranks_worth"] >= 3, outline)
        self.assertEqual((outline["kind"], outline["particles"], outline["steps"]), ("suspension", 3200, 400))
        self.assertAlmostEqual(outline["volume_fraction"], 0.1212, delta=1e-4)
        self.assertEqual(len(outline["memory_bytes"]), 3)
        plan = outline["plan"]
        self.assertEqual((plan["method"], plan["tolerance"]), ("split", 1e-3))
        self.assertLess(plan["expected_error"], 1e-3)
        self.assertTrue(all(points % 2 == 0 for points in plan["grid"]))
        seconds = [one["expected_seconds"] for one in (plan, *outline["other_plans"])]
        self.assertEqual(seconds, sorted(seconds))

    def test_files_and_statistics_are_described(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out"
            run(["run", ROOT / "scenes" / "pair-settling.toml", "--out", out, *SMALL])
            contents = answered(["info", out / "trajectory.h5", "--json"])
            frames = contents["frames"]
            self.assertEqual((frames["count"], frames["steps"], contents["damage"]), (5, [0, 4], []))
            shapes = {dataset["name"]: dataset["shape"] for dataset in contents["datasets"]}
            self.assertEqual(shapes["/particles/all/position/value"], [5, 2, 3])
            statistics = answered(["stats", out, "--json"])
            self.assertEqual(statistics["tables"], str(out / "stats"))
            rows = statistics["summary"]
            self.assertTrue(all({"quantity", "species", "unit", "value", "error"} <= row.keys() for row in rows))


class Editors(unittest.TestCase):
    def test_a_new_scene_names_the_schema(self):
        self.assertEqual(run(["new", "settling"]).splitlines()[0], "#:schema fcm-solve.schema.json")
        schema = answered(["schema"])
        self.assertIn("draft-07", schema["$schema"])
        tolerance = schema["definitions"]["HydrodynamicsSection"]["properties"]["tolerance"]
        self.assertIn("Relative error", tolerance["description"])


class Manual(unittest.TestCase):
    def test_pages_name_the_commands(self):
        self.assertIn("fcm\\-solve", run(["man"]))
        with tempfile.TemporaryDirectory() as folder:
            run(["man", "--out", folder])
            pages = {page.name for page in pathlib.Path(folder).iterdir()}
            self.assertLessEqual({"fcm-solve.1", "fcm-solve-run.1", "fcm-solve-mobility.1"}, pages)
            self.assertIn("walltime", (pathlib.Path(folder) / "fcm-solve-run.1").read_text())
