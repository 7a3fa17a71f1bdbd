"""The program built with MPICH and with Open MPI: each under its launcher, the other's and Slurm's."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support.program import PROGRAM, ROOT
from support.slurm import Slurm, is_installed

# Built by scripts/mpich.
WITH_MPICH = os.environ["FCM_SOLVE_MPICH"]
BENCH = ["bench", "--particles", "20", "--repeats", "1", "--no-error"]
SETS = {"box.edges": "[12.0, 12.0, 12.0]", "species[0].count": 20, "time.steps": 4, "hydrodynamics.tolerance": 1e-2}
WORDS = [word for key, value in SETS.items() for word in ("--set", f"{key}={value}")]
PATIENCE = 120


def two_ranks(launcher, program, *arguments):
    """Exit code, output and errors of a program on two ranks."""
    command = [launcher, "-n", "2", program, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    return done.returncode, done.stdout, done.stderr


def ranks(said):
    """Ranks in each line of `fcm-solve bench`."""
    return [json.loads(line)["ranks"] for line in said.splitlines() if line.startswith("{")]


class Launchers(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)

    def run_scene(self, launcher, program):
        """Runs a scene on two ranks; returns the bits of its final state."""
        out = self.place / launcher
        code, _, said = two_ranks(launcher, program, "run", ROOT / "scenes" / "settling.toml", *WORDS, "--out", out)
        self.assertEqual(code, 0, said)
        self.assertEqual(said.count("finished after step 4"), 1, said)
        return (out / "checkpoint-0000000004.bin").read_bytes()

    def test_a_run_has_the_same_bits_with_either_library(self):
        self.assertEqual(self.run_scene("mpiexec.mpich", WITH_MPICH), self.run_scene("mpirun", PROGRAM))

    def test_the_launcher_of_another_library_is_refused_once(self):
        for launcher, program in (("mpiexec.mpich", PROGRAM), ("mpirun", WITH_MPICH)):
            code, answers, said = two_ranks(launcher, program, *BENCH)
            with self.subTest(launcher=launcher):
                self.assertEqual((code, answers), (1, ""), said)
                self.assertEqual(said.count("error: the launcher started 2 processes, but the MPI library sees 1"), 1, said)

    @unittest.skipUnless(is_installed(), "needs slurm-wlm, munge and root")
    def test_srun_starts_one_job_of_two_ranks(self):
        slurm = Slurm(self.place)
        self.addCleanup(slurm.stop)
        slurm.start()
        step = lambda mpi, program: ("srun", f"--mpi={mpi}", "--ntasks=2", program, *BENCH)
        said = slurm.call(*step("pmi2", WITH_MPICH))
        self.assertEqual(ranks(said), [2], said)
        # A library without PMI2, such as Debian's Open MPI, ends the program itself.
        for mpi, program, reason in (
            ("none", WITH_MPICH, "error: srun started 2 processes that can't find each other"),
            ("pmix", WITH_MPICH, "error: the launcher started 2 processes, but the MPI library sees 1"),
            ("pmi2", PROGRAM, "srun: error: "),
        ):
            with self.subTest(mpi=mpi), self.assertRaises(AssertionError) as refused:
                slurm.call(*step(mpi, program))
            self.assertEqual(str(refused.exception).count(reason), 1, refused.exception)


if __name__ == "__main__":
    unittest.main()
