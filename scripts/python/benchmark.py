"""Runs fcm-solve bench and its peers in alternation, and writes the benchmark page of the documentation."""

import argparse
import json
import math
import os
import pathlib
import platform
import subprocess
from statistics import median

import matplotlib
import parts

matplotlib.use("Agg")
import matplotlib.pyplot as plt

TOP = pathlib.Path(__file__).resolve().parents[2]
DOCS = TOP / "docs" / "src"
PARTICLES, FRACTION = 3200, 0.1212
REPEATS = 7

# Grid and support of the direct peer, as a user who knows the method would choose them.
PAPER = (128, 12)
DIRECT_PEER = [(96, 8), (112, 10), (128, 16), (144, 18), (160, 22)]
FINUFFT_TOLERANCES = ["1e-2", "1e-3"]
TOLERANCES = ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10"]
SIZES = [100, 1000, 10_000, 100_000, 1_000_000]
C, FINUFFT = "C and FFTW", "FINUFFT"
# The tables for which ratios are given.
FIRST, SHARED = "The paper's case", "100,000 spheres on two threads, on two ranks"


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
        self.lines.append({"label": self.label, "key": self.key(), **json.loads(ended.stdout)})

    def key(self):
        """Identification of the case, independent of the folder of the programs."""
        arguments = [argument for argument in self.command if not argument.startswith("/")]
        return " ".join([self.label, *arguments, self.environment["OMP_NUM_THREADS"]])

    def totals(self):
        """The total time of each round."""
        return [line["seconds"]["total"] for line in self.lines]

    def median(self):
        """The line with the median of the total time."""
        return sorted(self.lines, key=lambda line: line["seconds"]["total"])[len(self.lines) // 2]


class Programs:
    """Commands of the programs that were built below a folder."""

    def __init__(self, target):
        self.ours, self.direct = target / "release" / "fcm-solve", target / "peers" / "fcm_direct"
        self.python = target / "peers" / "python" / "bin" / "python"

    def solve(self, label, tolerance="1e-3", ranks=1, threads=1, **options):
        options = {"particles": PARTICLES, "volume-fraction": FRACTION, "repeats": REPEATS} | options
        command = [str(self.ours), "bench", "--tolerance", tolerance, "--threads", str(threads)]
        for name, value in options.items():
            command += [f"--{name}"] if value is True else [f"--{name}", str(value)]
        return Case(label, command, ranks, threads)

    def peer(self, grid, support, threads=1):
        command = [str(self.direct), str(PARTICLES), str(FRACTION), str(grid), str(support), str(REPEATS)]
        return Case(C, command, threads=threads)

    def finufft(self, tolerance):
        script = str(TOP / "scripts" / "peers" / "finufft_mobility.py")
        return Case(FINUFFT, [str(self.python), script, str(PARTICLES), str(FRACTION), tolerance, str(REPEATS)])


def sections(programs, quick):
    """Titles of tables, and their cases. The first table is the paper's case: its grid, and an error of 1e-3."""
    solve, peer = programs.solve, programs.peer
    yield FIRST, [
        peer(*PAPER),
        solve("direct, 128^3", method="direct", grid=128),
        solve("auto"),
        solve("auto, 2e-3", "2e-3"),
        *([programs.finufft("1e-3")] if programs.python.exists() else []),
    ]
    if quick:
        return
    yield "Two threads, two ranks", [
        peer(*PAPER, threads=2),
        solve("direct, 128^3", method="direct", grid=128, threads=2),
        solve("direct, 128^3", method="direct", grid=128, ranks=2),
        solve("auto", threads=2),
        solve("auto", ranks=2),
    ]
    many = {"particles": 100_000, "no-error": True}
    yield SHARED, [
        solve("one thread", **many),
        solve("two threads", threads=2, **many),
        solve("two ranks", ranks=2, **many),
    ]
    yield "Error, one thread", [
        *(peer(*case) for case in DIRECT_PEER),
        *(programs.finufft(t) for t in FINUFFT_TOLERANCES if t != "1e-3" and programs.python.exists()),
        *(solve("direct", t, method="direct") for t in TOLERANCES[::2]),
        *(solve("auto", t) for t in TOLERANCES if t != "1e-3"),
    ]
    yield "Scenes with fewer features, one thread", [
        solve("everything, sizes 1 and 1.2", **{"size-ratio": 1.2}),
        solve("one size"),
        solve("stresslets alone", stresslets=True),
        solve("forces alone", monopoles=True),
        solve("everything, 2%", **{"volume-fraction": 0.02}),
        solve("forces alone, 1e-6", "1e-6", monopoles=True),
    ]
    yield "Volume fraction and size ratio, one thread", [
        solve(f"auto, {100 * fraction:g}%, 1:{ratio}", **{"volume-fraction": fraction, "size-ratio": ratio})
        for fraction in (0.01, 0.1, 0.4)
        for ratio in (1, 2, 4)
    ]


def sizes(programs):
    """Two threads, from a hundred spheres to a million, once each."""
    few = {"repeats": 3, "no-error": True}
    return [programs.solve("auto", threads=2, particles=n, **({} if n < 1e5 else few)) for n in SIZES]


def table(lines):
    stages = ("spread", "fft", "solve", "interpolate", "near", "total")
    rows = [
        "| program | method | precision | grid | support | ranks | threads | " + " | ".join(stages) + " | error |",
        "|" + "---|" * (8 + len(stages)),
    ]
    for line in lines:
        cells = [line["label"], line["method"], line["precision"], "x".join(map(str, line["grid"])), line["support"]]
        cells += [line["ranks"], line["threads"], *(f"{1e3 * line['seconds'][stage]:.1f}" for stage in stages)]
        error = f"{line['error']:.1e}" if "error" in line else ""
        rows.append("| " + " | ".join(map(str, [*cells, error])) + " |")
    return rows


def verdicts(cases):
    """Ratios of the times of the programs for the paper's case: medians and ranges over the rounds."""
    ours = next(case for case in cases if case.label == "auto").totals()
    for case in cases:
        if case.label != "auto":
            ratios = [theirs / own for theirs, own in zip(case.totals(), ours)]
            spread = f" ({min(ratios):.1f} to {max(ratios):.1f} in {len(ratios)} rounds)"
            yield f"- {case.label}: {median(ratios):.1f} times as long as `auto`{spread}."


def speedups(lines):
    """Speedups on several threads."""
    alone, *others = [line["seconds"]["total"] for line in lines]
    for line, seconds in zip(lines[1:], others):
        yield f"- {line['label']}: {alone / seconds:.2f} times as fast as one thread."


def size_table(lines):
    rows = ["| spheres | grid | milliseconds | microseconds per sphere | order |", "|---|---|---|---|---|"]
    for before, line in zip([None, *lines], lines):
        total, count = line["seconds"]["total"], line["particles"]
        order = ""
        if before:
            growth = math.log(total / before["seconds"]["total"]) / math.log(count / before["particles"])
            order = f"{growth:.2f}"
        rows.append(f"| {count} | {line['grid'][0]}^3 | {1e3 * total:.1f} | {1e6 * total / count:.2f} | {order} |")
    return rows


def draw(lines, path):
    figure, axes = plt.subplots(figsize=(6.5, 4.2), layout="constrained")
    marks = {C: "s", FINUFFT: "D", "direct": "o", "auto": "^"}
    colours = {C: "0.4", FINUFFT: "C1", "direct": "C0", "auto": "C3"}
    for kind in marks:
        own = [line for line in lines if line["label"].split(",")[0] == kind and line["ranks"] * line["threads"] == 1]
        own = sorted((line["error"], 1e3 * line["seconds"]["total"]) for line in own)
        if own:
            label = kind if kind in (C, FINUFFT) else f"fcm-solve, {kind}"
            axes.loglog(*zip(*own), marks[kind] + "-", color=colours[kind], label=label)
    axes.set_xlabel("relative error")
    axes.set_ylabel("milliseconds per mobility, one thread")
    axes.legend()
    save(figure, path)


def draw_sizes(lines, path):
    figure, axes = plt.subplots(figsize=(6.5, 3.6), layout="constrained")
    counts = [line["particles"] for line in lines]
    axes.loglog(counts, [line["seconds"]["total"] for line in lines], "^-", color="C3", label="fcm-solve, two threads")
    first = lines[1]["seconds"]["total"] / lines[1]["particles"]
    axes.loglog(counts, [first * n for n in counts], ":", color="0.5", label="proportional")
    axes.set_xlabel("spheres")
    axes.set_ylabel("seconds per mobility, error 1e-3")
    axes.legend()
    save(figure, path)


def save(figure, path):
    plt.rcParams["svg.hashsalt"] = "benchmarks"
    figure.savefig(path, metadata={"Date": None})


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def write_page(tables, ratios, by_size, rest, rounds):
    page = [
        "# Benchmarks",
        "",
        "Written by `scripts/benchmark`; do not edit.",
        "",
        "One evaluation of the mobility, from forces, torques and stresslets to velocities, angular velocities and rates of",
        f"strain, of {PARTICLES} unit spheres at a volume fraction of {FRACTION} unless a table states otherwise, on {processor()} with",
        f"{os.cpu_count()} cores. Milliseconds by stage: medians of {REPEATS} evaluations in a process, rounds: {rounds}, in",
        "which the programs alternated. *C and FFTW* is `scripts/peers/fcm_direct.c`, the direct method; *FINUFFT* is",
        "`scripts/peers/finufft_mobility.py`, non-uniform transforms of the same envelopes, whose spread and interpolation",
        "include their transforms. Both map a force dipole of nine numbers to a velocity gradient of nine. The error is the",
        "relative 2-norm of the difference from a much more accurate evaluation by the same program.",
        "",
    ]
    for title, lines in tables.items():
        page += [f"## {title}", "", *table(lines), ""]
        if title == FIRST:
            page += [*ratios, "", "![Error and time](figures/benchmarks.svg)", ""]
        if title == SHARED:
            page += [*speedups(lines), ""]
    page += ["## Number of spheres, two threads", "", *size_table(by_size), ""]
    page += ["![Number of spheres and time](figures/benchmark-sizes.svg)", "", *rest]
    (DOCS / "benchmarks.md").write_text("\n".join(page).rstrip() + "\n")


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark", description=__doc__)
    parser.add_argument("--target", type=pathlib.Path, required=True, help="folder in which the programs were built")
    parser.add_argument("--rounds", type=int, default=5, help="number of rounds [5]")
    parser.add_argument("--resume", action="store_true", help="keep the measurements of an interrupted benchmark")
    parser.add_argument("--quick", action="store_true", help="only the paper's case on one thread, and no page")
    arguments = parser.parse_args()
    programs = Programs(arguments.target)
    chosen = dict(sections(programs, arguments.quick))
    larger = [] if arguments.quick else sizes(programs)
    raw = arguments.target / "benchmarks.jsonl"
    known = [json.loads(line) for line in raw.read_text().splitlines()] if arguments.resume and raw.exists() else []
    everything = [case for cases in chosen.values() for case in cases]
    for case in [*larger, *everything]:
        case.lines = [line for line in known if line["key"] == case.key()]
    with open(raw, "a" if arguments.resume else "w") as file:
        for wanted in range(1, arguments.rounds + 1):
            for case in [*larger, *everything] if wanted == 1 else everything:
                if len(case.lines) < wanted:
                    case.run()
                    print(json.dumps(case.lines[-1]), file=file, flush=True)
    tables = {title: [case.median() for case in cases] for title, cases in chosen.items()}
    for title, lines in tables.items():
        print(f"\n{title}\n", *table(lines), sep="\n")
    ratios = list(verdicts(chosen[FIRST]))
    print("", *ratios, sep="\n")
    if not arguments.quick:
        by_size = [case.median() for case in larger]
        write_page(tables, ratios, by_size, parts.page(programs, arguments.target), arguments.rounds)
        draw([line for lines in tables.values() for line in lines], DOCS / "figures" / "benchmarks.svg")
        draw_sizes(by_size, DOCS / "figures" / "benchmark-sizes.svg")
    print(f"all lines  {raw}")


if __name__ == "__main__":
    main()
