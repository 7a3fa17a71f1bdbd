"""Tests of a crate in a copy of the sources: fast ones first, each with a time limit."""

import collections
import json
import math
import os
import shutil
import signal
import subprocess
import tomllib
import xml.etree.ElementTree

# The first failure ends the run, and the fastest tests come first. The folder of the report is set explicitly, since
# nextest's default depends on its version.
PROFILE = """
[store]
dir = '{}'
[profile.mutants]
fail-fast = {{ max-fail = 1, terminate = "immediate" }}
slow-timeout = {{ period = "600s" }}
junit.path = "junit.xml"
"""
OVERRIDE = """
[[profile.mutants.overrides]]
filter = 'test(={})'
priority = {}
slow-timeout = {{ period = "{}s", terminate-after = 1 }}
"""

# Limits in seconds of a build, and of all tests together.
LONGEST = 3600

# A test hangs if it exceeds this multiple of its usual time, and this number of seconds.
HUNG, SECONDS = 8, 60


def priority(seconds):
    """Priority of a test by its duration, from 100 (first) to -100 (last): slower tests come later."""
    return max(-100, min(100, -round(20 * math.log10(max(seconds, 1e-3) / 0.1)) - 1))


def outermost(span):
    """Position of the outermost macro call that contains an error, or of the error itself."""
    return outermost(span["expansion"]["span"]) if span["expansion"] else span


class CrateTests:
    """The tests of a crate in a tree of sources, built into a folder."""

    def __init__(self, crate, tree, build):
        self.crate, self.tree, self.build_folder = crate, tree, build
        # The tests that reach each function with changes.
        self.reaching = collections.defaultdict(list)

    @property
    def package(self):
        """The name of the package of the crate."""
        return tomllib.loads((self.tree / self.crate / "Cargo.toml").read_text())["package"]["name"]

    def stages(self):
        """Arguments that choose tests: those inside the crate, then its integration tests, which need another build."""
        inside = ["--lib"] if (self.tree / self.crate / "src" / "lib.rs").exists() else ["--bins"]
        beside = [["--test", "*"]] if (self.tree / self.crate / "tests").exists() else []
        return [inside, *beside]

    def measure(self):
        """Runs the tests of the unchanged crate, records their times and puts the fast ones first."""
        store = self.build_folder / "nextest"
        report, reached = (store / "mutants" / name for name in ("junit.xml", "reached"))
        shutil.rmtree(reached, ignore_errors=True)
        reached.mkdir(parents=True)
        profile = self.tree / ".config" / "nextest.toml"
        always = PROFILE.format(store)
        profile.write_text(always)
        overrides = []
        for stage in self.stages():
            report.unlink(missing_ok=True)
            if (outcome := self.built_and_tested(stage, MUTATIONS_REACHED=str(reached))) != "missed":
                raise SystemExit(f"the tests of {self.crate} don't pass even unchanged ({outcome})")
            for case in xml.etree.ElementTree.parse(report).iter("testcase"):
                name, seconds = case.get("name"), float(case.get("time"))
                overrides.append(OVERRIDE.format(name, priority(seconds), round(max(SECONDS, HUNG * seconds))))
        profile.write_text(always + "".join(overrides))
        for note in reached.iterdir():
            function, test = note.name.split(" ", 1)
            self.reaching[int(function)].append(test)

    def verdict(self, of_stage):
        """The first outcome of the stages other than `missed`."""
        return next((outcome for outcome in map(of_stage, self.stages()) if outcome != "missed"), "missed")

    def built_and_tested(self, stage, **more):
        built = self.run([*self.nextest(stage), "--no-run"])
        if built != 0:
            return "unviable" if built else "timed out"
        return self.outcome(self.nextest(stage), **more)

    def tested(self, stage, number, function):
        """Outcome of the tests of a stage that reach a function, run with one of its planted changes."""
        names = self.reaching[function]
        if not names:
            return "missed"
        those = " + ".join(f"test(={name})" for name in names)
        return self.outcome([*self.nextest(stage), "-E", those, "--no-tests", "pass"], MUTATION=str(number))

    def outcome(self, command, **more):
        return {0: "missed", None: "timed out"}.get(self.run(command, **more), "detected")

    def errors(self):
        """The files and lines of compiler errors."""
        command = ["cargo", "test", "--no-run", "--message-format", "json", "--package", self.package, *self.stages()[0]]
        done = subprocess.run(command, cwd=self.tree, env=self.environment, capture_output=True, text=True)
        messages = (json.loads(line).get("message") for line in done.stdout.splitlines() if line.startswith("{"))
        errors = [one for one in messages if isinstance(one, dict) and one.get("level") == "error"]
        spans = [outermost(span) for one in errors for span in one["spans"] if span["is_primary"]]
        found = [(span["file_name"], span["line_start"]) for span in spans]
        return found if found or done.returncode == 0 else [(None, 0)]

    def nextest(self, stage):
        return ["cargo", "nextest", "run", "--cargo-quiet", "--profile", "mutants", "--package", self.package, *stage]

    @property
    def environment(self):
        settings = {"CARGO_TARGET_DIR": str(self.build_folder), "CARGO_PROFILE_TEST_DEBUG": "0", "INSTA_UPDATE": "no"}
        return os.environ | settings

    def run(self, command, **more):
        """The exit code of a command, or None if it was terminated."""
        with open(self.build_folder.parent / "log", "w") as log:
            started = {"cwd": self.tree, "env": self.environment | more, "stdout": log, "stderr": log}
            process = subprocess.Popen(command, **started, start_new_session=True)
            try:
                return process.wait(LONGEST)
            except subprocess.TimeoutExpired:
                return None
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
