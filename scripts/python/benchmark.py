"""Runs fcm-solve bench and the C peer in alternation, and writes the benchmark page of the documentation."""

import argparse
import json
import os
import pathlib
import platform
import subprocess

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "src"
PARTICLES, FRACTION = 3200, 0.1212
REPEATS = 5

# Grid and support of the peer: what a user who knows the method would try.
PEER = [(96, 8), (96, 10), (112, 10), (128, 10), (128, 12), (128, 16), (144, 14)]
PAPER = (128, 12)
TOLERANCES = ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-8"]


class Case:
    """One command, with the ranks and threads that it runs on."""

    def __init__(self, label, command, ranks=1, threads=1):
        launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
        self.label, self.command = label, launcher + command
        self.environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
        self.lines = []

    def run(self):
        ended = subprocess.run(self.command, env=self.environment, capture_output=True, text=True)
        if ended.returncode:
            raise SystemExit(f"{' '.join(self.command)} failed:\n{ended.stderr}")
        self.lines.append({"label": self.label, **json.loads(ended.stdout)})

    def median(self):
        """The line with the median of the total time."""
        return sorted(self.lines, key=lambda line: line["seconds"]["total"])[len(self.lines) // 2]


def cases(target, quick):
    def ours(label, tolerance, method, grid=None, ranks=1, threads=1):
        command = [str(target / "release" / "fcm-solve"), "bench", "--particles", str(PARTICLES)]
        command += ["--volume-fraction", str(FRACTION), "--tolerance", tolerance, "--method", method]
        command += ["--threads", str(threads), "--repeats", str(REPEATS)]
        return Case(label, command + (["--grid", str(grid)] if grid else []), ranks, threads)

    def peer(grid, support, threads=1):
        command = [str(target / "peers" / "fcm_direct"), str(PARTICLES), str(FRACTION), str(grid), str(support)]
        return Case("C and FFTW", [*command, str(REPEATS)], threads=threads)

    # The first case is the paper's: its grid, and an error of 1e-3.
    yield peer(*PAPER)
    yield ours("direct, 128^3", "1e-3", "direct", grid=128)
    yield ours("auto", "1e-3", "auto")
    if quick:
        return
    yield peer(*PAPER, threads=2)
    yield ours("direct, 128^3", "1e-3", "direct", grid=128, threads=2)
    yield ours("auto", "1e-3", "auto", threads=2)
    yield ours("direct, 128^3", "1e-3", "direct", grid=128, ranks=2)
    yield ours("auto", "1e-3", "auto", ranks=2)
    for grid, support in PEER:
        if (grid, support) != PAPER:
            yield peer(grid, support)
    for tolerance in TOLERANCES:
        yield ours("direct", tolerance, "direct")
        if tolerance != "1e-3":
            yield ours("auto", tolerance, "auto")


def table(lines):
    stages = ("spread", "fft", "solve", "interpolate", "near", "total")
    rows = [
        "| program | method | precision | grid | support | ranks | threads | " + " | ".join(stages) + " | error |",
        "|" + "---|" * (8 + len(stages)),
    ]
    for line in lines:
        cells = [line["label"], line["method"], line["precision"], "x".join(map(str, line["grid"])), line["support"]]
        cells += [line["ranks"], line["threads"], *(f"{1e3 * line['seconds'][stage]:.1f}" for stage in stages)]
        rows.append("| " + " | ".join(map(str, [*cells, f"{line['error']:.1e}"])) + " |")
    return rows


def draw(lines, path):
    figure, axes = plt.subplots(figsize=(6.5, 4.2), layout="constrained")
    marks = {"C and FFTW": "s", "direct": "o", "auto": "^"}
    colours = {"C and FFTW": "0.4", "direct": "C0", "auto": "C3"}
    named = set()
    for line in lines:
        if line["ranks"] * line["threads"] == 1:
            label = line["label"].split(",")[0]
            name = label if label == "C and FFTW" else f"fcm-solve, {label}"
            axes.loglog(
                line["error"], 1e3 * line["seconds"]["total"], marks[label], color=colours[label],
                label=None if name in named else name,
            )
            named.add(name)
    axes.set_xlabel("relative error")
    axes.set_ylabel("milliseconds a mobility, one thread")
    axes.legend()
    plt.rcParams["svg.hashsalt"] = "benchmarks"
    figure.savefig(path, metadata={"Date": None})


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def write_page(lines, rounds):
    page = [
        "# Benchmarks",
        "",
        "Written by `scripts/benchmark`; do not edit.",
        "",
        f"One mobility, forces, torques and stresslets to velocities, angular velocities and rates of strain, of {PARTICLES}",
        f"unit spheres at a volume fraction of {FRACTION}, on {processor()} with {os.cpu_count()} cores. Milliseconds, by",
        f"stage: medians of {REPEATS} evaluations in a process and of {rounds} rounds, in which the programs took turns. The C",
        "program is `scripts/peers/fcm_direct.c`, the direct method on FFTW; it takes a couplet of nine numbers to a velocity",
        "gradient of nine. The error is the relative 2-norm against a much tighter evaluation by the same program.",
        "",
        *table(lines),
        "",
        "![Error and time](figures/benchmarks.svg)",
    ]
    (DOCS / "benchmarks.md").write_text("\n".join(page) + "\n")


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark", description=__doc__)
    parser.add_argument("--target", type=pathlib.Path, required=True, help="where the programs were built")
    parser.add_argument("--rounds", type=int, default=3, help="how often everything is run [3]")
    parser.add_argument("--quick", action="store_true", help="the paper's case on one thread alone, and no page")
    arguments = parser.parse_args()
    chosen = list(cases(arguments.target, arguments.quick))
    raw = arguments.target / "benchmarks.jsonl"
    with open(raw, "w") as file:
        for _ in range(arguments.rounds):
            for case in chosen:
                case.run()
                print(json.dumps(case.lines[-1]), file=file, flush=True)
    lines = [case.median() for case in chosen]
    print("\n".join(table(lines)))
    if not arguments.quick:
        write_page(lines, arguments.rounds)
        draw(lines, DOCS / "figures" / "benchmarks.svg")
    print(f"all lines  {raw}")


if __name__ == "__main__":
    main()
