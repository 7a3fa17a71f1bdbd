"""Shear thickening under controlled stress: friction acts between spheres that are pressed together with more than a
critical load, so that a suspension goes from the viscosity without friction to that with it as the stress grows."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support.page import save, table, write_section
from support.program import series

FULL = "--full" in sys.argv[1:]
FRICTION, CRITICAL_LOAD, COUNTS = 1.0, 1.0, {1.0: 73, 1.4: 27}
UNIT = CRITICAL_LOAD / (6 * np.pi)
# Relative viscosities of pair lubrication and contacts alone, by volume fraction and stress over the critical load's.
PAIRS_ALONE = {
    0.50: {0.05: 14.3, 0.2: 14.2, 0.5: 13.3, 1.0: 18.1, 2.0: 25.0, 5.0: 45.0, 20.0: 58.0},
    0.54: {0.2: 19.5, 1.0: 30.5, 5.0: 107.0, 20.0: 365.0},
}
FRACTIONS = (0.50, 0.54) if FULL else (0.50,)
SETTLED, STRAIN = (1.5, 6.0) if FULL else (1.0, 2.5)
# The stress may be off in the mean by this part of it.
STRESS_ERROR = 0.02
# Viscosities at a given stress and at the rate that it gave may be so many errors apart.
WAYS_APART = 3.0


def scene(fraction, stress, flow, time):
    edge = (sum(4 / 3 * np.pi * radius**3 * count for radius, count in COUNTS.items()) / fraction) ** (1 / 3)
    species = "".join(f'[[species]]\nname = "{a:g}"\nradius = {a}\ncount = {n}\n' for a, n in COUNTS.items())
    return f"""seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
flow = {{ kind = "shear", {flow} }}
contacts = {{ friction = {FRICTION}, critical_load = {CRITICAL_LOAD} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ {time} }}
output = {{ trajectory_every = 0, observables_every = 1, checkpoint_every = 0 }}
{species}"""


def columns_of(text):
    """The columns of the time series of a scene."""
    rows = series(text)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def under_stress(case):
    """Relative viscosity and its error, the share of contacts with friction, and the mean stress over that asked for."""
    fraction, over = case
    stress = over * UNIT
    rate = stress / PAIRS_ALONE[fraction][over]
    columns = columns_of(scene(fraction, stress, f'control = "stress", stress = {stress}',
                               f"step = {0.01 / rate}, duration = {STRAIN / rate}"))
    half = columns["strain"][-1] * SETTLED / STRAIN
    late = np.flatnonzero(columns["strain"] > half)
    blocks = np.array_split(late, 6)
    rates = [np.ptp(columns["strain"][block]) / np.ptp(columns["time"][block]) for block in blocks]
    error = np.std(rates, ddof=1) / np.sqrt(len(rates)) / np.mean(rates)
    viscosity = stress * np.ptp(columns["time"][late]) / np.ptp(columns["strain"][late])
    found = (viscosity, error * viscosity, columns["frictional_contacts"][late].mean(), columns["shear_stress"][late].mean() / stress)
    print(case, *(f"{number:.4g}" for number in found), flush=True)
    return found


def at_rate(case):
    """The relative viscosity at the mean rate that a stress gave, with its error."""
    fraction, rate = case
    columns = columns_of(scene(fraction, 0.0, f"rate = {rate}", f"step = {0.005 / rate}, duration = {STRAIN / rate}"))
    late = np.flatnonzero(columns["time"] * rate > SETTLED)
    means = [columns["relative_viscosity"][block].mean() for block in np.array_split(late, 6)]
    found = columns["relative_viscosity"][late].mean(), np.std(means, ddof=1) / np.sqrt(len(means))
    print(case, *(f"{number:.4g}" for number in found), flush=True)
    return found


def draw(found):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    for fraction in FRACTIONS:
        stresses = list(PAIRS_ALONE[fraction])
        values = np.array([found[fraction, over][:2] for over in stresses])
        (line, *_) = axes.errorbar(stresses, values[:, 0], values[:, 1], fmt="o-", label=f"{fraction:.0%}")
        axes.plot(stresses, list(PAIRS_ALONE[fraction].values()), "--", color=line.get_color(), label="pairs alone")
    axes.set(xscale="log", yscale="log", xlabel="stress over that of the critical load", ylabel="relative viscosity")
    axes.legend(ncols=2)
    save(figure, "thickening.png")


def main():
    cases = [(fraction, over) for fraction in FRACTIONS for over in PAIRS_ALONE[fraction]]
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(cases, two.map(under_stress, cases)))
        compared = [(0.50, over) for over in ((0.2, 5.0) if FULL else (0.2,))]
        rated = list(two.map(at_rate, [(fraction, over * UNIT / found[fraction, over][0]) for fraction, over in compared]))
    draw(found)
    rows = [[f"{fraction:.0%}", f"{over:g}", f"{found[fraction, over][0]:.1f} ± {found[fraction, over][1]:.1f}", f"{PAIRS_ALONE[fraction][over]:g}",
             f"{found[fraction, over][2]:.2f}", f"{found[fraction, over][3]:.4f}"] for fraction, over in cases]
    ways = ", ".join(f"{found[case][0]:.1f} ± {found[case][1]:.1f} and {viscosity:.1f} ± {error:.1f} at {case[1]:g}"
                     for case, (viscosity, error) in zip(compared, rated))
    apart = {case: abs(found[case][0] - viscosity) / np.hypot(found[case][1], error) for case, (viscosity, error) in zip(compared, rated)}
    failed = [f"{case}: the stress is {values[3]:.4f} of what was asked for" for case, values in found.items() if abs(values[3] - 1) > STRESS_ERROR]
    failed += [f"{case}: {errors:.1f} errors apart with stress and rate given" for case, errors in apart.items() if errors > WAYS_APART]
    for fraction in FRACTIONS:
        low, high = (found[fraction, over][0] for over in (0.2, 5.0))
        if high < 1.8 * low:
            failed.append(f"{fraction}: {high:.1f} under the high stress, {low:.1f} under the low one")
    lines = [
        (f"{sum(COUNTS.values())} spheres of radii 1 and 1.4, half the volume "
         f"each, friction {FRICTION:g} where a contact bears more than the critical"),
        (f"load \\\\(F_c\\\\), means over strains of about {SETTLED:g} to {STRAIN:g} "
         "in one run; stresses are in units of \\\\(F_c / (6 \\pi a^2)\\\\). Beside the"),
        "viscosity: that of pair lubrication and contacts without a far field (bands of 25%). The last columns are the share of contacts",
        "with friction, and the mean of the stress in the time series over the one asked for.",
        "",
        *table(["φ", "stress", "relative viscosity", "pairs alone", "frictional", "stress found"], rows),
        "",
        f"With the stress given, and with the mean rate that came out given, at 50%: {ways}; these are to agree within",
        (f"{WAYS_APART:g} errors, and the stress with that asked for within "
         f"{STRESS_ERROR:.0%}. Where the viscosity fluctuates, that over the mean rate is below"),
        "that of the mean stress.",
        "",
        f"Not so at {'; '.join(failed)}." if failed else "So it is.",
        "",
        "![Shear thickening](figures/thickening.png)",
    ]
    write_section("dense.md", "thickening", "Shear thickening", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
