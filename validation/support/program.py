"""One call of fcm-solve from a script."""

import contextlib
import csv
import json
import math
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = os.environ.get("FCM_SOLVE", str(TARGET / "release" / "fcm-solve"))


def plain(value):
    """The value as JSON can represent it: arrays as lists."""
    return value.tolist() if hasattr(value, "tolist") else value


def mobility(case, tolerance):
    """The answer of `fcm-solve mobility` to a case, whose values may be arrays."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "case.json"
        path.write_text(json.dumps({key: plain(value) for key, value in case.items()}))
        command = [PROGRAM, "mobility", str(path), "--tolerance", str(tolerance), "--threads", "1"]
        return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def two_sphere(ratio, gap, *options):
    """The exact two-sphere functions, by name; at a wall for an infinite ratio."""
    second = ["--wall"] if math.isinf(ratio) else ["--ratio", repr(ratio)]
    command = [PROGRAM, "two-sphere", *second, "--gap", repr(gap), "--json", *options]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def run(scene, folder, overrides=()):
    """Runs a scene, given as text, into a folder; returns the finished process with its returncode."""
    path = pathlib.Path(folder).with_suffix(".toml")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(scene)
    command = [PROGRAM, "run", str(path), "--out", str(folder), "--force", "--threads", "1"]
    for override in overrides:
        command += ["--set", override]
    return subprocess.run(command, capture_output=True, text=True)


@contextlib.contextmanager
def results(scene, overrides=()):
    """Context with the results folder of a scene's run; the script ends if the run fails."""
    with tempfile.TemporaryDirectory() as place:
        out = pathlib.Path(place) / "out"
        ended = run(scene, out, overrides)
        if ended.returncode:
            raise SystemExit(ended.stderr)
        yield out


def rows_of(path):
    """The rows of a table, by the names of its columns."""
    with open(path) as file:
        return list(csv.DictReader(file))


def series(scene, overrides=()):
    """The rows of the time series of a scene's run, numbers by the names of their columns."""
    with results(scene, overrides) as out:
        return [{name: float(value) for name, value in row.items()} for row in rows_of(out / "observables.csv")]
