"""Files of the user in the folder of results: no run replaces or removes them, with any options."""

import hashlib
import os
import pathlib
import subprocess
import tempfile
import unittest

from program import PATIENCE, ROOT, command, run

SCENE = ROOT / "scenes" / "settling.toml"
SETS = {
    "box.edges": "[10.0, 10.0, 10.0]",
    "species[0].count": 8,
    "hydrodynamics.tolerance": 1e-2,
    "time.steps": 6,
    "output.trajectory_every": 1,
    "output.checkpoint_every": 3,
    "output.fields_every": 3,
    "statistics.every": 1,
}
SMALL = [word for key, value in SETS.items() for word in ("--set", f"{key}={value}")]
STRANGERS = (
    "cases/pair.json",
    "fields/wheat.txt",
    "stats/table.csv",
    "statistics/mine.csv",
    "contacts/people.csv",
    "trajectory/route.gpx",
    "force-chains/x",
    "report.html",
    "scene.toml",
    "summary.csv",
    "manifest.jsonl",
    "checkpoint-0000000099.bin",
)


def digests(folder):
    """Digest of every file below a folder, and the target of every link."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_symlink():
            found[path] = os.readlink(path)
        elif path.is_file():
            found[path] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


class Manifest(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name).resolve()
        self.out = self.place / "out"

    def put(self, name, text="mine"):
        path = self.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def ends(self, *arguments):
        """Exit code and output of a command."""
        ended = subprocess.run(command(arguments), capture_output=True, text=True, timeout=PATIENCE, cwd=self.place)
        self.assertIn(ended.returncode, (0, 1), ended.stderr)
        self.assertNotIn("panicked", ended.stderr)
        return ended.returncode, ended.stdout + ended.stderr

    def new(self, *arguments, out=None):
        return self.ends("run", SCENE, *SMALL, "--out", out or self.out, *arguments)

    def test_files_that_no_run_has_made_are_refused_by_name(self):
        for name in STRANGERS:
            self.out = self.place / name.replace("/", "-")
            self.put(name)
            self.put("notes.txt")
            before = digests(self.place)
            for how in ([], ["--force"], ["--continue"]):
                code, said = self.new(*how)
                with self.subTest(name=name, how=how):
                    self.assertEqual(code, 1, said)
                    self.assertIn(name.split("/")[0], said)
                    self.assertEqual({path: digests(self.place).get(path) for path in before}, before)

    def test_a_folder_of_the_scene_is_judged_as_one_of_the_command_line(self):
        self.put("fields/wheat.txt")
        for folder in (self.out, "out", "elsewhere/../out"):
            (self.place / "elsewhere").mkdir(exist_ok=True)
            sets = [*SMALL, "--set", f'output.folder="{folder}"']
            for how in ([], ["--force"]):
                code, said = self.ends("run", SCENE, *sets, *how)
                self.assertEqual(code, 1, said)
                self.assertEqual((self.out / "fields/wheat.txt").read_text(), "mine")

    def test_force_removes_what_runs_and_commands_have_made_and_nothing_else(self):
        self.put("notes.txt")
        run(["run", SCENE, *SMALL, "--out", self.out])
        run(["stats", self.out])
        run(["report", self.out])
        for target in ("xyz", "gsd", "vtp"):
            run(["export", self.out, "--to", target])
        run(["export", self.out, "--to", "xyz", "--out", self.out / "some.xyz"])
        mine = [self.put(name) for name in ("fields/wheat.txt", "stats/mine.csv", "trajectory/route.gpx", "my.html")]
        code, said = self.new()
        self.assertEqual(code, 1, said)
        self.assertIn("already holds the results of a run", said)
        run(["run", SCENE, *SMALL, "--set", "output.fields_every=0", "--set", "statistics.every=0", "--out", self.out, "--force"])
        self.assertEqual([path.read_text() for path in mine], ["mine"] * 4)
        left = {str(path.relative_to(self.out)) for path in self.out.rglob("*") if path.is_file()}
        results = {"manifest.jsonl", "scene.toml", "trajectory.h5", "observables.csv", "observables.h5", ".lock"}
        results |= {"checkpoint-0000000003.bin", "checkpoint-0000000006.bin", "notes.txt", "summary.csv"}
        self.assertEqual(left, results | {str(path.relative_to(self.out)) for path in mine})
        run(["run", SCENE, *SMALL, "--out", self.out, "--force"])

    def test_what_the_user_adds_stays_whatever_comes(self):
        run(["run", SCENE, *SMALL, "--out", self.out])
        mine = [self.put(name) for name in ("checkpoint-0000000099.bin", "trajectory.h5.tmp", "report.html", "cases/a.csv")]
        before = {path: digests(self.out)[path] for path in mine}
        for arguments in (["--force"], ["--continue"], []):
            self.new(*arguments)
        for arguments in (["resume", self.out, "--steps", 12], ["report", self.out]):
            code, said = self.ends(*arguments)
            self.assertEqual(code, 0 if arguments[0] == "resume" else 1, said)
        self.assertIn("report.html", said)
        self.assertEqual({path: digests(self.out)[path] for path in mine}, before)

    def test_nothing_outside_is_removed_or_written_to(self):
        outside = self.place / "outside"
        outside.mkdir()
        for name in ("velocity-0000000003.h5", "trajectory.h5", "victim"):
            (outside / name).write_text("mine")
        run(["run", SCENE, *SMALL, "--out", self.out])
        before = digests(outside)
        manifest = self.out / "manifest.jsonl"
        whole = manifest.read_text()
        for name in ("../outside/victim", str(outside / "victim"), "fields/../../outside/victim"):
            manifest.write_text(whole + f'{{"file":"{name}"}}\n')
            for how in ([], ["--force"], ["--continue"]):
                code, said = self.new(*how)
                self.assertEqual(code, 1, said)
                self.assertIn(f"{manifest} is damaged", said)
        manifest.write_text(whole)
        for path in (self.out / "fields").iterdir():
            path.unlink()
        (self.out / "fields").rmdir()
        (self.out / "fields").symlink_to(outside)
        for how in (["--force"], ["--set", "time.steps=9", "--continue"]):
            code, said = self.new(*how)
            self.assertEqual(code, 1, said)
            self.assertIn("fields", said)
        self.assertEqual(digests(outside), before)

    def test_links_of_temporary_names_are_not_followed(self):
        victim = self.place / "victim"
        victim.write_text("mine")
        self.out.mkdir()
        names = ("scene.toml", "trajectory.h5", "observables.h5", "observables.csv", "checkpoint-0000000000.bin", "manifest.jsonl")
        for name in names:
            (self.out / f"{name}.tmp").symlink_to(victim)
        run(["run", SCENE, *SMALL, "--out", self.out])
        (self.place / "answer.json.tmp").symlink_to(victim)
        self.assertEqual(victim.read_text(), "mine")
        self.assertTrue(all((self.out / f"{name}.tmp").is_symlink() for name in names))

    def test_results_of_a_version_without_manifests_are_gone_on_with(self):
        run(["run", SCENE, *SMALL, "--out", self.out])
        run(["report", self.out])
        run(["stats", self.out])
        (self.out / "manifest.jsonl").unlink()
        run(["report", self.out])
        run(["stats", self.out])
        code, said = self.new("--force")
        self.assertEqual(code, 1, said)
        self.assertIn("older version", said)
        self.assertIn("move or delete the folder by hand", said)
        self.assertFalse((self.out / "manifest.jsonl").exists())
        run(["run", SCENE, *SMALL, "--set", "time.steps=9", "--out", self.out, "--continue"])
        run(["report", self.out])
        run(["stats", self.out])
        run(["run", SCENE, *SMALL, "--out", self.out, "--force"])

    def test_a_run_without_its_scene_is_kept(self):
        run(["run", SCENE, *SMALL, "--out", self.out])
        (self.out / "scene.toml").unlink()
        before = digests(self.out)
        for how in ([], ["--continue"]):
            code, said = self.new(*how)
            self.assertEqual(code, 1, said)
            self.assertIn("scene.toml is gone", said)
            self.assertEqual(digests(self.out), before)

    def test_every_kind_of_scene_replaces_its_results(self):
        kinds = {
            "disk-sweep": {"box.edges": "[30.0, 30.0]", "time.strain": 1.0, "output.observables_every": 100},
            "shear-cell-continuum": {"cell.speeds": "[1.4, 2.0]", "output.points": 11},
        }
        for kind, sets in kinds.items():
            words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
            scene, out = ROOT / "scenes" / f"{kind}.toml", self.place / kind
            run(["run", scene, *words, "--out", out])
            names = set(digests(out))
            self.assertIn("already holds", run(["run", scene, *words, "--out", out], expect=1))
            self.assertRegex(run(["run", scene, *words, "--out", out, "--continue"]), "finished already|4 finished before")
            run(["report", out])
            run(["run", scene, *words, "--out", out, "--force"])
            self.assertEqual(set(digests(out)), names)
            run(["resume", out])


if __name__ == "__main__":
    unittest.main()
