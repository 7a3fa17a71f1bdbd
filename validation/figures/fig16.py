"""Fig. 16: global diffusion coefficient against the ratio of concentrations."""

import shear
from global_diffusion import alone, global_coefficient
from report import Report, main
from runs import make, over_seeds


def draw(mode):
    """It decreases with the fraction of large spheres."""
    report = Report("fig16", mode, "Fig. 16: global diffusion of mixtures in shear")
    for ratio, marker in zip(shear.MIXED[mode], "^o"):
        cases = shear.by_mixture(ratio, mode)
        make(sum(cases.values(), []))
        found = [over_seeds(runs, global_coefficient) for runs in cases.values()]
        report.points(f"$\\lambda$ = {ratio:g}", list(cases), found, marker=marker)
        quotient = found[-1][0] / found[0][0]
        error = quotient * sum((e / v) ** 2 for v, e in (found[0], found[-1])) ** 0.5
        report.compare(f"D_g at φ₂/φ₁ = 9 over 1/9, λ = {ratio:g}", "nearly 0.5 (paper)", 0.5, (quotient, error), 0.2)
    one, _ = alone(mode)
    report.panels[0].axhline(one, color="0.5", label="one size")
    report.label(r"$\phi_2/\phi_1$", r"$D_g / \dot\gamma \langle a\rangle^2$", xscale="log")
    return report


if __name__ == "__main__":
    main(draw)
