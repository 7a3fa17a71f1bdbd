"""Grains without a fluid grid: the speed of the disks and the start-up time of their scenes; a gas of hard spheres in the
event-driven engine against Enskog and Haff, up to ten million collisions; the paper's cell at full size; the solid fraction at
which a sheared cell jams; the grids of the continuum.

scripts/validate grains [--full]: minutes; --full measures the jamming cell four times as long."""

import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from support.page import save, table, write_section
from support.program import PROGRAM, ROOT, TARGET

FULL = "--full" in sys.argv[1:]
EXAMPLES = pathlib.Path(os.environ.get("FCM_SOLVE_EXAMPLES", TARGET / "release" / "examples"))
SCENES = ROOT / "scenes"
GRAINS, HITS = 10_000, {0.1: 1_000_000, 0.3: 1_000_000, 0.5: 10_000_000}
FRACTIONS = (0.48, 0.50, 0.52, 0.53, 0.54, 0.55, 0.56, 0.57)
# Times before and of the measurement in the small cell of `fcm-solve new shear-cell`.
SETTLE, MEASURED = (0.1, 0.4) if FULL else (0.05, 0.1)


def example(name, *words, threads=1):
    """Output of an example of the crate granular."""
    ran = subprocess.run(
        [EXAMPLES / name, *map(str, words)],
        check=True, capture_output=True, text=True, env=os.environ | {"RAYON_NUM_THREADS": str(threads)},
    )
    return ran.stdout


def solve(scene, folder, sets, expect_success=True):
    """Runs a scene that the program provides into a folder; returns the completed process."""
    command = [PROGRAM, "run", SCENES / f"{scene}.toml", "--out", folder, "--force", "--threads", "1"]
    for key, value in sets.items():
        command += ["--set", f"{key}={value}"]
    ran = subprocess.run([*map(str, command)], capture_output=True, text=True)
    if expect_success and ran.returncode:
        raise SystemExit(ran.stderr)
    return ran


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def seconds_until_it_marches(folder, sets, rounds=7):
    """The least wall-clock time from launch to when a scene of disks takes its first step in the flow."""
    found = []
    for _ in range(rounds):
        command = [PROGRAM, "run", SCENES / "granular-disks.toml", "--out", folder, "--force"]
        for key, value in sets.items():
            command += ["--set", f"{key}={value}"]
        start = time.perf_counter()
        process = subprocess.Popen([*map(str, command)], stderr=subprocess.PIPE, text=True)
        for line in process.stderr:
            if line.startswith("results"):
                found.append(time.perf_counter() - start)
                break
        process.terminate()
        process.communicate()
    return min(found)


def speeds_of_disks(rounds=3):
    """Particle steps per second of 100,000 disks on one thread and on two, in turns: the best, since other load only slows
    them."""

    def speed(threads):
        return float(example("disks_peer", "speed", 828, 200, threads=threads).split(",")[1].split()[0])

    found = [(speed(1), speed(2)) for _ in range(rounds)]
    return [max(column) for column in zip(*found)]


def disks(folder):
    ready = seconds_until_it_marches(folder, {"preparation.inelastic_until": 0.0, "preparation.elastic_until": 0.0})
    prepared = seconds_until_it_marches(folder, {})
    one, two = speeds_of_disks()
    found = [
        ["launch to the first step in the flow, no preparation", "50 ms", f"{1e3 * ready:.0f} ms", "yes" if ready < 0.05 else "no"],
        ["the same with the 667 steps of the preparation", "", f"{1e3 * prepared:.0f} ms", ""],
        ["100,000 disks, one thread: particle steps per second", "1.5e7", f"{one:.2e}", "yes" if one > 1.5e7 else "no"],
        ["speed-up by two threads", "at least 1.6", f"{two / one:.2f}", "yes" if two > 1.6 * one else "no"],
    ]
    write_section("grains.md", "grains disks", "Disks: start and speed", table(["quantity", "goal", "measured", "passed"], found))


def gas():
    """Collisions of elastic spheres, and the cooling of inelastic ones."""
    lines = []
    for fraction, hits in HITS.items():
        found = json.loads(example("gas", "hit", GRAINS, fraction, hits))
        speed, events = found["hits"] / found["seconds"], found["events"] / found["seconds"]
        fine = abs(found["over_enskog"] - 1) < 0.01 and found["overlap"] < 1e-12 and abs(found["energy"]) < 1e-11
        lines.append([
            f"{fraction:g}", f"{found['hits']:,}", f"{found['over_enskog']:.4f}", f"{found['overlap']:.0e}",
            f"{abs(found['energy']):.0e}", f"{speed / 1e6:.2f} M", f"{events / 1e6:.2f} M", "yes" if fine else "no",
        ])
    head = ["solid fraction", "collisions", "rate over Enskog's", "largest overlap", "energy error", "collisions / s", "events / s", "passed"]
    cooled = json.loads(example("gas", "cool", 20_000, 0.02, 0.9))["cooled"]
    course = [[f"{at:.2f}", f"{temperature:.4f}", f"{over:.4f}"] for at, temperature, over in cooled]
    worst = max(abs(over**0.5 - 1) for at, _, over in cooled if at > 1)
    write_section("grains.md", "grains gas", "A gas of hard spheres", [
        f"{GRAINS:,} smooth elastic spheres in a periodic cube, on one core, after ten collisions of each. Overlaps, relative to the",
        "diameter, are checked for all pairs after each tenth of the collisions and at every collision. An event is a",
        "collision, a passage into the next cell or a new prediction.",
        "",
        *table(head, lines),
        "",
        "20,000 smooth inelastic spheres with restitution 0.9 at a solid fraction of 0.02. Haff's law is `T = T0/(1 + t)^2`, with time in units",
        f"of `6/((1 - e^2) w0)` and Enskog's rate `w0`. The thermal speed stays within {100 * worst:.1f}% of it beyond t = 1.",
        "",
        *table(["time", "T/T0", "over Haff's"], course),
    ])


def paper(folder):
    """The paper's cell at full size against an independent prototype in C: stress and friction on the top, and the power of the
    speed to which the stress is proportional."""
    stresses, lines = {}, []
    for fraction, speed in ((0.5, 1.4), (0.55, 1.4), (0.55, 2.8)):
        # The same displacement at each speed.
        half = round(0.14 / speed, 3)
        times = {"time.transient": half, "time.duration": 2 * half, "measure.window": 5e-5}
        size = {"cell.length": 0.03, "cell.width": 0.019, "cell.speed": speed, "grains.initial_velocity_deviation": 0.05 * speed}
        solve("shear-cell", folder, size | times | {"grains.solid_fraction": fraction})
        top = {key: float(value) for key, value in rows(folder / "walls.csv")[1].items() if key != "wall"}
        totals = rows(folder / "totals.csv")[0]
        stresses[fraction, speed] = top["normal"]
        lines.append([
            f"{fraction:g}", f"{speed:g}", f"{top['normal']:.0f} ± {top['normal_error']:.0f}",
            f"{top['along'] / top['normal']:.3f}", f"{float(totals['temperature']):.4f}",
        ])
    exponent = math.log2(stresses[0.55, 2.8] / stresses[0.55, 1.4])
    ratio = float(lines[0][3])
    checks = [
        ["normal stress at 0.5 and 1.4 m/s, Pa", "244 ± 25%", lines[0][2], abs(stresses[0.5, 1.4] / 244 - 1) < 0.25],
        ["friction there", "0.29 ± 0.03", lines[0][3], abs(ratio - 0.29) < 0.03],
        ["power of the speed at 0.55", "1.7 to 2.05", f"{exponent:.2f}", 1.7 < exponent < 2.05],
    ]
    write_section("grains.md", "grains paper", "The paper's cell", [
        "Yu and Tichy's cell at its full size of 30 x 4 x 19 mm with rigid grains, from a random start. A displacement of 0.14 m",
        "is measured after a transient of the same length; stresses are those on the top.",
        "",
        *table(["solid fraction", "speed, m/s", "normal stress, Pa", "shear over normal stress", "granular temperature, m²/s²"], lines),
        "",
        *table(
            ["quantity", "prototype in C", "found", "passed"],
            [[*words, "yes" if is_passed else "no"] for *words, is_passed in checks],
        ),
    ])


def jam(folder):
    """Stress on the top against the solid fraction, both engines, up to jamming of rigid grains."""
    found, curves = [], {"event-driven": [], "time-stepped": []}
    for fraction in FRACTIONS:
        row = [f"{fraction:.2f}"]
        for engine, curve in curves.items():
            step = {"time.collision_step": 5e-7} if engine == "time-stepped" else {}
            times = {"time.transient": SETTLE, "time.duration": SETTLE + MEASURED}
            ran = solve("shear-cell", folder, {"collisions": f'"{engine}"', "grains.solid_fraction": fraction} | times | step, False)
            if ran.returncode:
                row.append("jams" if "the grains jam" in ran.stderr else ran.stderr.strip().splitlines()[-1])
                continue
            top = next(row for row in rows(folder / "walls.csv") if row["wall"] == "top")
            stress, error = float(top["normal"]), float(top["normal_error"])
            curve.append((fraction, stress, error))
            row.append(f"{stress:.0f} ± {error:.0f}")
        overlap = float(rows(folder / "totals.csv")[0]["largest_overlap"])
        found.append([*row, f"{100 * overlap:.1f}%"])
    figure, axes = plt.subplots(figsize=(5, 3.4), layout="constrained")
    for (engine, curve), marker in zip(curves.items(), "ox"):
        x, y, bars = zip(*curve)
        axes.errorbar(x, y, bars, marker=marker, fillstyle="none", capsize=2, label=engine)
    axes.set(xlabel="solid fraction", ylabel="normal stress on the top, Pa", yscale="log")
    axes.legend()
    save(figure, "grains-jam.png")
    write_section("grains.md", "grains jam", "Jamming of rigid grains", [
        "The cell of `fcm-solve new shear-cell` with a fixed top: normal stress on the top in Pa, and the largest overlap of the",
        "time-stepped grains relative to the diameter.",
        "",
        *table(["solid fraction", *curves, "overlap"], found),
        "",
        "![Stress against solid fraction](figures/grains-jam.png)",
    ])


def continuum(folder):
    solve("shear-cell-continuum", folder, {"cell.pressures": "[2500.0, 5500.0, 10000.0]"})
    paper = {1.4: "0.63", 2.0: "0.58", 2.8: "0.51"}
    lines = []
    for row in rows(folder / "summary.csv"):
        speed, pressure = float(row["speed"]), float(row["pressure"])
        fraction = f"{float(row['mean_solid_fraction']):.4f}"
        beside = paper[speed] if pressure == 5500 else ""
        lines.append([f"{speed:g}", f"{pressure:g}", fraction, beside, f"{float(row['residual']):.0e}", f"{float(row['intervals']):.0f}"])
    write_section("grains.md", "grains continuum", "Continuum: residual and grid", [
        "A solution is accepted only if it differs by less than 1e-9 from that on half as many intervals and its residual between the",
        "points is below 1e-9; otherwise the grid is refined.",
        "",
        *table(["speed, m/s", "pressure, Pa", "mean solid fraction", "paper", "residual", "intervals"], lines),
    ])


def main():
    command = ["cargo", "build", "--quiet", "--release", "-p", "fcm-solve-granular", "--examples"]
    if "FCM_SOLVE_EXAMPLES" not in os.environ:
        subprocess.run(command, check=True, cwd=ROOT)
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place) / "run"
        parts = {
            "disks": lambda: disks(folder),
            "gas": gas,
            "paper": lambda: paper(folder),
            "jam": lambda: jam(folder),
            "continuum": lambda: continuum(folder),
        }
        wanted = [word for word in sys.argv[1:] if word in parts] or list(parts)
        for part in wanted:
            parts[part]()


if __name__ == "__main__":
    main()
