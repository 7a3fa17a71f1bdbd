"""Every command on the pages runs as printed, with the output of the page, up to differences between processors."""

import pathlib
import sys
import tempfile
import unittest

from program import ROOT

sys.path.insert(0, str(ROOT / "validation"))

from support.compared import differences  # noqa: E402
from support.console import PAGES, blocks, commands, inline_commands, prepare, printed, unprinted_commands  # noqa: E402

# For run.py.
HEAVY = 330

INSTALLS = "installs or builds; `scripts/test` and `scripts/release` do that"
CLUSTER = "is for a cluster; validation/batch submits an array of jobs to a Slurm"
PACKAGE = "needs the Python package; python/tests runs it"
# Commands that no test runs from a page, with the reasons.
NOT_RUN = {
    "scripts/run": INSTALLS,
    "scripts/run scenes/settling.toml --set time.steps=10 --force": INSTALLS,
    "scripts/test": INSTALLS,
    "scripts/test --all": INSTALLS,
    "cargo run --release -- run scenes/pair-settling.toml": INSTALLS,
    "cargo build": INSTALLS,
    "cargo build --release --features mpi": INSTALLS,
    "cargo build --profile dist --features static-hdf5": INSTALLS,
    "cargo build --offline --locked --release --features mpi": INSTALLS,
    "cargo install --locked --path fcm-solve --features mpi": INSTALLS,
    "cargo vendor": INSTALLS,
    "tar -xJf fcm-solve-VERSION-source.tar.xz && cd fcm-solve-VERSION": INSTALLS,
    "curl --proto '=https' -sSf https://sh.rustup.rs | sh -s -- -y": INSTALLS,
    "pip install ./python": INSTALLS,
    "pip install --user cmake": INSTALLS,
    "pip install --user libclang": INSTALLS,
    "module load gcc openmpi hdf5 llvm cmake": CLUSTER,
    "fcm-solve run family.toml --part $SLURM_ARRAY_TASK_ID/20 --continue": CLUSTER,
    "mpirun -n 2 target/release/fcm-solve run scenes/pair-settling.toml": "names the program in the build folder; "
    "the same page runs the one in the path on two ranks",
    'export PATH="$PWD/target/release:$PATH"': "the program under test is already in the path of the tests",
    "python -m fcm_solve plot": PACKAGE,
    "python -m fcm_solve plot results/my": PACKAGE,
    "scripts/validate tutorial --full": "takes many minutes; it writes the table of the page",
    "fcm-solve converge paste.toml --of relative_viscosity": "takes many minutes; the page on families has a shorter one",
    "fcm-solve info results/family": "lists the runs of an array of jobs; the page on families runs the same command",
}


class Pages(unittest.TestCase):
    def test_commands_print_what_the_pages_say(self):
        for page in PAGES:
            text = page.read_text()
            with self.subTest(page=page.stem), tempfile.TemporaryDirectory() as place:
                folder = pathlib.Path(place)
                prepare(text, folder)
                for block in blocks(text):
                    for command, shown in commands(block):
                        self.assertEqual(differences(shown, printed(command, folder)), [], command)
                for command in inline_commands(text):
                    if command not in NOT_RUN:
                        printed(command, folder)

    def test_commands_that_are_not_run_have_a_reason(self):
        shown = {command for page in PAGES for command in unprinted_commands(page.read_text())}
        self.assertEqual(shown - set(NOT_RUN), set())
        shown |= {command for page in PAGES for command in inline_commands(page.read_text())}
        self.assertEqual(set(NOT_RUN) - shown, set())


class Compared(unittest.TestCase):
    """The comparison detects errors of a page, and accepts differences between processors."""

    def assert_same(self, shown, now):
        self.assertEqual(differences(shown.splitlines(), now.splitlines()), [])

    def assert_different(self, shown, now):
        self.assertNotEqual(differences(shown.splitlines(), now.splitlines()), [])

    def test_words_and_counts_are_compared(self):
        self.assert_same("grid       30 x 30 points in f32", "grid  30 x 30 points in f32")
        self.assert_different("grid       30 x 30 points in f32", "grid  30 x 32 points in f32")
        self.assert_different("report     results/my/report.html", "report     results/your/report.html")
        self.assert_different("report     a", "report     a\ntables     b")

    def test_estimates_agree_within_their_errors(self):
        self.assert_same("relative viscosity  1.51 +- 0.02  still drifting", "relative viscosity  1.53 +- 0.03  converged")
        self.assert_same("pressure  0.1 +- 0.1  drag", "pressure  -0.2 +- 0.1  drag")
        self.assert_different("pressure  1.5 +- 0.02", "pressure  2.5 +- 0.03")
        self.assert_different("x  (6.5 +- 0.6)e-9", "x  (6.5 +- 0.6)e-6")
        self.assert_different("pressure  0.1 +- 0.1  force", "pressure  0.1 +- 0.1  length")

    def test_durations_and_verdicts_are_not_compared(self):
        measured = "time  about 1.1 ms a step and 6.5 s for the run, by its first 9 steps"
        self.assert_same(measured, "time  about 990 microseconds a step and 7 s for the run, by its first 7 steps")
        self.assert_same("slip  -  length  too short for any value", "slip  0.1 +- 0.1  length  too short: 3.5 times longer")
        self.assert_same("run 1 of 2: b, 1 s\nrun 2 of 2: a, 2 s", "run 1 of 2: a, 1 s\nrun 2 of 2: b, 3 s")
        self.assert_different("run 1 of 2: b, 1 s\nrun 2 of 2: a, 2 s", "run 1 of 2: a, 1 s\nrun 2 of 2: c, 3 s")

    def test_sizes_agree_to_a_factor(self):
        self.assert_same("memory  about 33.0 MB at most", "memory  about 40.1 MB at most")
        self.assert_different("memory  about 33.0 MB at most", "memory  about 330.1 MB at most")


if __name__ == "__main__":
    unittest.main()
