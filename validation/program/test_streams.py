"""Commands whose output cannot be written: the disk is full, or the reader has closed the pipe or does not read."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

from program import PATIENCE, ROOT, command, run, start

RUN = ["run", ROOT / "scenes" / "settling.toml", "--set", "box.edges=[14.0, 14.0, 14.0]", "--set", "species[0].count=30"]
RUN += ["--set", "hydrodynamics.tolerance=1e-2", "--set", "time.steps=40", "--set", "output.trajectory_every=1"]
CASE = {"box": [10, 10, 10], "viscosity": 1, "radii": 1, "positions": [[1, 2, 3]], "forces": [[0, 0, 1]]}


def closed_pipe():
    """A stream to which writing fails, since its reader has closed the pipe."""
    reading, writing = os.pipe()
    os.close(reading)
    return os.fdopen(writing, "w")


class Streams(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(place.cleanup)
        cls.place = pathlib.Path(place.name)
        (cls.place / "case.json").write_text(json.dumps(CASE))
        cls.out = cls.place / "whole"
        run([*RUN, "--out", cls.out])

    def test_a_quiet_run_logs_warnings_and_answers_only(self):
        def lines(*options):
            ended = subprocess.run(command([*RUN, *options]), capture_output=True, text=True, timeout=PATIENCE, check=True)
            return ended.stderr.splitlines()

        quiet, whole = lines("--quiet", "--out", self.place / "quiet"), lines("--out", self.place / "loud")
        self.assertTrue(any("settling" in line for line in quiet), quiet)
        self.assertTrue(set(quiet) < set(whole))
        self.assertFalse([line for line in quiet if line.startswith(("method", "step", "results", "finished"))])

    def test_an_evaluation_that_takes_long_is_named(self):
        case = self.place / "long.json"
        positions = [[2.5 * (k // 10**axis % 10) for axis in range(3)] for k in range(1000)]
        noise = {"draws": 10_000, "seed": 1}
        case.write_text(json.dumps({"box": [25, 25, 25], "viscosity": 1, "radii": 1, "positions": positions, "noise": noise}))
        process = start(["mobility", case])
        self.addCleanup(process.kill)
        self.assertEqual(process.stderr.readline(), "the case is evaluated: 4 s so far\n")
        process.kill()
        process.communicate()

    def call(self, arguments, out, err):
        return subprocess.run(command(arguments), stdout=out, stderr=err, text=True, timeout=PATIENCE)

    def commands(self):
        yield ["check", *RUN[1:]]
        yield ["info", self.out / "trajectory.h5"]
        yield ["info", "--scene", self.out / "trajectory.h5"]
        yield ["mobility", self.place / "case.json"]
        yield ["two-sphere", "--ratio", "2", "--gap", "0.1"]
        yield ["bench", "--particles", "20", "--repeats", "1", "--no-error"]
        yield ["stats", self.out]
        yield ["new", "shear"]
        yield ["completions", "bash"]
        yield ["--help"]

    def test_results_that_cannot_be_written_are_an_error_in_one_line(self):
        for arguments in self.commands():
            with self.subTest(command=arguments[0]), open("/dev/full", "w") as full:
                done = self.call(arguments, full, subprocess.PIPE)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertRegex(done.stderr, r"\Aerror: can't write .*No space left on device.*\n\Z")

    def test_results_that_nobody_reads_are_no_panic(self):
        for arguments in self.commands():
            with self.subTest(command=arguments[0]), closed_pipe() as nobody:
                done = self.call(arguments, nobody, subprocess.PIPE)
                self.assertIn(done.returncode, (0, 1) if arguments == ["--help"] else (1,), done.stderr)
                self.assertNotIn("panicked", done.stderr)

    def test_an_error_that_cannot_be_told_is_an_error(self):
        for arguments in (["check", "missing.toml"], ["new", "shear"], ["resum"]):
            with self.subTest(command=arguments[0]), open("/dev/full", "w") as full:
                self.assertIn(self.call(arguments, full, full).returncode, (1, 2))

    def test_a_run_goes_on_whatever_becomes_of_its_log(self):
        whole = (self.out / "observables.h5").stat().st_size, (self.out / "checkpoint-0000000040.bin").read_bytes()
        full, gone, waiting = open("/dev/full", "w"), closed_pipe(), full_pipe()
        for name, stream in (("full", full), ("gone", gone), ("waiting", waiting[1])):
            with self.subTest(stream=name), stream:
                out = self.place / name
                done = self.call([*RUN, "--out", out], stream, stream)
                self.assertEqual(done.returncode, 0)
                self.assertEqual((out / "observables.h5").stat().st_size, whole[0])
                self.assertEqual((out / "checkpoint-0000000040.bin").read_bytes(), whole[1])
        waiting[0].close()


def full_pipe():
    """Both ends of a full pipe, at which a writer waits for a reader."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    try:
        while True:
            os.write(writing, b"x" * 4096)
    except BlockingIOError:
        os.set_blocking(writing, True)
    return os.fdopen(reading, "r"), os.fdopen(writing, "w")


if __name__ == "__main__":
    unittest.main()
