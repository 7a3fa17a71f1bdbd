"""Times fcm-solve with each set of vector instructions in alternation, and writes a page of the documentation."""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile
from statistics import median

from benchmark import DOCS, FRACTION, PARTICLES, REPEATS, processor

SETS = {"AVX-512": None, "AVX2": "avx2", "portable": "portable"}
STEP = """
box.edges = [30.0, 30.0, 30.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 1.0, lees_edwards = true }
hydrodynamics = { tolerance = 1e-2, lubrication = true }
time = { step = 0.005, steps = 20 }
[[species]]
radius = 1.0
count = 1290
"""


class Case:
    """One computation, by the program or by the same C program for two processors."""

    def __init__(self, label, command, seconds):
        self.label, self.command, self.seconds = label, [str(word) for word in command], seconds
        self.times = {}

    def run(self, name, limit):
        """Adds the time with a set of instructions."""
        limits = {} if limit is None else {"FCM_SOLVE_VECTORS": limit}
        environment = {**os.environ, "OMP_NUM_THREADS": "1", **limits}
        ended = subprocess.run(self.command, env=environment, capture_output=True, text=True, check=True)
        self.times.setdefault(name, []).append(self.seconds(json.loads(ended.stdout)))

    def row(self):
        """Milliseconds with each set, and the ratio to the first."""
        first = next(iter(self.times.values()))
        cells = [f"{1e3 * median(times):.3g}" for times in self.times.values()]
        others = list(self.times.values())[1:]
        cells += [f"{median(b / a for a, b in zip(first, times)):.2f}" for times in others]
        return f"| {self.label} | {' | '.join(cells)} |"


def cases(program, folder):
    scene = folder / "scene.toml"
    scene.write_text(STEP)
    mobility = ["bench", "--threads", "1", "--no-error", "--repeats", REPEATS]
    total = lambda line: line["seconds"]["total"]  # noqa: E731
    for tolerance in ("1e-3", "1e-6"):
        words = [*mobility, "--tolerance", tolerance, "--particles", PARTICLES, "--volume-fraction", FRACTION]
        yield Case(f"mobility of {PARTICLES:,} spheres, {tolerance}", [program, *words], total)
    words = [*mobility, "--tolerance", "1e-3", "--particles", 100_000, "--volume-fraction", FRACTION]
    yield Case("mobility of 100,000 spheres, 1e-3", [program, *words], total)
    step = ["bench", "--step", scene, "--threads", "1", "--repeats", REPEATS]
    yield Case("step of 1,290 lubricated spheres at 20%, 1e-2", [program, *step], lambda line: line["step"]["seconds"])


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark --processors", description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="fcm-solve")
    parser.add_argument("--rounds", type=int, default=5, help="number of rounds [5]")
    arguments = parser.parse_args()
    if "avx512" not in pathlib.Path("/proc/cpuinfo").read_text():
        raise SystemExit("this processor has no AVX-512, so there is nothing to compare with")
    with tempfile.TemporaryDirectory() as folder:
        chosen = list(cases(arguments.program, pathlib.Path(folder)))
        for _ in range(arguments.rounds):
            for case in chosen:
                for name, limit in SETS.items():
                    case.run(name, limit)
    rows = [
        "| one thread | " + " | ".join(f"{name}, ms" for name in SETS) + " | AVX2 over AVX-512 | portable over AVX-512 |",
        "|---" * (3 + len(SETS)) + "|",
        *(case.row() for case in chosen),
    ]
    print(*rows, sep="\n")
    page = DOCS / "processors.md"
    text = page.read_text()
    begin, end = (text.index(mark) for mark in ("<!-- times -->", "<!-- end of times -->"))
    about = f"On {processor()}, medians of {arguments.rounds} rounds, in which the sets alternated:"
    page.write_text(text[:begin] + "\n".join(["<!-- times -->", about, "", *rows, ""]) + "\n" + text[end:])


if __name__ == "__main__":
    main()
