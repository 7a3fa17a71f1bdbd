"""Jobs of a test instance of Slurm: the start of ranks and threads, and a job that is requeued until its run is finished."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support.program import PROGRAM
from support.requeue import LAUNCHERS, end_state, requeued, uninterrupted
from support.slurm import Slurm, is_installed

ROOT = pathlib.Path(__file__).resolve().parents[2]
BENCH = [PROGRAM, "bench", "--particles", "20", "--repeats", "1", "--no-error"]


def ranks_and_threads(said):
    """Ranks and threads in each line of `fcm-solve bench`."""
    answers = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
    return [(answer["ranks"], answer["threads"]) for answer in answers]


@unittest.skipUnless(is_installed(), "needs slurm-wlm, munge and root")
class Jobs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(place.cleanup)
        cls.place = pathlib.Path(place.name)
        (cls.place / "slurm").mkdir()
        cls.slurm = Slurm(cls.place / "slurm")
        cls.slurm.environment["FCM_SOLVE"] = PROGRAM
        cls.addClassCleanup(cls.slurm.stop)
        cls.slurm.start()

    def in_a_job(self, *command):
        """Output of a command in a job of two tasks."""
        script, log = self.place / "job.sh", self.place / "job.log"
        script.write_text("#!/bin/sh\nexec " + " ".join(command) + "\n")
        log.unlink(missing_ok=True)
        job = self.slurm.submit("--ntasks=2", script, log=log)
        self.slurm.wait(lambda: self.slurm.state(job) in ("COMPLETED", "FAILED"), "the job does not end")
        return log.read_text()

    def test_srun_starts_one_job_of_two_ranks(self):
        said = self.slurm.call("srun", "--mpi=pmix", "--ntasks=2", *BENCH)
        self.assertEqual(ranks_and_threads(said), [(2, 1)], said)

    def test_mpirun_starts_two_ranks_within_a_job(self):
        said = self.in_a_job("mpirun", "-n", "2", *BENCH)
        self.assertEqual(ranks_and_threads(said), [(2, 1)], said)

    def test_a_script_without_a_launcher_is_one_rank_on_the_cores_of_its_job(self):
        said = self.in_a_job(*BENCH)
        self.assertEqual(ranks_and_threads(said), [(1, 2)], said)
        said = self.in_a_job("env", "SLURM_CPUS_PER_TASK=1", *BENCH)
        self.assertEqual(ranks_and_threads(said), [(1, 1)], said)

    def test_processes_that_cannot_find_each_other_are_refused_once(self):
        with self.assertRaises(AssertionError) as refused:
            self.slurm.call("srun", "--mpi=none", "--ntasks=2", *BENCH)
        said = str(refused.exception)
        self.assertEqual(said.count("error: srun started 2 processes"), 1, said)
        self.assertIn("srun --mpi=pmix", said)

    def test_runs_side_by_side_are_alone_if_they_say_so(self):
        said = self.slurm.call("srun", "--mpi=none", "--ntasks=2", *BENCH, "--alone")
        self.assertEqual(ranks_and_threads(said), [(1, 1), (1, 1)], said)

    def test_an_array_of_jobs_makes_the_parts_of_a_family(self):
        scene, out, log = self.place / "family.toml", self.place / "family", self.place / "array.log"
        text = (ROOT / "scenes" / "settling.toml").read_text()
        scene.write_text(text + '\n[ensemble]\nseeds = 2\n[sweep]\n"species[0].count" = [20, 25, 30]\n')
        sets = ["--set", "box.edges=[14.0, 14.0, 14.0]", "--set", "time.steps=5", "--set", "hydrodynamics.tolerance=1e-2"]
        arguments = [ROOT / "scripts" / "batch" / "slurm.sh", scene, "--part", "{}/2", "--out", out, *sets]
        job = self.slurm.submit("--array=1-2", "--ntasks=1", *arguments, log=log)
        self.slurm.wait(lambda: not self.slurm.call("squeue", "-h", "-j", job, check=False), "the array does not end")
        told = subprocess.run([PROGRAM, "info", out, "--json"], capture_output=True, text=True)
        self.assertEqual(told.returncode, 0, told.stderr + log.read_text())
        states = [member["state"] for member in json.loads(told.stdout)["members"]]
        self.assertEqual(states, ["finished"] * 6, log.read_text())

    def test_a_job_that_is_requeued_twice_ends_with_the_bits_of_one_that_is_not(self):
        uninterrupted(self.place / "whole")
        for launcher in LAUNCHERS:
            out = self.place / launcher
            log = requeued(self.slurm, launcher, out, times=2)
            with self.subTest(launcher=launcher):
                self.assertEqual(log.count("by SIGUSR1; go on with: fcm-solve resume"), 2, log)
                self.assertEqual(end_state(out), end_state(self.place / "whole"), log)
