"""Stages of evaluations and of lubricated steps inside and outside of parallel loops, on one thread."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

from step_times import scene
from support.page import table, write_section
from support.program import PROGRAM

EVALUATIONS = [(3_200, 7), (100_000, 3), (1_000_000, 1)]
STEPS = [(5_280, 5), (50_000, 3)]
FRACTION, TOLERANCE, STARTING = 0.2, 1e-2, 6
PIECES = 5
THREADS = [2, 4, 16, 64]


def bench(*words):
    """The line of a benchmark on one thread."""
    ended = subprocess.run([PROGRAM, "bench", *words, "--threads", "1"], check=True, capture_output=True, text=True)
    return json.loads(ended.stdout)


def evaluation(count, repeats):
    """Stages of an evaluation with and without a rebuild of lists."""
    line = bench("--serial", "--particles", str(count), "--repeats", str(repeats))
    return {"with lists": line["with_lists"], "repeated": line["repeated"]}


def step(count, steps):
    """Stages of a lubricated step and of its observables."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.toml"
        text = scene(count, FRACTION, TOLERANCE, True)
        path.write_text(text.replace(f"steps = {4} }}", f"steps = {STARTING + steps} }}"))
        line = bench("--step", str(path), "--repeats", str(steps))
    return {"step": line["step"], "observables": line["observables"]}


def stages(shares):
    """The table of stages."""
    rows = [[stage["stage"], f"{1e3 * stage['seconds']:.3g}", f"{1e3 * stage['serial']:.3g}", f"{stage['serial_share']:.1%}",
             f"{stage['loops']:.0f}", f"{stage['tasks_per_loop']:.0f}", f"{stage['largest_over_mean']:.2f}", f"{stage['bytes'] / 1e6:.3g}"]
            for stage in shares["stages"]]
    total = ["**all**", f"{1e3 * shares['seconds']:.3g}", f"{1e3 * shares['seconds'] * shares['serial_share']:.3g}",
             f"**{shares['serial_share']:.1%}**", *[""] * 4]
    return table(["stage", "ms", "serial, ms", "serial", "loops", "tasks", "largest", "MB"], [*rows, total])


def pieces(shares):
    """The longest pieces outside of loops, by the loops or stages before and after them."""
    rows = [[f"{1e3 * piece['seconds']:.3g}", piece["stage"], f"`{piece['after']}`", f"`{piece['before']}`"]
            for piece in shares["largest_serial"][:PIECES]]
    return table(["ms", "stage", "after", "before"], rows)


def summary(cases):
    """Serial shares and estimates of all cases."""
    rows = []
    for name, shares in cases:
        speedups = {estimate["threads"]: estimate["speedup"] for estimate in shares["estimates"]}
        rows.append([name, f"{1e3 * shares['seconds']:.3g}", f"{shares['serial_share']:.1%}", *(f"{speedups[p]:.1f}" for p in THREADS)])
    return table(["", "ms, one thread", "serial", *(f"speed-up, {p} threads" for p in THREADS)], rows)


def main():
    cases = []
    for count, repeats in EVALUATIONS:
        cases += [(f"{count:,} spheres, {kind}", shares) for kind, shares in evaluation(count, repeats).items()]
        print(*cases[-1][:1], flush=True)
    for count, steps in STEPS:
        cases += [(f"{count:,} lubricated spheres at 20%, {kind}", shares) for kind, shares in step(count, steps).items()]
        print(*cases[-1][:1], flush=True)
    lines = [
        "Evaluations at a volume fraction of 12% and a tolerance of 1e-3, steps in shear at a tolerance of 1e-2, on a machine with",
        f"{os.cpu_count()} cores.",
        "",
        *summary(cases),
    ]
    for name, shares in cases:
        lines += ["", f"### {name}", "", *stages(shares), "", "Longest pieces outside of loops:", "", *pieces(shares)]
    write_section("cores.md", "cores", "Serial shares", lines)


if __name__ == "__main__":
    sys.exit(main())
