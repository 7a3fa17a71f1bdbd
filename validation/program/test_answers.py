"""Every run ends with its answers: printed, in summary.csv, by `stats` and on the page of `report`."""

import csv
import json
import math
import pathlib
import tempfile
import unittest

from program import ROOT, answered, run

SCENES = ROOT / "scenes"
COLUMNS = ["quantity", "species", "value", "error", "samples", "transient", "verdict", "longer", "unit"]
SHEAR = [SCENES / "shear.toml", "--set", "box.edges=[10.0, 10.0, 10.0]", "--set", "hydrodynamics.tolerance=1e-2", "--set", "time.step=0.02"]
THICKENING = [SCENES / "thickening.toml", "--set", "box.edges=[8.0, 8.0, 8.0]", "--set", "time.duration=12.0"]


def summary(folder):
    with open(folder / "summary.csv", newline="") as file:
        rows = csv.DictReader(file)
        assert rows.fieldnames == COLUMNS, rows.fieldnames
        return {(row["quantity"], row["species"]): row for row in rows}


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.place.cleanup)
        cls.out = pathlib.Path(cls.place.name) / "sheared"
        cls.said = run(["run", *SHEAR, "--set", "time.steps=100", "--set", "output.trajectory_every=0", "--out", cls.out])

    def answers(self, *words):
        found = answered(["stats", *words, "--json"])["answers"]
        return {(answer["quantity"], answer["species"]): answer for answer in found}

    def test_a_run_ends_with_them(self):
        found = summary(self.out)
        self.assertIn(("relative_viscosity", "all"), found)
        for word in ("relative viscosity", "first normal stress difference", "particle pressure"):
            self.assertRegex(self.said, rf"(?m)^{word}  ")
        lines = [line for line in self.said.splitlines() if line.startswith(("relative", "first", "second", "particle pr"))]
        self.assertLess(self.said.index(lines[0]), self.said.index("finished after step 100"))
        listed = [json.loads(line) for line in (self.out / "manifest.jsonl").read_text().splitlines()]
        self.assertIn({"file": "summary.csv"}, listed)

    def test_no_number_stands_where_there_is_no_answer(self):
        for row in summary(self.out).values():
            numbers = [row["value"], row["error"]]
            self.assertEqual(row["verdict"] == "meaningless", numbers == ["", ""], row)
            self.assertEqual(row["verdict"] == "too short", row["longer"] != "", row)
            if row["value"]:
                self.assertTrue(all(math.isfinite(float(number)) for number in numbers), row)

    def test_stats_finds_them_without_a_trajectory(self):
        written, found = summary(self.out), self.answers(self.out)
        self.assertEqual(set(written), set(found))
        for name, row in written.items():
            self.assertEqual(float(row["value"] or "nan"), found[name]["value"]) if row["value"] else self.assertIsNone(found[name]["value"])
        said = run(["stats", self.out])
        self.assertIn("relative viscosity", said)
        self.assertIn("there are no statistics of motions", said)

    def test_the_range_of_times_is_a_choice(self):
        with open(self.out / "observables.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if 1.0 <= float(row["time"]) <= 1.8]
        mean = sum(float(row["relative_viscosity"]) for row in rows) / len(rows)
        name = ("relative_viscosity", "all")
        for until in ("--until", "--to"):
            found = self.answers(self.out, "--from", "1.0", until, "1.8")[name]
            self.assertAlmostEqual(found["value"] or mean, mean, places=12)
            self.assertAlmostEqual(found["transient"], 1.0)
        self.assertIsNone(self.answers(self.out, "--from", "99.0")[name]["value"])

    def test_the_table_alone_will_do(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            for name in ("scene.toml", "observables.csv"):
                (folder / name).write_bytes((self.out / name).read_bytes())
            self.assertEqual(self.answers(folder), self.answers(self.out))

    def test_a_run_that_goes_on_has_new_ones(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out"
            run(["run", *SHEAR, "--set", "time.steps=40", "--out", out])
            first = (out / "summary.csv").read_text()
            said = run(["resume", out, "--steps", "80"])
            self.assertRegex(said, r"(?m)^relative viscosity  ")
            self.assertNotEqual(first, (out / "summary.csv").read_text())
            whole = pathlib.Path(folder) / "whole"
            run(["run", *SHEAR, "--set", "time.steps=80", "--out", whole])
            self.assertEqual((whole / "summary.csv").read_text(), (out / "summary.csv").read_text())

    def test_answers_that_cannot_be_written_are_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out"
            run(["run", *SHEAR, "--set", "time.steps=40", "--out", out])
            first = (out / "summary.csv").read_text()
            (out / "summary.csv").unlink()
            (out / "summary.csv").mkdir()
            said = run(["resume", out, "--steps", "80"], expect=1)
            self.assertRegex(said, r"can't write .*summary.csv")
            self.assertNotIn("finished", said)
            (out / "summary.csv").rmdir()
            self.assertIn("finished after step 80", run(["resume", out, "--steps", "80"]))
            self.assertNotEqual(first, (out / "summary.csv").read_text())

    def test_under_a_given_stress_the_rate_is_an_answer(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out"
            run(["run", *THICKENING, "--set", "output.trajectory_every=4", "--out", out])
            found = self.answers(out)
            self.assertIn(("shear_rate", "all"), found)
            self.assertIn(("relative_viscosity", "all"), found)

    def test_the_page_of_a_run_has_them_at_its_head(self):
        run(["report", self.out])
        page = (self.out / "report.html").read_text()
        self.assertLess(page.index("<h2>Answers</h2>"), page.index('<div class="charts">'))
        self.assertIn("<td>relative viscosity</td>", page)

    def test_a_folder_without_results_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("no results of a run", run(["stats", folder], expect=1))


if __name__ == "__main__":
    unittest.main()
