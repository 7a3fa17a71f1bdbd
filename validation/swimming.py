"""Suspensions of squirmers: one in a box against its exact speed, and the polar order that interactions alone make of random
directions, by beta."""

import sys

import numpy as np
from support.page import table, write_section
from support.program import series

FULL = "--full" in sys.argv[1:]
EDGE, SECONDS, SEEDS = (30.0, 600.0, 3) if FULL else (22.0, 300.0, 1)
FRACTION = 0.1
BETAS = (-1.0, 0.0, 1.0, 3.0)
# Edges of the boxes of one swimmer, and the deviation that is allowed for the tolerance 1e-4 of the runs.
EDGES, TOLERATED = (4.0, 8.0, 16.0), 2e-4
# Tolerances in unbounded fluid.
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6)


def alone(box, tolerance):
    """The speed of a squirmer in a box over that in unbounded fluid."""
    rows = series(f"""{box}
fluid.viscosity = 1.0
particles = {{ initial = "positions", positions = [[1.0, 2.0, 0.5]] }}
hydrodynamics = {{ tolerance = {tolerance}, iteration_tolerance = 1e-10 }}
time = {{ step = 0.1, steps = 2 }}
output = {{ trajectory_every = 0, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = 1, swimming = {{ speed = 1.0, beta = 2.0 }} }}]
""")
    return rows[-1]["swimming_speed[1]"]


def boxes():
    rows, good = [], True
    for edge in EDGES:
        found, exact = alone(f"box.edges = [{edge}, {edge}, {edge}]", 1e-4), 1 - 4 / 3 * np.pi / edge**3
        rows.append([f"{edge:g}", f"{found:.6f}", f"{exact:.6f}"])
        print(*rows[-1], flush=True)
        good &= abs(found - exact) < TOLERATED
    lines = [
        "Swimming speed over that in unbounded fluid, for the radius 1 and \\\\(\\beta = 2\\\\) in any direction, with the exact value",
        "\\\\(1 - \\phi\\\\).",
        "",
        *table(["edge of the box", "speed", "exact"], rows),
    ]
    return lines, good


def unbounded():
    rows, good = [], True
    for tolerance in TOLERANCES:
        found = alone('box.boundaries = ["open", "open", "open"]', tolerance)
        rows.append([f"{tolerance:.0e}", f"{found:.7f}"])
        print(*rows[-1], flush=True)
        good &= abs(found - 1) < tolerance
    lines = [
        "The same in unbounded fluid, exactly 1:",
        "",
        *table(["tolerance", "speed"], rows),
    ]
    return lines, good


def crowd(beta, seed):
    """Rows of the time series of a suspension in its second half, and the number of spheres."""
    count = round(FRACTION * EDGE**3 / (4 / 3 * np.pi))
    rows = series(f"""seed = {seed}
box.edges = [{EDGE}, {EDGE}, {EDGE}]
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.1 }}
repulsion = {{ strength = 130.0, range = 0.3 }}
hydrodynamics.tolerance = 1e-2
time = {{ step = 0.05, duration = {SECONDS}, order = 2 }}
output = {{ trajectory_every = 0, observables_every = 20, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = {count}, swimming = {{ speed = 1.0, beta = {beta} }} }}]
""")
    return [row for row in rows if row["time"] >= 0.5 * SECONDS], count


def crowds():
    rows, orders = [], []
    for beta in BETAS:
        found = [crowd(beta, seed) for seed in range(1, SEEDS + 1)]
        late, count = [row for rows, _ in found for row in rows], found[0][1]
        means = [np.mean([row[name] for row in late]) for name in
                 ("swimming_speed[1]", "orientation_polar[1]", "close_neighbours", "largest_cluster")]
        orders.append(means[1])
        rows.append([f"{beta:g}", *(f"{mean:.3f}" for mean in means)])
        print(*rows[-1], flush=True)
    lines = [
        f"{count} squirmers at {FRACTION:.0%}, of radius and speed 1, that start in random directions, without noise and with the",
        f"repulsion of `fcm-solve new squirmers`: means over the times from {0.5 * SECONDS:g} to {SECONDS:g}"
        + (f" of {SEEDS} runs." if SEEDS > 1 else "."),
        f"Random directions have the polar order {np.sqrt(8 / (3 * np.pi * count)):.3f}. Weak pullers come to swim in one direction,",
        "as in [Evans, Ishikawa, Yamaguchi & Lauga 2011](https://arxiv.org/abs/1302.2288).",
        "",
        *table(["\\\\(\\beta\\\\)", "swimming speed", "polar order", "close neighbours", "largest cluster"], rows),
    ]
    return lines, orders[BETAS.index(1.0)] > 0.2


def main():
    titles = [("### One in a box", boxes), ("### One in unbounded fluid", unbounded), ("### Suspensions", crowds)]
    found = [(title, *case()) for title, case in titles]
    write_section("squirmers.md", "swimming", "Suspensions", [line for title, lines, _ in found for line in (title, "", *lines, "")])
    if not all(good for *_, good in found):
        raise SystemExit("failed: see the table")


if __name__ == "__main__":
    main()
