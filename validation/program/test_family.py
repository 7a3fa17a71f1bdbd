"""Families of runs: seeds and values of keys, killed, stopped, continued, in parts, and with members that fail."""

import csv
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from program import PROGRAM, answered, run, start
from small_run import wait_for

SCENE = """
seed = 4
[box]
edges = [9.0, 9.0, 9.0]
[fluid]
viscosity = 1.0
[[species]]
radius = 1.0
volume_fraction = 0.1
[flow]
kind = "shear"
rate = 1.0
[hydrodynamics]
tolerance = 1e-2
[time]
step = 0.02
steps = {steps}
[output]
trajectory_every = 0
checkpoint_every = 5
"""
FAMILY = SCENE + """
[ensemble]
seeds = 3
[sweep]
"species[0].volume_fraction" = [0.05, 0.1]
"""
MEMBERS = [f"point-{point:04}/seed-{seed:04}" for point in (1, 2) for seed in (4, 5, 6)]


def series(out):
    """The rows of a time series without the seconds per step."""
    with open(out / "observables.csv") as file:
        return [[value for key, value in row.items() if "seconds" not in key] for row in csv.DictReader(file)]


def results(out):
    """The series of the members of a family, and its table."""
    return [series(out / name) for name in MEMBERS], (out / "family.csv").read_text()


def states(out):
    return {member["folder"]: member["state"] for member in answered(["info", out, "--json"])["members"]}


class Families(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)
        self.out = self.place / "out"

    def scene(self, text=FAMILY, steps=20):
        path = self.place / "family.toml"
        path.write_text(text.format(steps=steps))
        return path

    def whole(self, scene, *arguments):
        out = self.place / "whole"
        run(["run", scene, "--out", out, *arguments])
        return results(out)

    def test_workers_do_not_change_a_family_and_each_member_is_a_run(self):
        scene = self.scene()
        expected = self.whole(scene, "--threads", 1)
        said = run(["run", scene, "--out", self.out, "--threads", 2])
        self.assertIn("family     6 runs, 2 points; 2 at a time", said)
        self.assertTrue(results(self.out) == expected)
        self.assertEqual(states(self.out), dict.fromkeys(MEMBERS, "finished"))
        # A member is the scene with its keys set.
        alone = self.place / "alone"
        scene.write_text(SCENE.format(steps=20))
        run(["run", scene, "--out", alone, "--set", "seed=6", "--set", "species[0].volume_fraction=0.05"])
        member = self.out / MEMBERS[2]
        self.assertTrue(series(alone) == series(member))
        self.assertEqual(len({str(rows) for rows in expected[0]}), len(MEMBERS), "two members are the same run")
        run(["report", member])
        said = run(["resume", self.out])
        self.assertIn("6 finished before", said)
        self.assertTrue((self.out / "point-0002").is_dir())

    def test_a_family_that_is_killed_goes_on_to_the_same_tables(self):
        scene = self.scene(steps=60)
        expected = self.whole(scene)
        for pause in (0.0, 0.3, 0.9):
            out = self.place / f"killed-{pause}"
            process = start(["run", scene, "--out", out])
            wait_for(lambda out=out: list(out.glob("point-*/seed-*/checkpoint-*.bin")), process)
            time.sleep(pause)
            process.kill()
            process.communicate()
            said = run(["run", scene, "--out", out, "--continue"])
            self.assertIn("finished; results in", said)
            self.assertTrue(results(out) == expected, pause)

    def test_nothing_of_a_killed_family_is_left_running(self):
        process = start(["run", self.scene(steps=5000), "--out", self.out])
        wait_for(lambda: list(self.out.glob("point-*/seed-*/checkpoint-*.bin")), process)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        self.assertTrue(children)
        process.kill()
        process.communicate()
        deadline = time.monotonic() + 10
        while any(pathlib.Path(f"/proc/{child}/stat").exists() for child in children):
            self.assertLess(time.monotonic(), deadline, "runs outlive the program that started them")
            time.sleep(0.01)

    def test_signals_and_time_stop_a_family_with_checkpoints(self):
        scene = self.scene(steps=2000)
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGUSR1, 75)):
            out = self.place / number.name
            process = start(["run", scene, "--out", out, "--steps-taken", self.place / "steps"])
            wait_for(lambda out=out: list(out.glob("point-*/seed-*/checkpoint-*[1-9]?.bin")), process)
            os.kill(process.pid, number)
            said = process.communicate()[1]
            self.assertEqual(process.returncode, code, said)
            self.assertIn(f"stopped by {number.name}; go on with: fcm-solve run {scene} --out {out} --continue", said)
            self.assertGreater(int((self.place / "steps").read_text()), 0)
            self.assertIn("stopped", states(out).values())
            self.assertNotIn("running", states(out).values())
        process = start(["run", scene, "--out", self.place / "timed", "--walltime", "0:06"])
        said = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 75, said)
        self.assertIn("stopped by the end of its time", said)

    def test_parts_share_a_folder(self):
        scene = self.scene()
        expected = self.whole(scene)
        parts = [start(["run", scene, "--out", self.out, "--part", f"{part}/3"]) for part in (1, 2, 3)]
        for part in parts:
            said = part.communicate(timeout=120)[1]
            self.assertEqual(part.returncode, 0, said)
            self.assertIn("2 runs of 6 (part", said)
        self.assertTrue(results(self.out) == expected)
        self.assertIn("2 finished before", run(["run", scene, "--out", self.out, "--part", "2/3"]))
        run(["run", scene, "--out", self.out, "--part", "4/3"], expect=1)
        said = run(["run", scene, "--out", self.out, "--part", "1/3", "--force"], expect=1)
        self.assertIn("cannot be used with", said)

    def test_a_member_that_fails_does_not_end_the_others(self):
        text = SCENE + '[sweep]\n"particles.minimum_gap" = [0.0, 3.0, 0.1]\n'
        scene = self.scene(text, steps=5)
        said = run(["run", scene, "--out", self.out], expect=1)
        self.assertIn("point-0002/seed-0004 (particles.minimum_gap = 3.0) failed: can't place the spheres", said)
        self.assertIn(f"error: 1 of 3 runs failed, see {self.out}/point-0002/seed-0004/run.log; the others are finished", said)
        self.assertEqual(list(states(self.out).values()), ["finished", "failed", "finished"])
        said = run(["run", scene, "--out", self.out, "--continue"], expect=1)
        self.assertIn("2 finished before", said)
        said = run(["check", scene], expect=1)
        self.assertIn("point-0002/seed-0004 (particles.minimum_gap = 3.0): can't place the spheres", said)

    def test_ranks_are_refused(self):
        said = run(["run", self.scene(), "--out", self.out], ranks=2, expect=1)
        self.assertIn("without mpirun", said)
        self.assertFalse(self.out.exists())

    def test_a_member_that_is_killed_is_named(self):
        process = start(["run", self.scene(steps=400), "--out", self.out, "--threads", 1])
        wait_for(lambda: list(self.out.glob("point-*/seed-*/checkpoint-*.bin")), process)
        children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        os.kill(int(children[0]), signal.SIGKILL)
        said = process.communicate(timeout=120)[1]
        self.assertEqual(process.returncode, 1, said)
        self.assertIn("failed: its process was ended by signal SIGKILL", said)
        self.assertIn("finished; results in", run(["resume", self.out]))

    def test_a_folder_is_kept_unless_it_is_to_be_replaced(self):
        scene = self.scene()
        run(["run", scene, "--out", self.out])
        self.assertIn("already holds the results", run(["run", scene, "--out", self.out], expect=1))
        (self.out / MEMBERS[0] / "mine.txt").write_text("mine")
        said = run(["run", scene, "--out", self.out, "--set", "time.step=0.01", "--continue"], expect=1)
        self.assertIn("holds another family: time.step is 0.01 here and 0.02 there", said)
        said = run(["run", scene, "--out", self.out, "--set", "ensemble.seeds=1", "--force"])
        self.assertIn("family     2 runs, 2 points", said)
        self.assertFalse((self.out / MEMBERS[1] / "observables.csv").exists())
        self.assertTrue((self.out / MEMBERS[0] / "mine.txt").exists())
        said = run(["run", scene, "--out", self.out, "--continue"])
        self.assertIn("2 finished before", said)
        self.assertEqual(states(self.out), dict.fromkeys(MEMBERS, "finished"))

    def test_check_says_how_many_runs_there_are_and_how_long_they_take(self):
        scene = self.scene()
        said = run(["check", scene])
        self.assertRegex(said, r"family     6 runs: 2 points, 3 each\npoint-0001 species\[0\]\.volume_fraction = 0\.05, \d+ particles")
        self.assertRegex(said, r"time       about .* in all, \d+ runs? at a time")
        answer = answered(["check", scene, "--json"])
        self.assertEqual((answer["runs"], len(answer["points"])), (6, 2))
        self.assertGreater(answer["seconds"], 0)
        said = run(["check", self.scene(FAMILY.replace("0.05, 0.1", "0.05, 0.9"))], expect=1)
        self.assertIn("point-0002", said)
        self.assertIn("species[0].volume_fraction is 0.9", said)

    def test_converge_says_what_changes_an_answer(self):
        scene = self.scene(SCENE, steps=2)
        words = ["converge", scene, "--of", "viscosity", "--seeds", 2, "--out", self.out]
        # The series of such short runs are replaced by these below.
        subprocess.run([PROGRAM, *map(str, words)], capture_output=True, timeout=120)
        self.assertEqual(set(states(self.out).values()), {"finished"})
        for point, values in enumerate(((2.0, 2.2), (2.01, 2.22), (3.0, 3.2), (2.0, 2.2)), 1):
            for seed, value in zip((4, 5), values):
                member = self.out / f"point-{point:04}" / f"seed-{seed:04}"
                (member / "observables.h5").unlink()
                # The first half is excluded.
                (member / "observables.csv").write_text(f"step,time,relative_viscosity\n0,0,9\n1,1,{value}\n2,2,{value}\n")
        said = run(words)
        self.assertIn("left out: the stiffness: the scene has neither contacts nor repulsion", said)
        self.assertIn("8 finished before", said)
        self.assertIn("relative_viscosity, over the second half of each run\n", said)
        self.assertRegex(said, r"as it is +2\.1 \+- 0\.18  \(2 seeds; by themselves 2 meaningless\)\nhalf the step ")
        self.assertRegex(said, r"half the step +2\.115 \+- \S+  \+0\.71 \+- 0\.44 %: not seen, at most 3\.7 %\n")
        self.assertRegex(said, r"twice the edges +3\.1 \+- \S+  \+48 \+- \S+ %: matters\n")
        self.assertIn("\nmatters: twice the edges\n", said)
        answer = json.loads(subprocess.run([PROGRAM, *map(str, words), "--json"], capture_output=True, text=True).stdout)
        self.assertEqual([row["verdict"] for row in answer["runs"]], ["not seen", "not seen", "matters", "not seen"])
        said = run(["converge", scene, "--of", "colour", "--seeds", 2, "--out", self.out], expect=1)
        self.assertIn("--of colour: no answer of the runs has that name; there are relative_viscosity", said)
        # The larger box has eight times the spheres.
        larger = answered(["info", self.out, "--json"])["members"][4]["values"]
        self.assertIn("box.edges = [18.0, 18.0, 18.0]", larger)

    def test_a_run_ends_at_a_strain(self):
        scene = self.scene(SCENE.replace("steps = {steps}", "strain = 0.2").replace("rate = 1.0", "rate = 2.0"))
        run(["run", scene, "--out", self.out])
        self.assertEqual(len(series(self.out)), 6)
        driven = SCENE.replace("rate = 1.0", 'control = "stress"\nstress = 1.3').replace("tolerance", "lubrication = true\ntolerance")
        scene = self.scene(driven.replace("steps = {steps}", "strain = 0.1\nduration = 4.0"))
        out = self.place / "driven"
        said = run(["run", scene, "--out", out])
        self.assertIn("the suspension is sheared by a strain of 0.1, at which its run ends", said)
        self.assertRegex(said, r"finished after step [4-9];")
        again = run(["run", scene, "--out", out, "--continue"])
        self.assertIn("finished after step", again)
        family = self.place / "family.toml"
        family.write_text(scene.read_text() + "[ensemble]\nseeds = 2\n")
        run(["run", family, "--out", self.place / "ended"])
        self.assertEqual(set(states(self.place / "ended").values()), {"finished"})
        self.assertIn("2 finished before", run(["resume", self.place / "ended"]))

    def test_every_kind_of_scene_has_families(self):
        cases = {
            "granular-disks": ('"fluid.viscosity" = [0.01, 0.02]', {"box.edges": "[40.0, 50.0]", "time.steps": 50}, True),
            "shear-cell": ('"grains.restitution" = [0.8, 0.9]', {"time.steps": 2, "time.transient": 0.001}, True),
            "shear-cell-continuum": ('"grains.restitution" = [0.8, 0.85]', {}, False),
        }
        for kind, (sweep, sets, is_random) in cases.items():
            scene = self.place / f"{kind}.toml"
            scene.write_text(run(["new", kind]) + ("[ensemble]\nseeds = 2\n" if is_random else "") + f"[sweep]\n{sweep}\n")
            words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
            out = self.place / kind
            run(["run", scene, "--out", out, *words])
            with self.subTest(kind=kind):
                self.assertEqual(len(states(out)), 4 if is_random else 2)
                self.assertEqual(set(states(out).values()), {"finished"})
                run(["report", out])


if __name__ == "__main__":
    unittest.main()
