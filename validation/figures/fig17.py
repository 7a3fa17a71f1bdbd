"""Fig. 17: global diffusion coefficient against the ratio of radii."""

import shear
from global_diffusion import alone, global_coefficient
from report import Report, main
from runs import make, over_seeds


def draw(mode):
    """It hardly depends on the ratio of radii."""
    cases = shear.by_ratio(mode)
    make(sum(cases.values(), []))
    report = Report("fig17", mode, "Fig. 17: global diffusion of two sizes in shear")
    found = [over_seeds(runs, global_coefficient) for runs in cases.values()]
    report.points("two sizes", list(cases), found, marker="o")
    one, _ = alone(mode)
    report.panels[0].axhline(one, color="0.5", label="one size")
    report.label(r"$\lambda$", r"$D_g / \dot\gamma \langle a\rangle^2$", ylim=(0, None))
    values = [value for value, _ in found]
    spread = (max(values) - min(values)) / (sum(values) / len(values))
    allowed = 0.18 + 2 * max(error / value for value, error in found)
    report.state("relative variation of D_g", "18% (paper)", f"{spread:.0%}", spread < allowed)
    return report


if __name__ == "__main__":
    main(draw)
