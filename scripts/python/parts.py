"""Parts of the benchmark other than whole mobilities: transforms and stencils."""

import json
import math
import subprocess

TRANSFORMS = [48, 64, 96, 128, 144, 192]


def output(command):
    """Output of a command, as JSON lines."""
    ended = subprocess.run(list(map(str, command)), capture_output=True, text=True)
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


def page(programs, target):
    """Section of the benchmark page with these results."""
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
    ]
