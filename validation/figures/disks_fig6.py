"""Fig. 6 of Santra et al.: segregation over time at four viscosities."""

import numpy as np

from disks import FULL, QUICK, SHOWN, Sweep, near
from report import Report, main
from runs import make

VISCOSITIES = [0.001, 0.004, 0.01, 0.03]
SEEDS = [1, 2, 3, 4, 5, 6]
# Segregation at a strain of 195 by an independent program in C, over three to five seeds, and the scatter of samples.
INDEPENDENT = {0.001: (0.225, 0.04), 0.004: (0.295, 0.045), 0.01: (0.368, 0.045), 0.03: (0.388, 0.045)}


def draw(mode):
    """Means over six seeds."""
    sweep = Sweep(f"fig6-{mode}", FULL if mode == "full" else QUICK, seeds=SEEDS, viscosities=VISCOSITIES)
    make([sweep])
    report = Report("disks-fig6", mode, "Fig. 6: segregation over time")
    found = {}
    for row in sweep.branches():
        strain, delta, error = sweep.averages(row["viscosity"])
        label = rf"$\eta$ = {row['viscosity']:g}, $\zeta$ = {row['viscous_length']:.2f}"
        report.points(label, strain, list(zip(delta, error)), linewidth=1, elinewidth=0.4)
        found[row["viscosity"]] = near(strain, delta, SHOWN), near(strain, error, SHOWN), near(strain, delta, 0)
    report.label(r"$\dot\gamma t$", r"$\delta$", ylim=(0, None))
    for viscosity, (delta, error, _) in found.items():
        expected, scatter = INDEPENDENT[viscosity]
        text = f"{delta:.3f} ± {error:.3f}"
        inside = abs(delta - expected) <= scatter
        report.state(f"δ at strain {SHOWN}, η = {viscosity:g}", f"independent program: {expected} ± {scatter}", text, inside)
    values = [found[viscosity][0] for viscosity in VISCOSITIES]
    start = np.mean([first for _, _, first in found.values()])
    report.state("δ at the start", "independent program: 0.14 ± 0.03", f"{start:.3f}", abs(start - 0.14) <= 0.03)
    text = " < ".join(f"{value:.3f}" for value in values)
    ordered = all(low < high for low, high in zip(values, values[1:]))
    report.state("order of the four curves", "δ increases with η (paper)", text, ordered)
    ratio = values[2] / values[0]
    report.state("δ(η = 0.01) / δ(η = 0.001)", "at least 1.4", f"{ratio:.2f}", ratio >= 1.4)
    if mode == "full":
        last = next(row for row in sweep.branches() if row["viscosity"] == 0.01)
        value, error = last["last_segregation"], last["last_segregation_error"]
        inside = abs(value - 0.53) <= 0.06
        report.state("δ at strains 900 to 1000, η = 0.01", "independent program: 0.53 ± 0.06", f"{value:.3f} ± {error:.3f}", inside)
    return report


if __name__ == "__main__":
    main(draw)
