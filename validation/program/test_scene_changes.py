"""Runs that continue with a changed scene, and stored scenes that are run again."""

import csv
import pathlib
import re
import shutil
import tempfile
import unittest

import h5py

from program import ROOT, answered, run

SETS = {
    "box.edges": "[10.0, 10.0, 10.0]",
    "species[0].count": 8,
    "hydrodynamics.tolerance": 1e-2,
    "time.steps": 6,
    "output.trajectory_every": 1,
    "output.checkpoint_every": 2,
    "repulsion.strength": 40.0,
    "repulsion.range": 0.2,
}
SCENE = ROOT / "scenes" / "settling.toml"


def words(sets):
    return [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]


def frames(out):
    with h5py.File(out / "trajectory.h5") as file:
        return file["particles/all/position/step"][:].tolist()


def rows(out):
    """The time series without the seconds per step."""
    return [line.rpartition(",")[0] for line in (out / "observables.csv").read_text().splitlines()]


class SceneChanges(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.place.cleanup)
        cls.whole = pathlib.Path(cls.place.name) / "whole"
        run(["run", SCENE, "--out", cls.whole, *words(SETS)])

    def setUp(self):
        self.out = self.whole.with_name("out")
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.whole, self.out)

    def edit(self, *changes):
        scene = self.out / "scene.toml"
        text = scene.read_text()
        for before, after in changes:
            self.assertRegex(text, before)
            text = re.sub(before, after, text)
        scene.write_text(text)

    def files(self):
        return {path: path.read_bytes() for path in self.out.rglob("*") if path.is_file()}

    def test_the_start_of_means_may_change(self):
        sets = SETS | {"time.steps": 40, "output.observables_every": 1, "answers.from": 0.2}
        shutil.rmtree(self.out)
        run(["run", SCENE, "--out", self.out, *words(sets)])

        def transients(*words):
            answers = answered(["stats", self.out, "--json", *words])["answers"]
            return {round(answer["transient"], 6) for answer in answers if not answer["quantity"].startswith("diffusivity")}

        def summary():
            with open(self.out / "summary.csv", newline="") as file:
                return {round(float(row["transient"]), 6) for row in csv.DictReader(file)}

        self.assertEqual((transients(), summary()), ({0.2}, {0.2}))
        self.edit((r"from = .*", "from = 0.5"))
        said = run(["resume", self.out, "--steps", 60])
        self.assertIn("answers.from is 0.5 from step 40 on, and was 0.2", said)
        self.assertEqual((transients(), summary()), ({0.5}, {0.5}))
        self.assertEqual(transients("--from", 0.75), {0.75})
        page = self.out / "report.html"
        run(["report", self.out])
        self.assertTrue(page.is_file())
        self.edit((r"from = .*", "from = 9.0"))
        self.assertIn("answers.from is 9; means need a time from 0 on", run(["resume", self.out, "--steps", 80], expect=1))

    def test_an_end_before_the_present_step_is_refused(self):
        held = self.files()
        said = run(["resume", self.out, "--steps", 5], expect=1)
        self.assertIn("--steps is 5, and the run has reached step 6; name a later step", said)
        self.assertEqual(self.files(), held)

    def test_an_edited_scene_is_refused_by_its_keys(self):
        for key, before, after, values in (
            ("time.step", r"(?m)^step = .*", "step = 0.05", "is 0.05 here and 0.025 there"),
            ("box.edges", r"edges = .*", "edges = [20.0, 10.0, 10.0]", "is [20.0, 10.0, 10.0] here and [10.0, 10.0, 10.0] there"),
            ("species[0].count", r"count = 8", "count = 9", "is 9 here and 8 there"),
            ("hydrodynamics.tolerance", r"tolerance = .*", "tolerance = 0.001", "is 0.001 here and 0.01 there"),
            ("flow.rate", r"(?s)\Z", '\n[flow]\nkind = "shear"\nrate = 1.0\n', "is 1.0 here and absent there"),
        ):
            self.setUp()
            self.edit((before, after))
            held = self.files()
            said = run(["resume", self.out, "--steps", 8, "--accept", "fluid.viscosity"], expect=1)
            with self.subTest(key=key):
                self.assertIn(f"{key} {values}", said)
                self.assertIn("the run's checkpoint of step 6", said)
                self.assertEqual(self.files(), held)

    def test_what_changes_the_answers_has_to_be_accepted_and_is_noted(self):
        self.edit((r"viscosity = 1.0", "viscosity = 2.0"), (r"strength = 40.0", "strength = 50.0"))
        held = self.files()
        said = run(["resume", self.out, "--steps", 9], expect=1)
        self.assertIn("fluid.viscosity is 2.0 here and 1.0 there, repulsion.strength is 50.0 here and 40.0 there", said)
        self.assertIn("accept it by --accept fluid.viscosity --accept repulsion.strength", said)
        self.assertEqual(self.files(), held)
        said = run(["resume", self.out, "--accept", "seed"], expect=1)
        self.assertIn("--accept seed: a run can't go on with another value of this key", said)
        accepted = ["--accept", "fluid.viscosity", "--accept", "repulsion.strength"]
        said = run(["resume", self.out, "--steps", 9, *accepted])
        changes = [
            "fluid.viscosity is 2.0 from step 6 on, and was 1.0",
            "repulsion.strength is 50.0 from step 6 on, and was 40.0",
            "time.steps is 9 from step 6 on, and was 6",
        ]
        for change in changes:
            self.assertIn(f"the scene has changed: {change}", said)
        for name in ("trajectory.h5", "observables.h5"):
            self.assertIn("".join(f"changed    {change}\n" for change in changes), run(["info", self.out / name]))
            text = run(["info", self.out / name, "--scene"])
            self.assertRegex(text, r"(?m)^viscosity = 1.0$")
            self.assertIn(f"# {changes[0]}\n", text)
        said = run(["resume", self.out, "--steps", 12])
        self.assertNotIn("viscosity", said)
        self.assertEqual(frames(self.out), list(range(13)))
        self.assertIn(f"warning: {self.out}/trajectory.h5: {changes[0]}; the statistics are of both", run(["stats", self.out]))

    def test_what_was_accepted_stays_so_after_a_kill(self):
        """The checkpoint is written again with the accepted value, and the answer is that of an uninterrupted run."""
        self.edit((r"viscosity = 1.0", "viscosity = 2.0"))
        run(["resume", self.out, "--accept", "fluid.viscosity"])
        self.assertNotIn("viscosity", run(["resume", self.out, "--steps", 9]))
        other = self.whole.with_name("other")
        shutil.rmtree(other, ignore_errors=True)
        shutil.copytree(self.whole, other)
        (other / "scene.toml").write_text((self.whole / "scene.toml").read_text().replace("viscosity = 1.0", "viscosity = 2.0"))
        run(["resume", other, "--steps", 9, "--accept", "fluid.viscosity"])
        name = "checkpoint-0000000009.bin"
        self.assertEqual((self.out / name).read_bytes(), (other / name).read_bytes())

    def test_output_and_end_may_change(self):
        self.edit((r"trajectory_every = 1", "trajectory_every = 3"), (r"steps = 6", "duration = 0.45"))
        said = run(["resume", self.out])
        self.assertIn("output.trajectory_every is 3 from step 6 on, and was 1", said)
        self.assertEqual(frames(self.out), [*range(7), 9, 12, 15, 18])
        said = run(["resume", self.out, "--steps", 21])
        self.assertNotIn("missing", said)
        self.assertNotIn("missing", run(["stats", self.out]))

    def test_changed_statistics_begin_anew(self):
        self.edit((r"(?s)\Z", "\n[statistics]\nevery = 1\n"))
        self.assertIn("start afresh at step 6", run(["resume", self.out, "--steps", 9]))
        self.edit((r"\[statistics\]\nevery = 1", "[statistics]\nevery = 2\ndistance = 3.0"))
        self.assertIn("start afresh at step 9", run(["resume", self.out, "--steps", 14]))
        self.assertRegex((self.out / "statistics" / "summary.csv").read_text(), r"samples,all,,3\.0")

    def test_job_scripts_may_change_the_same_keys(self):
        again = ["run", SCENE, "--out", self.out, "--continue", *words(SETS | {"time.steps": 9, "output.trajectory_every": 3})]
        self.assertIn("output.trajectory_every is 3 from step 6 on", run(again))
        self.assertEqual(frames(self.out), [*range(7), 9])
        self.assertIn("finished already", run(again))
        other = [*again, "--set", "fluid.viscosity=3.0", "--set", "time.steps=12"]
        self.assertIn("accept it by --accept fluid.viscosity", run(other, expect=1))
        self.assertIn("fluid.viscosity is 3.0 from step 9 on", run([*other, "--accept", "fluid.viscosity"]))

    def test_frames_and_rows_that_are_gone_are_named(self):
        older = self.whole.with_name("older")
        shutil.rmtree(older, ignore_errors=True)
        run(["run", SCENE, "--out", older, *words(SETS | {"time.steps": 3})])
        trajectory = self.out / "trajectory.h5"
        shutil.copy(older / "trajectory.h5", trajectory)
        said = run(["resume", self.out, "--steps", 8])
        self.assertIn(f"warning: {trajectory} was cut, or replaced by another copy: 3 frames are missing, of steps 4 to 6", said)
        self.assertEqual(frames(self.out), [0, 1, 2, 3, 7, 8])
        self.assertIn("3 frames that the run was to write are missing, of steps 4 to 6", run(["stats", self.out]))
        self.setUp()
        trajectory.unlink()
        said = run(["resume", self.out, "--steps", 8])
        self.assertIn(f"warning: {trajectory} is gone: 7 frames are missing, of steps 0 to 6", said)
        self.setUp()
        whole = rows(self.out)
        shutil.copy(older / "observables.h5", self.out)
        self.assertNotIn("missing", run(["resume", self.out]))
        self.assertEqual(rows(self.out), whole)
        for name in ("observables.csv", "observables.h5"):
            shutil.copy(older / name, self.out)
        said = run(["resume", self.out])
        self.assertIn("observables.h5 was cut, or replaced by another copy: 3 rows are missing, of steps 4 to 6", said)

    def test_the_trajectory_of_another_scene_is_refused(self):
        other = self.whole.with_name("other-seed")
        shutil.rmtree(other, ignore_errors=True)
        run(["run", SCENE, "--out", other, *words(SETS | {"seed": 99})])
        shutil.copy(other / "trajectory.h5", self.out)
        said = run(["resume", self.out, "--steps", 8], expect=1)
        self.assertIn("trajectory.h5 is damaged: it is of another scene than the checkpoint: seed is", said)

    def test_a_kept_scene_can_be_run_again_from_anywhere(self):
        place = self.whole.with_name("project")
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        run(["export", self.whole, "--to", "xyz", "--frames", "0", "--out", place / "start.xyz"])
        scene = place / "my.toml"
        text = (self.whole / "scene.toml").read_text()
        scene.write_text(re.sub(r'(?m)^initial = .*\nminimum_gap = .*$', 'initial = "file"\npath = "start.xyz"', text))
        self.assertIn("start.xyz", scene.read_text())
        run(["run", scene, "--out", place / "a"])
        kept = (place / "a" / "scene.toml").read_text()
        self.assertIn(f'path = "{place.resolve()}/start.xyz"  # was "start.xyz"', kept)
        run(["run", place / "a" / "scene.toml", "--out", place / "b"])
        name = "checkpoint-0000000006.bin"
        self.assertEqual((place / "a" / name).read_bytes(), (place / "b" / name).read_bytes())
        self.assertIn("finished already", run(["run", scene, "--out", place / "a", "--continue"]))
        moved = place.with_name("moved")
        shutil.rmtree(moved, ignore_errors=True)
        place.rename(moved)
        sets = ["--set", "time.steps=8"]
        self.assertIn("finished after step 8", run(["run", moved / "my.toml", "--out", moved / "a", "--continue", *sets]))


if __name__ == "__main__":
    unittest.main()
