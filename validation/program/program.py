"""The program under test, started on any number of ranks."""

import json
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = os.environ.get("FCM_SOLVE", str(TARGET / "release" / "fcm-solve"))

# Seconds after which a command hangs. Ranks that wait for each other spin, so beside other tests they take several times
# as long as alone.
PATIENCE = 300


def command(arguments, ranks=None):
    """The command line on a number of ranks, or without a launcher."""
    launcher = [] if ranks is None else ["mpirun", "-n", str(ranks)]
    return [*launcher, PROGRAM, *map(str, arguments)]


def ended(arguments, ranks, expect):
    """The program at its end."""
    done = subprocess.run(command(arguments, ranks), capture_output=True, text=True, timeout=PATIENCE)
    succeeded = done.returncode == 0
    if succeeded != (expect == 0):
        raise AssertionError(f"{' '.join(command(arguments, ranks))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done


def run(arguments, ranks=None, expect=0):
    """Runs the program to its end and returns its output, with errors."""
    done = ended(arguments, ranks, expect)
    return done.stdout + done.stderr


def answered(arguments, ranks=None):
    """The JSON that the program prints, whatever else it notes."""
    return json.loads(ended(arguments, ranks, expect=0).stdout)


def start(arguments, ranks=None, **options):
    """Starts the program in a new process group, and returns without waiting for it."""
    pipe = subprocess.PIPE
    return subprocess.Popen(command(arguments, ranks), stdout=pipe, stderr=pipe, text=True, start_new_session=True, **options)


def mobility(case, folder, ranks=None, tolerance=1e-3):
    """Evaluates a case, given as a dictionary, and returns the answer as a dictionary."""
    path, answer = pathlib.Path(folder) / "case.json", pathlib.Path(folder) / "answer.json"
    path.write_text(json.dumps(case))
    run(["mobility", path, "--out", answer, "--tolerance", tolerance], ranks)
    return json.loads(answer.read_text())
