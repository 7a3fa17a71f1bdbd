"""Tests of the program with a change made to it, in a copy of its sources."""

import math
import os
import shutil
import signal
import subprocess
import time
import xml.etree.ElementTree

# A test's first failure ends the run, and the fastest tests come first.
PROFILE = """
[profile.mutants]
fail-fast = { max-fail = 1, terminate = "immediate" }
slow-timeout = { period = "30s", terminate-after = 6 }
junit.path = "junit.xml"
"""

# Seconds that a build may take, and tests at least.
BUILD, TESTS = 1200, 60

# Tests that take so many times as long as they should have hung.
HUNG = 8


class Copy:
    """The sources beside the project, and what is known of their tests."""

    def __init__(self, root, folder):
        self.root, self.tree, self.build = root, folder / "tree", folder / "build"
        # Seconds of each test, by crate; empty for a crate whose tests were not yet run unchanged.
        self.seconds = {}
        self.synchronise()

    def synchronise(self):
        """Brings the copy up to date; what has not changed keeps its time, so that it is not built again."""
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=self.root, check=True, capture_output=True, text=True).stdout.split("\0")
        for name in filter(None, names):
            source, copy = self.root / name, self.tree / name
            if source.is_file() and not (copy.is_file() and copy.read_bytes() == source.read_bytes()):
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, copy)
        (self.tree / ".config" / "nextest.toml").write_text(PROFILE)

    def measure(self, crate):
        """Runs a crate's tests unchanged, notes how long each takes and puts the fast ones first."""
        report = self.build / "nextest" / "mutants" / "junit.xml"
        self.seconds[crate] = {}
        for arguments in self.stages(crate):
            report.unlink(missing_ok=True)
            outcome = self.nextest(crate, arguments)
            if outcome != "missed":
                raise SystemExit(f"the tests of {crate} don't pass even unchanged ({outcome})")
            if report.exists():
                cases = xml.etree.ElementTree.parse(report).iter("testcase")
                self.seconds[crate] |= {case.get("name"): float(case.get("time")) for case in cases}
        slow = {name: seconds for all in self.seconds.values() for name, seconds in all.items() if seconds > 0.1}
        rank = lambda seconds: max(-100, -round(20 * math.log10(seconds / 0.1)) - 1)
        override = "[[profile.mutants.overrides]]\nfilter = 'test(={})'\npriority = {}\n"
        overrides = [override.format(name, rank(seconds)) for name, seconds in slow.items()]
        (self.tree / ".config" / "nextest.toml").write_text(PROFILE + "\n" + "\n".join(overrides))

    def stages(self, crate):
        """Arguments that choose a crate's tests: those inside it, then those beside it, which cost a build of their own."""
        inside = ["--lib"] if (self.tree / crate / "src" / "lib.rs").exists() else ["--bins"]
        beside = [["--test", "*"]] if (self.tree / crate / "tests").exists() else []
        return [inside, *beside]

    def outcome(self, mutation):
        """What the tests make of a change: noticed, missed, unviable (it does not compile) or timed out."""
        if mutation.crate not in self.seconds:
            self.measure(mutation.crate)
        path = self.tree / mutation.file
        source = path.read_text()
        path.write_text(mutation.apply(source))
        try:
            outcomes = (self.nextest(mutation.crate, arguments) for arguments in self.stages(mutation.crate))
            return next((outcome for outcome in outcomes if outcome != "missed"), "missed")
        finally:
            path.write_text(source)

    def nextest(self, crate, arguments):
        command = ["cargo", "nextest", "run", "--cargo-quiet", "--profile", "mutants", "--package", crate, *arguments]
        built = self.run([*command, "--no-run"], BUILD)
        if built != 0:
            return "unviable" if built else "timed out"
        patience = max(TESTS, HUNG * sum(self.seconds.get(crate, {}).values())) if self.seconds.get(crate) else BUILD
        return {0: "missed", None: "timed out"}.get(self.run(command, patience), "noticed")

    def run(self, command, patience):
        """The exit code of a command, or none if it had to be ended."""
        settings = {"CARGO_TARGET_DIR": str(self.build), "CARGO_PROFILE_TEST_DEBUG": "0", "INSTA_UPDATE": "no"}
        started = time.monotonic()
        with open(self.build.parent / "log", "w") as log:
            process = subprocess.Popen(
                command, cwd=self.tree, env=os.environ | settings, stdout=log, stderr=log, start_new_session=True
            )
            try:
                return process.wait(patience - (time.monotonic() - started))
            except subprocess.TimeoutExpired:
                return None
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
