"""The public test suites of libMobility and JFSD, run with this program's Python package, as far as they apply.

    LIBMOBILITY=CHECKOUT JFSD=CHECKOUT scripts/validate peers [--full]

Either may be omitted; `PEERS_PYTHON` names a Python with fcm_solve, scipy and pytest if that of the scripts lacks them. The tests are
unchanged; modules with the names that they import replace the original programs. `--full` also runs tests that take hours."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from support.page import table, write_section

HERE = pathlib.Path(__file__).resolve().parent / "peers"
FULL = "--full" in sys.argv[1:]
PYTHON = os.environ.get("PEERS_PYTHON", sys.executable)
# Remarks above the table of a suite.
NOTES = {
    "JFSD": [
        "The tests compare one step with reference values, computed in single precision with an error of 1e-3, to 5e-4. Three",
        "equal spheres, 10 radii apart at the corners of an equilateral triangle, fall at speeds that differ by 1.6e-3 in JFSD",
        "and by 2e-4 here. At gaps below a radius two approximations differ, Stokesian dynamics and the force-coupling method",
        "with lubrication.",
        "",
    ]
}
# pytest without the folder in which it starts, since that contains the original program.
START = "import sys; sys.path.pop(0); import pytest; sys.exit(pytest.main(sys.argv[1:]))"
# The variable that names the checkout, the modules that replace the program, the folder in which tests start, and the tests.
SUITES = {
    "libMobility": ("LIBMOBILITY", "libmobility", "tests", ["."]),
    "JFSD": ("JFSD", "jfsd", ".", ["tests/test_class_cpu.py"]),
}


def checkout(name):
    """The folder of a checkout, if one is named."""
    variable, _, start, _ = SUITES[name]
    named = os.environ.get(variable)
    if named and not (pathlib.Path(named) / start).is_dir():
        raise SystemExit(f"error: {variable} is {named}, which is not a checkout of {name}")
    return named and pathlib.Path(named).resolve()


def outcomes(name, folder):
    """The outcomes of each test of a suite, and its failures."""
    _, modules, start, tests = SUITES[name]
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / "outcomes.json"
        settings = {"PYTHONPATH": os.pathsep.join([str(HERE / modules), str(HERE), os.environ.get("PYTHONPATH", "")]),
                    "PEERS_OUTCOMES": str(path), "PEERS_FULL": str(int(FULL)), "PYTHONDONTWRITEBYTECODE": "1"}
        words = [PYTHON, "-c", START, "-q", "--no-header", "-p", "outcomes", "-p", "no:cacheprovider", *tests]
        done = subprocess.run(words, cwd=folder / start, env={**os.environ, **settings}, capture_output=True, text=True)
        if not path.exists() or done.returncode not in (0, 1):
            raise SystemExit(f"error: the tests of {name} did not run\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        failures = re.findall(r"^(?:FAILED|ERROR) .*$", done.stdout, re.M)
        return json.loads(path.read_text()), failures


def commit(folder):
    """The commit of a checkout, in short."""
    done = subprocess.run(["git", "-C", folder, "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return done.stdout.strip() or "unknown"


def rows(counts):
    """A row for each test: the numbers of its cases that pass, fail and do not apply, with the reasons."""
    for test, found in sorted(counts.items()):
        reasons = [(count, key.removeprefix("skipped: ")) for key, count in found.items() if key.startswith("skipped: ")]
        why = "; ".join(f"{count}: {short(reason)}" for count, reason in sorted(reasons, key=lambda pair: -pair[0]))
        numbers = [found.get("passed", 0), found.get("failed", 0), sum(count for count, _ in reasons)]
        yield [test.replace("::", ", "), *(str(number) if number else "" for number in numbers), why]


def short(reason):
    """A reason in a cell of a table."""
    return " ".join(reason.split()).replace("|", "/")[:160]


def main():
    named = {name: folder for name in SUITES if (folder := checkout(name))}
    if not named:
        raise SystemExit(f"error: no checkout is named; set {' or '.join(entry[0] for entry in SUITES.values())}")
    lines = []
    for name, folder in named.items():
        counts, failures = outcomes(name, folder)
        listed = list(rows(counts))
        total = [sum(int(row[place] or 0) for row in listed) for place in (1, 2, 3)]
        numbers = f"{total[0]} pass, {total[1]} fail, and {total[2]} do not apply or are skipped"
        lines += [f"Of the tests of {name} (commit {commit(folder)}) {numbers}.", "", *NOTES.get(name, [])]
        lines += [*table(["test", "pass", "fail", "skipped", "reason"], listed), ""]
        print("\n".join(failures), file=sys.stderr)
    print("\n".join(lines))
    command = " ".join([*(f"{SUITES[name][0]}=…" for name in named), "scripts/validate peers", *sys.argv[1:]])
    write_section("peers.md", "peers", "Test suites of other programs", lines, command)


if __name__ == "__main__":
    main()
