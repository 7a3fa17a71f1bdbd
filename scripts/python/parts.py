"""Parts of the benchmark other than whole mobilities: transforms, stencils, and communication between ranks."""

import json
import math
import os
import subprocess

TRANSFORMS = [48, 64, 96, 128, 144, 192]
RANKS = [2, 4, 8, 16, 32, 64]
EXCHANGING = 20_000

# The network of the projection: bytes per second of a node, and latency of a message in seconds.
BANDWIDTH, LATENCY = 12.5e9, 2e-6
# Approximate messages to every other rank for one mobility: transpositions, and particle data with their counts.
MESSAGES = 10


def output(command, **environment):
    """Output of a command, as JSON lines."""
    environment = {**os.environ, **environment}
    ended = subprocess.run(list(map(str, command)), env=environment, capture_output=True, text=True)
    if ended.returncode:
        raise SystemExit(f"{' '.join(map(str, command))} failed:\n{ended.stderr}")
    return [json.loads(line) for line in ended.stdout.splitlines()]


def transforms(target):
    """Forward and backward transforms of a real field, compared with FFTW (measured plans) and rustfft on the same pencils."""
    rows = [
        "| points | threads | precision | FFTW | rustfft | fcm-solve | ratio to FFTW | ratio to rustfft |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for threads in (1, 2):
        for size in TRANSFORMS:
            theirs = output([target / "peers" / "fftw", 0.25, threads, size])
            speed = [target / "release" / "examples" / "fft_speed", "--seconds", 0.25, "--threads", threads, size]
            ours, rustfft = output(speed), output([*speed, "--rustfft"])
            best = {line["precision"]: min(line["transform_ms"], line["three_ms"] / 3) for line in theirs}
            for line, rust in zip(ours, rustfft):
                times = best[line["precision"]], rust["transform_ms"], line["transform_ms"]
                ratios = times[2] / times[0], times[2] / times[1]
                cells = [f"{size}^3", threads, line["precision"], *(f"{number:.2f}" for number in (*times, *ratios))]
                rows.append("| " + " | ".join(map(str, cells)) + " |")
    return rows


def stencils(programs, target):
    """Rate of the loops over the rows of a stencil, and the peak of a core."""
    peaks = {line["precision"]: line["flops"] for line in output([target / "peers" / "peak"])}
    bench = [programs.ours, "bench", "--threads", 1, "--no-error", "--repeats", 9, "--tolerance", "1e-3,1e-6"]
    rows = ["| loop | precision | points | ns per sphere | Gflop/s | peak | share |", "|---|---|---|---|---|---|---|"]
    for line in output(bench):
        points, precision = line["support"], line["precision"]
        # Three components, three fused operations each, whole vectors of 8 points.
        operations = points**2 * 8 * math.ceil(points / 8) * 3 * 3 * 2
        for loop in ("spread", "interpolate"):
            seconds = line["seconds"][loop] / line["particles"]
            rate, peak = operations / seconds, peaks[precision]
            cells = [loop, precision, f"{points}^3", f"{1e9 * seconds:.0f}", f"{rate / 1e9:.1f}", f"{peak / 1e9:.0f}"]
            rows.append("| " + " | ".join([*cells, f"{rate / peak:.0%}"]) + " |")
    return rows


def exchange(programs):
    """Bytes that a rank sends for one mobility, and a projection to more ranks than there are cores."""
    alone = output(programs.solve("", **exchanging()).command)[0]
    grid, total = alone["grid"][0], alone["seconds"]["total"]
    bytes_of_grid = 3 * grid**3 * (4 if alone["precision"] == "f32" else 8)
    rows = [
        "| ranks | bytes sent by a rank | of which transposition | projected ms | efficiency, strong | efficiency, weak |",
        "|---|---|---|---|---|---|",
    ]
    halo = 0
    for ranks in [*RANKS, 256, 1024]:
        transposed = 2 * bytes_of_grid / ranks * kept_moving(ranks, grid)
        sent = transposed + halo / math.sqrt(ranks)
        if ranks <= RANKS[-1]:
            case = programs.solve("", ranks=ranks, **exchanging())
            case.command.insert(1, "--oversubscribe")
            sent = output(case.command, OMPI_MCA_mpi_yield_when_idle="1")[0]["bytes_sent"]
            halo = (sent - transposed) * math.sqrt(ranks)
        waiting = MESSAGES * ranks * LATENCY
        strong = total / ranks + sent / BANDWIDTH + waiting
        # Each rank has as many spheres as one has here, with a halo around its whole share.
        weak = total + (2 * bytes_of_grid * kept_moving(ranks, grid * ranks ** (1 / 3)) + halo) / BANDWIDTH + waiting
        shown = f"{sent / 1e6:.2f} MB" if ranks <= RANKS[-1] else f"({sent / 1e6:.2f} MB)"
        cells = [ranks, shown, f"{transposed / 1e6:.2f} MB", f"{1e3 * strong:.2f}"]
        cells += [f"{total / strong / ranks:.0%}", f"{total / weak:.0%}"]
        rows.append("| " + " | ".join(map(str, cells)) + " |")
    return grid, total, rows


def kept_moving(ranks, lines):
    """Smallest fraction of the grid that two transpositions move, over all tables of ranks that the grid allows."""
    tables = [(n, ranks // n) for n in range(1, ranks + 1) if ranks % n == 0 and max(n, ranks // n) <= lines]
    return min(2 - 1 / a - 1 / b for a, b in tables)


def exchanging():
    return {"particles": EXCHANGING, "repeats": 1, "no-error": True}


def page(programs, target):
    """Section of the benchmark page with these results."""
    grid, total, exchanged = exchange(programs)
    return [
        "## Transforms",
        "",
        "Milliseconds for one real component forward and backward, medians. FFTW uses measured plans: the fastest of in place,",
        "out of place and three at a time (`scripts/peers/fftw.c`,",
        "`cargo run --release -p fcm-solve-solver --example fft_speed`). rustfft replaces the SIMD kernels on the same pencils",
        "and threads; its time includes the copies into its rows and back (`--rustfft`).",
        "",
        *transforms(target),
        "",
        "## Share of peak",
        "",
        "The rate of operations on the rows of stencils, from the total time of spreading and interpolation on one thread,",
        "relative to the peak of a core for operands in registers (`scripts/peers/peak.c`). On a row each component takes three",
        "fused operations for each SIMD vector that is loaded, and in spreading also stored. Memory, not arithmetic, limits the",
        "speed: a SIMD vector of a grid row begins anywhere in a cache line, so most extend over two, and the grid is larger",
        "than the L2 cache. The rest of the time is spent on the polynomials of the window, the coefficients of the rows,",
        "sorting the spheres, and clearing the grid.",
        "",
        *stencils(programs, target),
        "",
        "## Communication between ranks",
        "",
        f"One mobility of {EXCHANGING} spheres at 12% on a grid of {grid}^3, which takes {1e3 * total:.0f} ms on one thread. Bytes are counted,",
        f"with more ranks than cores. Times are a projection, not a measurement: equally divided work, {BANDWIDTH / 1e9} GB/s per rank,",
        f"{1e6 * LATENCY:.0f} microseconds per message, and about {MESSAGES} messages to every other rank. In parentheses: the bytes of the",
        "halos, extrapolated as the square root of the number of ranks.",
        "",
        *exchanged,
        "",
    ]
