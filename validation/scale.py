"""Bytes, messages and memory of a rank by the number of ranks, with a projection for a billion spheres on 4,096 ranks. Ranks
are processes on this machine, more than it has cores, which does not affect the counts; times are projected."""

import json
import math
import os
import subprocess
import tempfile

from support.page import table, write_section
from support.program import PROGRAM

RANKS = [1, 2, 4, 8, 16, 32, 64]
SPHERES = 20_000
EVALUATIONS = 2
# A typical cluster network: bytes per second of a rank, and latency of a message in seconds.
BANDWIDTH, LATENCY = 5e9, 2e-6
BILLION, MANY = 1_000_000_000, 4096
SCENE = """
title = "Scale"
[box]
edges = [{edge}, {edge}, {edge}]
[fluid]
viscosity = 1.0
[[species]]
radius = 1.0
count = {count}
force = [0.0, 0.0, -1.0]
[hydrodynamics]
tolerance = 1e-3
[time]
step = 0.1
steps = 10
[output]
trajectory_every = 0
checkpoint_every = 0
"""


def counted(ranks):
    """Cost of one evaluation of the benchmark's spheres on a number of ranks."""
    launch = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    words = ["bench", "--particles", str(SPHERES), "--threads", "1", "--repeats", "1", "--no-error"]
    environment = {**os.environ, "OMPI_MCA_mpi_yield_when_idle": "1"}
    ended = subprocess.run([*launch, PROGRAM, *words], check=True, capture_output=True, text=True, env=environment)
    return json.loads(ended.stdout)


def memory(count, ranks):
    """Bytes of the first rank and of the largest of the others."""
    edge = f"{(count * 4 / 3 * math.pi / 0.12) ** (1 / 3):.3f}"
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as scene:
        scene.write(SCENE.format(edge=edge, count=count))
        scene.flush()
        words = ["check", scene.name, "--json", "--ranks", str(ranks)]
        ended = subprocess.run([PROGRAM, *words], check=True, capture_output=True, text=True)
    outline = json.loads(ended.stdout)
    needs = outline["memory_bytes"]
    return needs[0], max(needs[1:], default=0), outline["plan"]["grid"]


def table_of(ranks):
    """Rows and columns of the most nearly square table of ranks."""
    rows = max(n for n in range(1, int(math.sqrt(ranks)) + 1) if ranks % n == 0)
    return rows, ranks // rows


def transposed(ranks):
    """Messages of the forward and backward transpositions of an evaluation, with one rank per machine."""
    rows, columns = table_of(ranks)
    return 2 * (rows - 1 + columns - 1)


alone = counted(1)
work = alone["seconds"]["total"]
grid_bytes = 12 * math.prod(alone["grid"])
lines, messages_a_rank = [], 0.0
for ranks in RANKS:
    found = counted(ranks) if ranks > 1 else {**alone, "bytes_sent": 0, "messages_sent": 0}
    first, others, _ = memory(SPHERES, ranks)
    messages = found["messages_sent"] + (transposed(ranks) if ranks > 1 else 0)
    messages_a_rank = found["messages_sent"] / max(ranks - 1, 1)
    seconds = work / ranks + found["bytes_sent"] / BANDWIDTH + messages * LATENCY
    cells = [f"{found['bytes_sent'] / 1e6:.2f}", f"{messages:.0f}", f"{first / 1e6:.0f}", f"{others / 1e6:.0f}" if ranks > 1 else ""]
    lines.append([str(ranks), *cells, f"{1e3 * seconds:.2f}", f"{work / ranks / seconds:.0%}"])
    print(*lines[-1], flush=True)

first, others, grid = memory(BILLION, MANY)
share = BILLION / MANY
compute = work * share / SPHERES
moved = 2 * 2 * 12 * math.prod(grid) / MANY
exchanged = messages_a_rank * MANY + transposed(MANY)
parts = [compute, moved / BANDWIDTH, exchanged * LATENCY]
said = [
    f"One evaluation of {SPHERES:,} spheres at 12% on a grid of {alone['grid'][0]}³ with tolerance 1e-3: {1e3 * work:.0f} ms on one thread.",
    f"Bytes and messages of the rank with the most are counted; memory is predicted as on the [memory page](memory.md); times are",
    f"projected for {BANDWIDTH / 1e9:g} GB/s per rank, {1e6 * LATENCY:g} microseconds per message and one core per rank.",
    "",
    *table(["ranks", "MB sent", "messages", "MB of the first rank", "MB of others", "projected ms", "efficiency"], lines),
    "",
    (f"A billion spheres on {MANY:,} ranks, {share:,.0f} per rank, grid {grid[0]}³: "
     f"an evaluation takes {sum(parts):.2f} s: computation {parts[0]:.2f} s,"),
    f"transpositions {parts[1]:.2f} s ({moved / 1e6:.0f} MB per rank) and {exchanged:,.0f} messages {parts[2]:.2f} s. The first rank needs",
    f"{first / 1e9:,.0f} GB, the others {others / 1e9:.1f} GB each.",
]
write_section("scale.md", "scale", "Counts and projections", said)
