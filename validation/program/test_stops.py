"""Runs that stop before their end: by signals, time limits, and in job scripts."""

import os
import pathlib
import shlex
import signal
import subprocess
import tempfile
import time
import unittest

import small_run
from program import PATIENCE, PROGRAM, ROOT, command, run, start
from small_run import SCENE, end_state, has_checkpoint, ranks_of, wait_for, words
from support.checkpoint import state_of

# For run.py.
HEAVY = 80

SETS = small_run.SETS | {"time.steps": 2000, "output.checkpoint_every": 100000}
# A step that takes minutes: thousands of substeps, required near contact, each with tens of evaluations.
LONG = {
    "box.edges": "[36.0, 36.0, 36.0]",
    "species[0].count": 2560,
    "hydrodynamics.lubrication": "true",
    "hydrodynamics.tolerance": 1e-3,
    "time.integrator": "adaptive",
    "time.step": 800.0,
    "time.steps": 2,
}
# A start that takes minutes.
DENSE = {"box.edges": "[150.0, 150.0, 150.0]", "species[0].count": 480000, "hydrodynamics.tolerance": 1e-2}
STOPS = {
    signal.SIGTERM: 143,
    signal.SIGINT: 130,
    signal.SIGHUP: 75,
    signal.SIGUSR1: 75,
    signal.SIGUSR2: 75,
    signal.SIGXCPU: 75,
}


class Stops(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)
        self.out = self.place / "out"

    def run_scene(self, sets, *arguments, out=None, **options):
        return run(["run", SCENE, *words(sets), "--out", out or self.out, *arguments], **options)

    def begin_scene(self, sets, *arguments, ranks=None, **options):
        process = start(["run", SCENE, *words(sets), "--out", self.out, *arguments], ranks, **options)
        self.addCleanup(process.kill)
        return process

    def has_begun(self):
        return has_checkpoint(self.out)

    def test_every_signal_stops_a_run_that_goes_on_to_the_same_bits(self):
        whole = self.place / "whole"
        self.run_scene(SETS, out=whole)
        for stop, code in STOPS.items():
            process = self.begin_scene(SETS, "--force")
            wait_for(self.has_begun, process)
            time.sleep(0.1)
            process.send_signal(stop)
            _, said = process.communicate(timeout=PATIENCE)
            with self.subTest(signal=stop.name):
                self.assertEqual(process.returncode, code, said)
                self.assertRegex(said, rf"stopped after step \d+ of 2000 by {stop.name}; go on with: fcm-solve resume {self.out}\n")
                self.run_scene(SETS, "--continue")
                self.assertEqual(end_state(self.out, 2000), end_state(whole, 2000))
            for path in self.out.glob("checkpoint-*.bin"):
                path.unlink()

    def test_a_signal_ends_a_step_that_would_take_minutes(self):
        for ranks in (None, 2):
            self.out = self.place / f"out-{ranks}"
            process = self.begin_scene(LONG, ranks=ranks)
            wait_for(self.has_begun, process)
            time.sleep(0.3)
            # One rank receives it, and all of them stop.
            os.kill((ranks_of(process) or [process.pid])[-1], signal.SIGUSR1)
            _, said = process.communicate(timeout=60)
            with self.subTest(ranks=ranks):
                self.assertEqual(process.returncode, 75, said)
                self.assertIn("stopped after step 0 of 2 by SIGUSR1", said)

    def test_what_mpirun_passes_on_stops_a_run(self):
        process = self.begin_scene(SETS | {"time.steps": 100000}, ranks=2)
        wait_for(self.has_begun, process)
        process.send_signal(signal.SIGUSR1)
        _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 75, said)
        self.assertEqual(said.count("go on with: fcm-solve resume"), 1, said)

    def test_what_is_not_yet_a_run_ends_at_once_and_says_how_it_starts(self):
        process = self.begin_scene(DENSE)
        wait_for(lambda: (self.out / ".lock").exists(), process)
        process.send_signal(signal.SIGUSR2)
        _, said = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 75, said)
        self.assertTrue(said.startswith("stopped by SIGUSR2; go on with: fcm-solve run "), said)
        again = shlex.split(said.split("go on with: ")[1])
        self.assertEqual(again[-1], "--continue")
        small = words({key: SETS[key] for key in ("box.edges", "species[0].count")} | {"time.steps": 1})
        subprocess.run([PROGRAM, *again[1:], *small], check=True, capture_output=True, timeout=PATIENCE)
        self.assertTrue(self.has_begun())

    def test_a_signal_that_is_ignored_stays_so(self):
        """As under nohup."""
        ignore = lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN)
        process = self.begin_scene(SETS, preexec_fn=ignore)
        wait_for(self.has_begun, process)
        process.send_signal(signal.SIGHUP)
        _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 0, said)

    def test_a_run_stops_in_time(self):
        long = SETS | {"time.steps": 1000000, "output.trajectory_every": 0}
        for name, options, environment in (
            ("option", ["--walltime", "0:06"], {}),
            ("slurm", [], {"SLURM_JOB_ID": "1", "SLURM_JOB_END_TIME": str(int(time.time()) + 16)}),
        ):
            began = time.time()
            end = float(environment.get("SLURM_JOB_END_TIME", began + 6))
            process = self.begin_scene(long, *options, "--force", env=os.environ | environment)
            _, said = process.communicate(timeout=PATIENCE)
            with self.subTest(by=name):
                self.assertEqual(process.returncode, 75, said)
                self.assertIn("by the end of its time; go on with", said)
                self.assertLess(time.time(), end + 0.5)
                self.assertGreater(time.time(), end - 5)
        said = self.run_scene(long, "--walltime", "0:00", "--force", expect=2)
        self.assertIn("needs to be above 0", said)

    def test_too_little_time_for_a_step_is_an_error(self):
        """Otherwise a job would be restarted endlessly. A loaded machine needs longer until the step begins."""
        for walltime in ("0:04", "0:20"):
            said = self.run_scene(LONG, "--walltime", walltime, "--force", expect=1)
            if "is over before its first step" not in said:
                break
        self.assertIn("the run's time is too short for a single step", said)
        self.assertTrue(self.has_begun())

    def test_too_little_time_for_the_start_is_an_error(self):
        """Nothing is written by then, so that a job would be restarted endlessly."""
        said = self.run_scene(DENSE, "--walltime", "0:02", "--steps-taken", self.place / "steps", expect=1)
        self.assertIn("error: the run's time is over before its first step, and nothing new is written", said)
        self.assertFalse(self.has_begun())
        self.assertEqual((self.place / "steps").read_text(), "0\n")

    def test_a_run_that_stops_tells_how_many_steps_it_took(self):
        steps = self.place / "steps"
        process = self.begin_scene(SETS, "--steps-taken", steps)
        wait_for(self.has_begun, process)
        time.sleep(0.3)
        process.send_signal(signal.SIGUSR1)
        _, said = process.communicate(timeout=PATIENCE)
        stopped = int(said.split("stopped after step ")[1].split()[0])
        self.assertEqual(int(steps.read_text()), stopped)
        steps.unlink()
        self.run_scene(SETS, "--continue", "--steps-taken", steps)
        self.assertFalse(steps.exists())

    def test_job_scripts_give_up_after_three_restarts_that_took_no_step(self):
        """With a stand-in for the program, whose numbers of steps are given in the environment, one for each start."""
        batch = ROOT / "scripts" / "batch"
        program = self.place / "program"
        program.write_text(
            "#!/bin/bash\n"
            'echo start >> "$NOTES"; count=$(wc -l < "$NOTES"); words=($STEPS); file=${@: -1}\n'
            'taken=${words[$((count - 1))]:-0}; [ "$taken" = none ] || echo "$taken" > "$file"; exit 75\n'
        )
        for name, does in (("qsub", 'echo "$VAIN" > "$NOTES.vain"'), ("scontrol", "true"), ("squeue", "echo 1:00:00")):
            (self.place / name).write_text(f"#!/bin/sh\n{does}\n")
            (self.place / name).chmod(0o755)
        program.chmod(0o755)
        base = os.environ | {"FCM_SOLVE": str(program), "LAUNCH": "env", "PBS_O_WORKDIR": str(self.place), "SCENE": "my.toml"}
        base |= {"PATH": f"{self.place}:{os.environ['PATH']}", "SLURM_JOB_ID": "7", "NOTES": str(self.place / "notes")}
        notes, vain = self.place / "notes", self.place / "notes.vain"
        for steps, starts in (("", 4), ("none none none none 5", 4), ("0 0 3 0 0 0 0 5", 7), ("1 1 0 0 0", 6)):
            for script in ("plain.sh", "pbs.sh", "slurm.sh"):
                notes.write_text("")
                vain.write_text("0")
                ended = None
                while ended is None or ended.returncode == 75:
                    environment = base | {"STEPS": steps, "VAIN": vain.read_text().strip()}
                    words = [batch / script, *([] if script == "pbs.sh" else ["my.toml"])]
                    ended = subprocess.run(words, env=environment, cwd=self.place, capture_output=True, text=True, timeout=PATIENCE)
                    self.assertLess(notes.read_text().count("start"), 20)
                with self.subTest(script=script, steps=steps):
                    self.assertEqual(ended.returncode, 1, ended)
                    self.assertIn("given up after three restarts that did not take a single step", ended.stderr)
                    self.assertEqual(notes.read_text().count("start"), starts)
                    self.assertEqual(list(self.place.glob(".fcm-solve*")), [])

    def test_one_command_starts_goes_on_and_is_done(self):
        scene = SETS | {"time.steps": 30}
        self.run_scene(scene, out=self.place / "whole")
        self.run_scene(scene | {"time.steps": 11}, "--continue")
        self.assertIn("finished after step 30", self.run_scene(scene, "--continue"))
        for name in ("trajectory.h5", "checkpoint-0000000030.bin", "observables.csv"):
            self.assertTrue((self.out / name).exists())
        files = {path: path.stat().st_mtime_ns for path in self.out.iterdir() if path.name != ".lock"}
        self.assertIn("finished already, after step 30", self.run_scene(scene, "--continue"))
        self.assertEqual(files, {path: path.stat().st_mtime_ns for path in files})
        bits = [state_of(out / "checkpoint-0000000030.bin") for out in (self.out, self.place / "whole")]
        self.assertEqual(*bits)

    def test_the_run_of_another_scene_does_not_go_on(self):
        self.run_scene(SETS | {"time.steps": 5})
        other = SETS | {"time.steps": 9, "species[0].count": 29, "seed": 7}
        said = self.run_scene(other, "--continue", expect=1)
        self.assertIn("holds the run of another scene", said)
        self.assertRegex(said, r"seed is 7 here and \w+ there, species\[0\]\.count is 29 here and 30 there; name another")
        self.assertNotIn("time.steps", said)

    def test_a_run_that_died_before_its_first_checkpoint_is_started_again(self):
        self.run_scene(SETS | {"time.steps": 3})
        for path in self.out.glob("checkpoint-*.bin"):
            path.unlink()
        said = run(["resume", self.out], expect=1)
        self.assertIn("fcm-solve run SCENE --continue", said)
        said = self.run_scene(SETS | {"time.steps": 3}, expect=1)
        self.assertIn("--continue", said)
        self.assertIn("finished after step 3", self.run_scene(SETS | {"time.steps": 3}, "--continue"))

    def test_what_has_no_steps_goes_on_too(self):
        again = ["run", ROOT / "scenes" / "shear-cell-continuum.toml", "--out", self.place / "continuum", "--continue"]
        self.assertIn("finished; results", run(again))
        self.assertIn("finished already; results", run(again))

    def test_job_scripts_go_on_until_the_run_is_finished(self):
        batch = ROOT / "scripts" / "batch"
        long = ["--out", self.out, *words(SETS | {"time.steps": 100000})]
        environment = os.environ | {"FCM_SOLVE": PROGRAM, "LAUNCH": "mpirun -n 2"}
        plain = subprocess.Popen([batch / "plain.sh", SCENE, *long], env=environment, stderr=subprocess.PIPE, text=True)
        self.addCleanup(plain.kill)
        wait_for(self.has_begun, plain)
        plain.send_signal(signal.SIGTERM)
        _, said = plain.communicate(timeout=PATIENCE)
        self.assertEqual(plain.returncode, 75, said)
        # A stand-in for PBS, which records submissions.
        queue = self.place / "qsub"
        queue.write_text(f'#!/bin/sh\necho "$@" >> {self.place}/submitted\n')
        queue.chmod(0o755)
        arguments = " ".join(str(word).replace(" ", "") for word in long)
        environment |= {"PBS_O_WORKDIR": str(ROOT), "SCENE": str(SCENE), "ARGUMENTS": arguments}
        environment |= {"PATH": f"{self.place}:{os.environ['PATH']}", "WALLTIME": "0:08"}
        done = subprocess.run([batch / "pbs.sh"], env=environment, capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, 75, done.stderr)
        self.assertEqual((self.place / "submitted").read_text(), "-V scripts/batch/pbs.sh\n")

    def test_a_step_of_slurm_without_connections_is_refused_once(self):
        def said(*arguments, **variables):
            step = {"SLURM_JOB_ID": "1", "SLURM_STEP_ID": "0", "SLURM_STEP_NUM_TASKS": "2", "SLURM_PROCID": "0"} | variables
            done = subprocess.run(command(["new", "shear", *arguments]), env=os.environ | step, capture_output=True, text=True)
            return done.returncode, done.stderr

        code, message = said()
        self.assertEqual(code, 1)
        self.assertRegex(message, r"\Aerror: .* 2 processes .* --alone .*\n\Z")
        self.assertEqual(said(SLURM_PROCID="1"), (1, ""))
        self.assertEqual(said("--alone"), (0, ""))
        # The shell of salloc, the script of sbatch, and a step of one task are one process.
        self.assertEqual(said(SLURM_STEP_ID="4294967290"), (0, ""))
        self.assertEqual(said(SLURM_STEP_ID="", SLURM_NTASKS="2"), (0, ""))
        self.assertEqual(said(SLURM_STEP_NUM_TASKS="1"), (0, ""))


if __name__ == "__main__":
    unittest.main()
