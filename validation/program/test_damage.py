"""Files of a run that are truncated or altered afterwards: damage is named, and the run continues if possible."""

import csv
import pathlib
import random
import shutil
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

from program import PATIENCE, ROOT, answered, command, run

SETS = {
    "box.edges": "[10.0, 10.0, 10.0]",
    "species[0].count": 8,
    "hydrodynamics.tolerance": 1e-2,
    "time.steps": 6,
    "output.trajectory_every": 1,
    "output.checkpoint_every": 3,
}


def flip(path, place, bit=0):
    content = bytearray(path.read_bytes())
    content[place] ^= 1 << bit
    path.write_bytes(content)


def place_of(path, dataset, frame):
    """Position of the middle number of a frame in a file."""
    with h5py.File(path) as file:
        number = file[dataset][frame].reshape(-1)[12].tobytes()
    return path.read_bytes().index(number)


def lags(out):
    """Time and mean square displacement along z of the first species."""
    with open(out / "stats" / "lags.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return [(float(row["time"]), float(row["displacement_z"])) for row in rows if row["species"] == rows[0]["species"]]


def without_frames(file, path, frames):
    """A copy of a trajectory without some frames."""
    with h5py.File(path, "w") as copy:
        for name in file:
            file.copy(name, copy)
        groups = [f"particles/all/{name}" for name in ("position", "image", "velocity", "angular_velocity", "stresslet")]
        groups += ["particles/all/box/edges", "particles/all/box/strain"]
        for name in ["parameters/checksums", *(f"{group}/{part}" for group in groups for part in ("value", "step", "time"))]:
            values, attributes = copy[name][()], dict(copy[name].attrs)
            del copy[name]
            copy[name] = np.delete(values, frames, axis=0)
            copy[name].attrs.update(attributes)


class Damage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.place.cleanup)
        cls.whole = pathlib.Path(cls.place.name) / "whole"
        cls.words = [word for key, value in SETS.items() for word in ("--set", f"{key}={value}")]
        run(["run", ROOT / "scenes" / "settling.toml", "--out", cls.whole, *cls.words])

    def setUp(self):
        self.out = self.whole.with_name("out")
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.copytree(self.whole, self.out)
        self.trajectory = self.out / "trajectory.h5"

    def ends(self, *arguments):
        """Exit code and output of a command that may fail, but only with a message."""
        ended = subprocess.run(command(arguments), capture_output=True, text=True, timeout=PATIENCE)
        self.assertIn(ended.returncode, (0, 1), ended.stderr)
        self.assertNotIn("panicked", ended.stderr)
        return ended.returncode, ended.stdout + ended.stderr

    def test_a_damaged_frame_is_named_and_the_run_goes_on_without_it(self):
        flip(self.trajectory, place_of(self.trajectory, "particles/all/position/value", 2))
        named = "frame 2 does not fit its checksums: particles/all/position"
        code, said = self.ends("info", self.trajectory)
        self.assertEqual(code, 1)
        self.assertIn(f"{self.trajectory} is damaged: {named};", said)
        code, said = self.ends("stats", self.out)
        self.assertEqual(code, 0, said)
        self.assertIn(f"{named}; restore it from a copy, or move it away; the statistics are without this frame", said)
        code, said = self.ends("resume", self.out, "--steps", 8)
        self.assertEqual(code, 0, said)
        self.assertIn(f"warning: trajectory.h5 is damaged: {named}; the run goes on without it", said)
        with h5py.File(self.trajectory) as file:
            self.assertEqual(file["particles/all/position/step"][:].tolist(), list(range(9)))

    def test_statistics_are_of_the_times_of_the_frames_that_are_there(self):
        """The mean square displacement at a lag does not depend on which frames are damaged or missing."""
        sets = ["--set", "time.steps=40", "--set", "output.trajectory_every=2"]
        whole = self.out.with_name("of-stats")
        run(["run", ROOT / "scenes" / "settling.toml", "--out", whole, *self.words, *sets, "--force"])
        run(["stats", whole])
        expected = lags(whole)
        trajectory = whole / "trajectory.h5"
        for frame in (3, 4, 9, 15):
            flip(trajectory, place_of(trajectory, "particles/all/position/value", frame))
        told = answered(["stats", whole, "--json"])
        self.assertEqual(told["frames"], {"missing": 0, "damaged": 4})
        found = lags(whole)
        # Lags are means of differences of times, whose last digits depend on the frames.
        self.assertEqual([round(time, 12) for time, _ in found], [round(time, 12) for time, _ in expected])
        for (_, square), (_, right) in zip(found[1:8], expected[1:8]):
            self.assertLess(abs(square / right - 1), 0.2)

    def test_frames_that_are_missing_are_named_by_stats(self):
        with h5py.File(self.trajectory, "r+") as file:
            copied = self.out / "copied.h5"
            without_frames(file, copied, [2, 3])
        copied.replace(self.trajectory)
        code, said = self.ends("stats", self.out)
        self.assertEqual(code, 0, said)
        self.assertIn(f"{self.trajectory}: 2 frames that the run was to write are missing, of steps 2 to 3", said)

    def test_a_cut_or_altered_time_series_is_mended(self):
        table = self.out / "observables.csv"
        whole = table.read_text()
        for damaged in (whole[:-9], whole[: len(whole) // 2], whole.replace("0.05", "0.06"), ""):
            table.write_text(damaged)
            run(["resume", self.out])
            self.assertEqual(table.read_text(), whole)

    def test_files_cut_at_any_length_are_refused_by_name(self):
        whole = self.trajectory.read_bytes()
        for cut in [0, 1, 8, 48, 100, *range(4000, len(whole), len(whole) // 12), len(whole) - 1]:
            self.trajectory.write_bytes(whole[:cut])
            for arguments in (["info", self.trajectory], ["resume", self.out, "--steps", 8]):
                code, said = self.ends(*arguments)
                self.assertEqual(code, 1, f"{cut}: {said}")
                self.assertRegex(said, f"error: .*{self.trajectory}")

    def test_flipped_bits_are_seen_or_harmless(self):
        random.seed(3)
        seen = 0
        for path in (self.trajectory, self.out / "observables.h5"):
            whole = path.read_bytes()
            for _ in range(40):
                flip(path, random.randrange(len(whole)), random.randrange(8))
                code, said = self.ends("info", path)
                seen += code
                if code:
                    self.assertIn(str(path), said)
                path.write_bytes(whole)
        self.assertGreater(seen, 0)

    def test_texts_that_crash_the_hdf5_library_are_an_error(self):
        """HDF5 copies as many bytes of a text of variable length as the file says."""
        content = bytearray(self.trajectory.read_bytes())
        # The version of the program, with its length before it in the heap of texts.
        text = content.index(b"fcm-solve ", content.index(b"GCOL"))
        content[text - 8 : text] = (1 << 28).to_bytes(8, "little")
        self.trajectory.write_bytes(content)
        for arguments in (["info", self.trajectory], ["export", self.out, "--to", "vtp"], ["stats", self.out], ["resume", self.out, "--steps", 8]):
            code, said = self.ends(*arguments)
            self.assertTrue(code == 0 or "trajectory.h5" in said, said)

    def test_of_damaged_checkpoints_the_one_before_serves(self):
        random.seed(4)
        last = max(self.out.glob("checkpoint-*.bin"))
        whole = last.read_bytes()
        for _ in range(8):
            flip(last, random.randrange(len(whole)), random.randrange(8))
            said = run(["resume", self.out])
            self.assertIn(f"warning: {last} is damaged", said)
            self.assertEqual(last.read_bytes(), whole)
        for checkpoint in self.out.glob("checkpoint-*.bin"):
            checkpoint.write_bytes(checkpoint.read_bytes()[:-1])
        code, said = self.ends("resume", self.out)
        self.assertEqual(code, 1)
        self.assertIn(f"{last} is damaged", said)
