"""Viscosity of a dense suspension after the flow is reversed, with friction and without.

Contacts open at once, so that the minimum of the viscosity is due to lubrication and independent of friction; then contacts form again."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support.page import save, table, write_section
from support.program import series

SEEDS = range(1, 7 if "--full" in sys.argv[1:] else 3)
FRICTIONS = (0.0, 0.5)
BEFORE, AFTER, STEP = 3.0, 3.0, 0.005
FRACTION, COUNTS = 0.45, {1.0: 73, 1.4: 27}
# Allowed deviation from 1 of the ratio of the minima with and without friction.
ALLOWED = 0.1
# Values by pair lubrication and contacts alone, means over four seeds: steady, minimum, strain of the minimum.
PAIRS_ALONE = {0.0: (8.9, 6.0, 0.60), 0.5: (16.2, 6.2, 0.44)}


def scene(seed, friction):
    edge = (sum(4 / 3 * np.pi * radius**3 * count for radius, count in COUNTS.items()) / FRACTION) ** (1 / 3)
    species = "".join(f'[[species]]\nname = "{a:g}"\nradius = {a}\ncount = {n}\n' for a, n in COUNTS.items())
    return f"""seed = {seed}
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
flow = {{ kind = "shear", rate = 1.0, reversal_at = [{BEFORE}] }}
contacts = {{ friction = {friction} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = {STEP}, duration = {BEFORE + AFTER} }}
output = {{ trajectory_every = 0, observables_every = 1, checkpoint_every = 0 }}
{species}"""


def course(case):
    """Time, viscosity and the contribution of contacts."""
    seed, friction = case
    rows = series(scene(seed, friction))
    contact = [sum(value for name, value in row.items() if name.startswith("stress_contact_xy")) / row["shear_rate"] for row in rows]
    return np.array([[row["time"], row["relative_viscosity"], of_contacts] for row, of_contacts in zip(rows, contact)])


def draw(means):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    for friction, values in means.items():
        (line,) = axes.plot(values[:, 0] - BEFORE, values[:, 1], label=f"friction {friction:g}")
        axes.plot(values[:, 0] - BEFORE, values[:, 2], "--", color=line.get_color(), label="contacts")
    axes.set(xlabel="strain since the reversal", ylabel="relative viscosity", ylim=(0, None))
    axes.legend(ncols=2)
    save(figure, "reversal.png")


def main():
    cases = [(seed, friction) for friction in FRICTIONS for seed in SEEDS]
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(cases, two.map(course, cases)))
    means = {friction: np.mean([found[seed, friction] for seed in SEEDS], axis=0) for friction in FRICTIONS}
    draw(means)
    rows, least = [], {}
    for friction, values in means.items():
        time, viscosity, contact = values.T
        steady = viscosity[(time > BEFORE - 1.0) & (time <= BEFORE)].mean()
        after = (time > BEFORE) & (time <= BEFORE + 1.5)
        lowest = np.flatnonzero(after)[np.argmin(viscosity[after])]
        least[friction] = viscosity[lowest]
        soon = contact[np.argmin(abs(time - BEFORE - 0.05))] / steady
        pairs = PAIRS_ALONE[friction]
        rows.append([f"{friction:g}", f"{least[friction] / steady:.2f}", f"{pairs[1] / pairs[0]:.2f}",
                     f"{time[lowest] - BEFORE:.2f}", f"{pairs[2]:g}", f"{soon:.3f}"])
        print(*rows[-1], flush=True)
    ratio = least[0.5] / least[0.0]
    lines = [
        f"{sum(COUNTS.values())} spheres at {FRACTION:.0%}, averaged over {len(SEEDS)} starts, reversed at a strain of {BEFORE:g}: the minimum",
        "of the viscosity relative to the steady value before the reversal, and the strain after the reversal at which it",
        "occurs, each with the values for pair lubrication and contacts without a far field (*pairs only*). The last column is the",
        "contact stress at a strain of 0.05 after the reversal, relative to the total stress before it.",
        "",
        *table(["μ", "minimum / steady", "pairs only", "strain", "pairs only", "contact stress"], rows),
        "",
        f"The minima with and without friction have a ratio of {ratio:.3f}; {1 - ALLOWED:g} to {1 + ALLOWED:g} is allowed.",
        "",
        "![Viscosity after reversal](figures/reversal.png)",
    ]
    write_section("dense.md", "reversal", "Viscosity after a reversal", lines)
    if abs(ratio - 1.0) > ALLOWED:
        raise SystemExit(f"failed: the minima have a ratio of {ratio:.3f}")


if __name__ == "__main__":
    main()
