"""However a run on several ranks ends, it ends on all of them, and its results can be continued."""

import os
import pathlib
import random
import signal
import tempfile
import time
import unittest

from program import PATIENCE, run, start
from small_run import SCENE, SETS, end_state, has_checkpoint, ranks_of, wait_for, words

STEPS = 400
SMALL = words(SETS | {"time.steps": STEPS, "output.checkpoint_every": 20})
TRIES = 20


class Ends(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.out = pathlib.Path(self.place.name) / "out"

    def test_a_bad_scene_is_refused_once_on_every_rank(self):
        bad = pathlib.Path(self.place.name) / "bad.toml"
        bad.write_text(SCENE.read_text().replace("viscosity", "viscsity"))
        said = run(["run", bad, "--out", self.out], ranks=3, expect=1)
        self.assertEqual(said.count("error: "), 1, said)
        self.assertIn("viscosity", said)
        self.assertFalse(self.out.exists())

    def test_a_missing_case_is_refused_once_on_every_rank(self):
        said = run(["mobility", "missing.json"], ranks=3, expect=1)
        self.assertEqual(said.count("error: "), 1, said)

    def test_a_rank_that_dies_ends_the_run_on_all(self):
        process = start(["run", SCENE, "--out", self.out, *SMALL, "--set", "time.steps=100000"], ranks=3)
        wait_for(lambda: has_checkpoint(self.out), process)
        ranks = ranks_of(process)
        self.assertEqual(len(ranks), 3)
        os.kill(ranks[1], signal.SIGKILL)
        process.communicate(timeout=PATIENCE)
        self.assertNotEqual(process.returncode, 0)
        run(["info", self.out / "trajectory.h5"])

    def test_a_request_to_stop_leaves_a_checkpoint_to_go_on_from(self):
        process = start(["run", SCENE, "--out", self.out, *SMALL, "--set", "time.steps=100000"], ranks=2)
        wait_for(lambda: has_checkpoint(self.out), process)
        for rank in ranks_of(process):
            os.kill(rank, signal.SIGTERM)
        _, said = process.communicate(timeout=PATIENCE)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn(f"go on with: fcm-solve resume {self.out}", said)

    def test_a_killed_run_goes_on_to_the_same_end(self):
        """Twenty times, at random moments, most on one rank, some on two."""
        random.seed(1)
        whole, seconds = {}, {}
        for ranks in (None, 2):
            out = self.out.with_name(f"whole-{ranks}")
            began = time.monotonic()
            run(["run", SCENE, "--out", out, *SMALL], ranks)
            whole[ranks], seconds[ranks] = end_state(out, STEPS), time.monotonic() - began
        for attempt in range(TRIES):
            ranks = 2 if attempt % 4 == 0 else None
            out = self.out.with_name(f"killed-{attempt}")
            process = start(["run", SCENE, "--out", out, *SMALL], ranks)
            wait_for(lambda out=out: has_checkpoint(out), process)
            time.sleep(random.uniform(0, 0.8 * seconds[ranks]))
            for victim in ranks_of(process) or [process.pid]:
                kill(victim)
            process.communicate(timeout=PATIENCE)
            run(["resume", out], ranks)
            self.assertEqual(end_state(out, STEPS), whole[ranks], f"attempt {attempt}")


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass  # It ended before.
