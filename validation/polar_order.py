"""Growth of the polar order of squirmers that start in random directions, by the number of squirmers."""

import sys

import numpy as np
from support.page import table, write_section
from support.program import series

# 10,000 squirmers take about twenty minutes of a core.
COUNTS = (300, 1000, 3000, 10000) if "--full" in sys.argv[1:] else (300, 1000)
OTHER_BETAS = (-1.0, 0.0)
FRACTION = 0.1
STEP, DURATION, LATE = 0.1, 1000.0, 200.0
# The rate is fitted from the last time at which the order is lower than the first number to the first time at which it is
# higher than the second: above that of random directions, and below saturation.
FITTED = (0.08, 0.3)
# The rates and the final orders of suspensions of 1,000 and more agree to these factors.
RATES_AGREE, ORDERS_AGREE = 1.5, 1.15


def orders(count, beta=1.0):
    """Times and polar orders of a suspension."""
    edge = (count * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
    rows = series(f"""seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.1 }}
repulsion = {{ strength = 130.0, range = 0.3 }}
hydrodynamics.tolerance = 1e-2
time = {{ step = {STEP}, duration = {DURATION}, order = 2 }}
output = {{ trajectory_every = 0, observables_every = 20, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = {count}, swimming = {{ speed = 1.0, beta = {beta} }} }}]
""")
    return np.array([[row["time"], row["orientation_polar[1]"]] for row in rows]).T


def growth_rate(times, order):
    """The rate of exponential growth in the fitted range, and the time at which the range ends."""
    end = int(np.argmax(order > FITTED[1]))
    start = int(np.flatnonzero(order[:end] < FITTED[0])[-1])
    return np.polyfit(times[start:end], np.log(order[start:end]), 1)[0], times[end]


def late_order(times, order):
    return np.mean(order[times > DURATION - LATE])


def row_of(count, beta):
    times, order = orders(count, beta)
    late = late_order(times, order)
    rate, end = growth_rate(times, order) if np.any(order > FITTED[1]) else (np.nan, np.nan)
    random = np.sqrt(8 / (3 * np.pi * count))
    texts = [f"{count:,}", f"{beta:g}", f"{random:.3f}", *("-" if np.isnan(x) else f"{x:.{n}f}" for x, n in ((rate, 4), (end, 0)))]
    print(*texts, f"{late:.3f}", flush=True)
    return rate, late, [*texts, f"{late:.3f}"]


def main():
    found = [row_of(count, 1.0) for count in COUNTS]
    others = [row_of(1000, beta) for beta in OTHER_BETAS]
    rates, late = np.array([[rate, late] for (rate, late, _), count in zip(found, COUNTS) if count >= 1000]).T
    apart = [np.max(numbers) / np.min(numbers) for numbers in (rates, late)]
    lines = [
        f"Squirmers at {FRACTION:.0%}, of radius and speed 1, without noise, that start in random directions, in cubic boxes. The",
        f"rate of growth is fitted to orders from {FITTED[0]} to {FITTED[1]}, and the late order is the mean over the last {LATE:g} of",
        f"{DURATION:g} radii swum. From 1,000 squirmers on, in one run of each size, rates agree to a factor of {apart[0]:.1f} and late",
        f"orders to one of {apart[1]:.1f}; neither depends on the size of large boxes by Delmotte, Keaveny, Plouraboué & Climent",
        "(J. Comput. Phys. 302, 524, 2015). Neutral squirmers and pushers stay disordered.",
        "",
        *table(["squirmers", "\\\\(\\beta\\\\)", "order of random directions", "rate of growth", "time of the order 0.3", "late order"],
               [texts for *_, texts in (*found, *others)]),
    ]
    write_section("squirmers.md", "polar-order", "Growth of order", lines)
    independent = apart[0] < RATES_AGREE and apart[1] < ORDERS_AGREE
    if not independent or min(late) < 0.3 or max(late for _, late, _ in others) > 0.2:
        raise SystemExit("failed: see the table")


if __name__ == "__main__":
    main()
