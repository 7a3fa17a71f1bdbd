"""Runs on restricted systems: limits of files, stack and memory, no syncs, no standard output, and files that are moved
away during the run."""

import errno
import json
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile
import time
import unittest

import h5py

from program import PATIENCE, ROOT, command, run, start
from small_run import wait_for

SCENE = ROOT / "scenes" / "settling.toml"
SETS = {
    "box.edges": "[10.0, 10.0, 10.0]",
    "species[0].count": 8,
    "hydrodynamics.tolerance": 1e-2,
    "time.steps": 6,
    "output.trajectory_every": 1,
    "output.checkpoint_every": 3,
}
SMALL = [word for key, value in SETS.items() for word in ("--set", f"{key}={value}")]
LONG = [*SMALL, "--set", "time.steps=5000", "--set", "output.checkpoint_every=100", "--threads", "1"]
CASE = {"box": [10, 10, 10], "viscosity": 1, "radii": 1, "positions": [[1, 2, 3]], "forces": [[0, 0, 1]]}


def limited(kind, bytes_):
    """Sets a limit, for `preexec_fn`."""
    return lambda: resource.setrlimit(kind, (bytes_, bytes_))


class Limits(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name).resolve()
        self.out = self.place / "out"

    def ends(self, *arguments, **options):
        """Exit code and output of a command that may fail, but only with a message."""
        options = {"capture_output": True, **options}
        ended = subprocess.run(command(arguments), text=True, timeout=PATIENCE, **options)
        said = (ended.stdout or "") + (ended.stderr or "")
        self.assertIn(ended.returncode, (0, 1), said)
        self.assertNotIn("panicked", said)
        return ended.returncode, said

    def test_a_file_that_becomes_too_long_is_named(self):
        limit = limited(resource.RLIMIT_FSIZE, 200_000)
        code, said = self.ends("run", SCENE, *LONG, "--out", self.out, preexec_fn=limit)
        self.assertEqual(code, 1, said)
        self.assertRegex(said.lower(), rf"error: can't write {self.out}/\S+: file too large")

    def test_a_small_stack_is_enough(self):
        for kilobytes in (64, 128, 1024):
            limit = limited(resource.RLIMIT_STACK, kilobytes << 10)
            code, said = self.ends("run", SCENE, *SMALL, "--out", self.place / str(kilobytes), preexec_fn=limit)
            self.assertEqual(code, 0, said)

    def test_a_scene_that_is_too_long_is_refused_before_it_is_read(self):
        scene = self.place / "long.toml"
        for length, said_ in ((30_000_000, "is longer than 32 MB"), (8_000_000, "too little memory to read them")):
            scene.write_text(SCENE.read_text() + "\n[extra]\nx = [" + "1," * length + "]\n")
            code, said = self.ends("check", scene, preexec_fn=limited(resource.RLIMIT_AS, 1_000_000_000))
            self.assertEqual(code, 1, said)
            self.assertIn(f"error: {scene} ", said)
            self.assertIn(said_, said)

    def test_results_for_a_closed_output_are_an_error(self):
        case = self.place / "case.json"
        case.write_text(json.dumps(CASE))
        run(["run", SCENE, *SMALL, "--out", self.out])
        for arguments in (["mobility", case], ["check", SCENE], ["stats", self.out], ["new", "shear"], ["--help"]):
            close = lambda: os.close(1)
            code, said = self.ends(*arguments, preexec_fn=close, capture_output=False, stderr=subprocess.PIPE)
            with self.subTest(command=arguments[0]):
                self.assertEqual(code, 1, said)
                self.assertIn("closed", said)
        code, said = self.ends("mobility", case, capture_output=False, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.assertEqual(code, 0, said)

    def failing(self, fault):
        """The environment of a program in which calls fail, or are listed."""
        library = self.place / "fail.so"
        source = ROOT / "validation" / "faults" / "fail.c"
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
        return os.environ | {"LD_PRELOAD": str(library)} | {name: str(value) for name, value in fault.items()}

    def test_answers_that_cannot_be_read_are_an_error(self):
        words = ["run", SCENE, *SMALL, "--set", "statistics.every=1", "--out", self.out]
        log = self.place / "log"
        opened = {"FAULT_FOLDER": self.out / "statistics", "FAULT_CALL": "open", "FAULT_LOG": log}
        self.assertEqual(self.ends(*words, env=self.failing(opened))[0], 0)
        last = sum(line.startswith("open") for line in log.read_text().splitlines())
        expected = (self.out / "summary.csv").read_text()
        shutil.rmtree(self.out)
        code, said = self.ends(*words, env=self.failing(opened | {"FAULT_AT": last, "FAULT_ERROR": errno.ENOSPC}))
        self.assertEqual(code, 1, said)
        self.assertIn(f"can't read {self.out / 'statistics' / 'summary.csv'}", said)
        self.assertNotIn("finished", said)
        code, said = self.ends(*words, "--continue")
        self.assertEqual((code, (self.out / "summary.csv").read_text()), (0, expected), said)

    def test_file_systems_that_cannot_sync_end_no_run(self):
        for error in (errno.EINVAL, errno.EBADF, errno.ENOSYS, errno.ENOTSUP, errno.EIO):
            fault = {"FAULT_FOLDER": self.place, "FAULT_CALL": "sync", "FAULT_HOW": "always", "FAULT_ERROR": error}
            code, said = self.ends("run", SCENE, *SMALL, "--out", self.place / str(error), env=self.failing(fault))
            with self.subTest(error=errno.errorcode[error]):
                self.assertEqual(code, int(error == errno.EIO), said)

    def test_files_that_are_moved_away_or_replaced_end_the_run_at_the_next_write(self):
        aside = self.place / "aside"
        ways = {
            "removed": lambda path: path.unlink(),
            "renamed": lambda path: path.rename(aside),
            "replaced": lambda path: (shutil.copy(path, aside), aside.rename(path)),
            "cut": lambda path: os.truncate(path, 100),
        }
        for name in ("trajectory.h5", "observables.h5", "observables.csv"):
            for way, do in ways.items():
                shutil.rmtree(self.out, ignore_errors=True)
                process = start(["run", SCENE, *LONG, "--out", self.out])
                self.addCleanup(process.kill)
                wait_for(lambda: (self.out / "checkpoint-0000000000.bin").exists(), process)
                time.sleep(0.05)
                do(self.out / name)
                _, said = process.communicate(timeout=PATIENCE)
                with self.subTest(name=name, way=way):
                    self.assertEqual(process.returncode, 1, said)
                    self.assertRegex(said, rf"error: {self.out / name} was ({way}|removed or renamed)")
                    self.assertNotIn("panicked", said)

    def test_a_scene_that_is_gone_is_an_error_at_the_next_checkpoint(self):
        process = start(["run", SCENE, *LONG, "--out", self.out])
        self.addCleanup(process.kill)
        wait_for(lambda: (self.out / "checkpoint-0000000000.bin").exists(), process)
        (self.out / "scene.toml").unlink()
        _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 1, said)
        self.assertIn(f"{self.out / 'scene.toml'} was removed", said)

    def test_numbers_that_are_stored_in_other_files_are_not_read(self):
        secret = self.place / "secret"
        secret.write_bytes(b"\1\2\3\4\5\6\7\x40" * 9)
        path = self.place / "positions.h5"
        with h5py.File(path, "w") as file:
            file.create_dataset("positions", (3, 3), "f8", external=[(str(secret), 0, 72)])
        scene = self.place / "scene.toml"
        starts = 'initial = "random"\nminimum_gap = 0.02'
        self.assertIn(starts, SCENE.read_text())
        scene.write_text(SCENE.read_text().replace(starts, f'initial = "file"\npath = "{path}"', 1))
        code, said = self.ends("run", scene, "--out", self.out)
        self.assertEqual(code, 1, said)
        self.assertIn(f"`positions` is stored in another file, `{secret}`", said)
        case = self.place / "case.h5"
        with h5py.File(case, "w") as file:
            file["box"], file["viscosity"], file["radii"] = [20.0, 20.0, 20.0], 1.0, 1.0
            file["forces"] = [[0.0, 0.0, 1.0]] * 3
            file["positions"] = h5py.ExternalLink(str(path), "positions")
        code, said = self.ends("mobility", case)
        self.assertEqual(code, 1, said)
        self.assertIn("`positions` is a link to another file", said)


if __name__ == "__main__":
    unittest.main()
