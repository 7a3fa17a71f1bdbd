"""The segregation of Santra et al.'s Fig. 6 with other masses and another unit.

Masses are proportional to the cube of the radius, and the unit of length is the smallest radius."""

from disks import QUICK, SHOWN, Sweep, near
from report import Report, main
from runs import make

SEEDS = [1, 2, 3, 4, 5, 6]
# Interpretations of the paper: keys of the scene, and the segregation at a strain of 195 by viscosity from an independent
# program in C over one to four seeds, with the scatter of samples.
READINGS = {
    "mass as radius cubed": (
        {"mass_exponent": 3},
        {0.001: (0.125, 0.025), 0.004: (0.23, 0.06), 0.01: (0.29, 0.04), 0.03: (0.385, 0.04)},
    ),
    "smallest radius 1": ({"length_unit": "smallest"}, {0.001: (0.213, 0.04), 0.01: (0.383, 0.056)}),
}


def draw(mode):
    """Means over six seeds."""
    report = Report("disks-masses", mode, "Other interpretations of masses and lengths", panels=len(READINGS))
    for panel, (reading, (keys, bands)) in enumerate(READINGS.items()):
        name = "masses-" + "-".join(map(str, keys.values()))
        sweep = Sweep(name, QUICK, particles=keys, seeds=SEEDS, viscosities=list(bands))
        make([sweep])
        values = {}
        for row in sweep.branches():
            viscosity = row["viscosity"]
            strain, delta, error = sweep.averages(viscosity)
            label = rf"$\eta$ = {viscosity:g}, $\zeta$ = {row['viscous_length']:.2f}"
            report.points(label, strain, list(zip(delta, error)), panel=panel, linewidth=1, elinewidth=0.4)
            values[viscosity] = value = near(strain, delta, SHOWN)
            expected, scatter = bands[viscosity]
            text = f"{value:.3f} ± {near(strain, error, SHOWN):.3f}"
            quantity = f"δ at strain {SHOWN}, η = {viscosity:g}, {reading}; ζ = {row['viscous_length']:.3g}"
            report.state(quantity, f"independent program: {expected} ± {scatter}", text, abs(value - expected) <= scatter)
        report.label(r"$\dot\gamma t$", rf"$\delta$, {reading}", panel=panel, ylim=(0, None))
        ratio = values[0.01] / values[0.001]
        report.state(f"δ(η = 0.01) / δ(η = 0.001), {reading}", "at least 1.4", f"{ratio:.2f}", ratio >= 1.4)
    return report


if __name__ == "__main__":
    main(draw)
