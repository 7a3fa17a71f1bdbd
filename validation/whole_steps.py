"""Cost of whole steps without lubrication, over one mobility of the same spheres: settling and sheared, timed in turns, medians."""

import json
import subprocess

import numpy as np
from support.page import table, write_section
from support.program import PROGRAM, series

COUNT, FRACTION, TOLERANCE, ROUNDS, STEPS, EVERY = 3200, 0.12, 1e-3, 5, 60, 5
SETTLING, SHEARED = ("force = [0.0, 0.0, -18.85]", ""), ("", 'flow = { kind = "shear", rate = 1.0, lees_edwards = true }')
# Loads, step, method, and the largest cost of a step in mobilities.
RUNS = {
    "settling": (SETTLING, 0.015, "", 3.5),
    "settling, unstable steps": (SETTLING, 0.05, "", None),
    "settling, `implicit`": (SETTLING, 0.05, 'integrator = "implicit"', 3.5),
    "sheared": (SHEARED, 0.005, "", None),
}


def scene(acting, step, method):
    edge = (COUNT * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
    of_spheres, flow = acting
    return f"""seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.02 }}
repulsion = {{ strength = 40.0, range = 0.1 }}
hydrodynamics.tolerance = {TOLERANCE}
output = {{ trajectory_every = 0, observables_every = {EVERY}, checkpoint_every = 0 }}
{flow}
[time]
step = {step}
steps = {STEPS}
{method}
[[species]]
radius = 1.0
count = {COUNT}
{of_spheres}
"""


def timed_steps(text):
    """Iterations of the first solve; evaluations of a step later, and its median seconds."""
    rows = series(text)
    # The first steps have few previous solutions to extrapolate from.
    later = rows[2:]
    evaluations = np.mean([row["evaluations"] for row in later])
    return rows[0]["iterations"], evaluations, np.median([row["seconds_per_step"] for row in later])


def mobility_seconds():
    size = ["--particles", COUNT, "--volume-fraction", FRACTION, "--tolerance", TOLERANCE]
    command = [PROGRAM, "bench", *size, "--repeats", 30, "--threads", 1, "--no-error"]
    ended = subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True)
    return json.loads(ended.stdout)["seconds"]["total"]


def main():
    taken = {name: [] for name in RUNS}
    for _ in range(ROUNDS):
        for name, (*run_of, _) in RUNS.items():
            mobility = mobility_seconds()
            iterations, evaluations, seconds = timed_steps(scene(*run_of))
            taken[name].append((iterations, evaluations, 1e3 * seconds, seconds / mobility))
    rows, failed = [], []
    for name, (_, step, _, allowed) in RUNS.items():
        iterations, evaluations, milliseconds, worth = np.median(taken[name], axis=0)
        worths = [way[3] for way in taken[name]]
        spread = f"{worth:.1f} ({min(worths):.1f} to {max(worths):.1f})"
        cells = [name, f"{step:g}", f"{iterations:.0f}", f"{evaluations:.1f}", f"{milliseconds:.0f}", spread, str(allowed or "")]
        rows.append([*cells, f"{worth / step:.0f}"])
        print(*rows[-1], flush=True)
        if allowed and worth > allowed:
            failed.append(f"{name}: a step costs {worth:.1f} mobilities, more than {allowed}")
    lines = [
        f"{COUNT} rigid spheres at {FRACTION:.0%} without lubrication, tolerance {TOLERANCE:g}, one thread, {ROUNDS} rounds, measured in turns:",
        "iterations of a first solve for the stresslets, evaluations of the mobility in a later step, which starts from an",
        "extrapolation of previous solutions, and the time of a step over that of one mobility. Repulsion keeps these pairs",
        "apart steadily in explicit steps of up to 0.016. With longer ones, of which the program warns, nearby spheres and",
        "their stresslets jitter. The length of `implicit` steps is limited only by their error.",
        "",
        *table(["suspension", "step", "iterations, first solve", "evaluations per step", "ms per step", "steps in mobilities", "goal",
                "mobilities per unit of time"], rows),
        "",
        f"Not met: {'; '.join(failed)}." if failed else "All goals are met.",
    ]
    write_section("costs.md", "whole-steps", "Whole steps", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
