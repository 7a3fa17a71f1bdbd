"""Fig. 7 of Santra et al.: the final segregation against the viscous length."""

import numpy as np

from disks import FULL, QUICK, RATE, Sweep
from report import Report, main
from runs import make

RATES = [0.003, 0.01, 0.03, 0.1]
VISCOSITIES = [0.001, 0.004, 0.01, 0.03]


def draw(mode):
    """Two branches: one viscosity and several rates of shear, one rate and several viscosities."""
    strain, seeds = (FULL, [1, 2, 3, 4, 5, 6]) if mode == "full" else (QUICK, [1, 2, 3])
    rates = Sweep(f"fig7-rates-{mode}", strain, seeds=seeds, rates=RATES)
    viscosities = Sweep(f"fig7-viscosities-{mode}", strain, seeds=seeds, viscosities=VISCOSITIES)
    make([rates])
    make([viscosities])
    report = Report("disks-fig7", mode, "Fig. 7: final segregation against the viscous length")
    curves = {}
    for sweep, label, marker in ((rates, r"$\eta$ = 0.01", "x"), (viscosities, rf"$\dot\gamma$ = {RATE:g}", "D")):
        rows = sorted(sweep.branches(), key=lambda row: row["viscous_length"])
        curves[label] = rows
        found = [(row["last_segregation"], row["last_segregation_error"]) for row in rows]
        report.points(label, [row["viscous_length"] for row in rows], found, marker=marker, linestyle="none")
    report.label(r"$\zeta$", r"$\delta_\infty$", xscale="log", ylim=(0, None))
    for label, rows in curves.items():
        values = [row["last_segregation"] for row in rows]
        text = ", ".join(f"{value:.3f}" for value in values)
        name = label.replace("$", "").replace("\\eta", "η").replace("\\dot\\gamma", "rate")
        report.state(f"δ with increasing ζ, {name}", "decreases (paper)", text, values[-1] < 0.75 * values[0])
    one, other = curves.values()
    lengths = [row["viscous_length"] for row in other]
    at = np.interp(np.log([row["viscous_length"] for row in one]), np.log(lengths), [row["last_segregation"] for row in other])
    apart = max(abs(row["last_segregation"] - value) for row, value in zip(one, at))
    report.state("largest difference between the branches", "one curve within the scatter, 0.2 δ (paper)", f"{apart:.3f}", apart < 0.2 * max(at))
    return report


if __name__ == "__main__":
    main(draw)
