"""Digests of the results of every scene that the program provides, at the small sizes of the tests, on one rank.

`--beside PROGRAM` compares them with those of another build: a change that keeps all bits keeps all digests. Times are
excluded. Digests depend on the processor's vector instructions, so both builds have to run on the same machine."""

import argparse
import hashlib
import pathlib
import subprocess
import sys
import tempfile

import h5py

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "program"))
from support.page import table
from support.program import PROGRAM, ROOT
from test_scenes import SMALLER

# Results that are compared, in HDF5 and as text, and the column that holds a time.
FILES, TABLES, TIME = ("trajectory.h5", "observables.h5"), ("averages.csv", "profile.csv"), "seconds_per_step"


def digest(folder):
    """Digest of all values in a folder of results, in the order of names."""
    found = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.name in FILES:
            with h5py.File(path) as file:
                file.visititems(lambda name, item: add(found, name, item))
        if path.name in TABLES:
            found.update(path.read_bytes())
    return found.hexdigest()[:16]


def add(found, name, item):
    is_value = isinstance(item, h5py.Dataset) and name.startswith(("particles/", "observables/"))
    if is_value and TIME not in name:
        found.update(name.encode() + item[()].tobytes())


def run(program, scene):
    """The digest of a scene's results by a program, or its error message."""
    sets = [word for key, value in SMALLER.get(scene.stem, {}).items() for word in ("--set", f"{key}={value}")]
    with tempfile.TemporaryDirectory() as place:
        out = pathlib.Path(place) / "out"
        ended = subprocess.run([program, "run", scene, "--out", out, "--quiet", *sets], capture_output=True, text=True)
        return digest(out) if ended.returncode == 0 else ended.stderr.strip().splitlines()[-1]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--beside", metavar="PROGRAM", help="another build")
    parser.add_argument("--full", action="store_true")
    programs = [PROGRAM] + ([beside] if (beside := parser.parse_args().beside) else [])
    rows, differ = [], 0
    for scene in sorted((ROOT / "scenes").glob("*.toml")):
        found = [run(program, scene) for program in programs]
        is_same = len(set(found)) == 1
        differ += not is_same
        rows.append([scene.stem, *found] + (["same" if is_same else "DIFFERENT"] if len(programs) > 1 else []))
    print("\n".join(table(["scene", "digest"] + (["beside", ""] if len(programs) > 1 else []), rows)))
    if differ:
        raise SystemExit(f"{differ} of {len(rows)} scenes have other results")


if __name__ == "__main__":
    main()
