"""Fig. 18: mean diffusion coefficient against the ratio of concentrations."""

import shear
from global_diffusion import mean_coefficient
from report import Report, main, shown
from runs import make, over_seeds


def draw(mode):
    """It does not reduce mixtures to equal spheres, for which it is 1."""
    report = Report("fig18", mode, "Fig. 18: mean diffusion of mixtures in shear")
    quantity = mean_coefficient(mode)
    for ratio, marker in zip(shear.MIXED[mode], "^o"):
        cases = shear.by_mixture(ratio, mode)
        make(sum(cases.values(), []))
        found = [over_seeds(runs, quantity) for runs in cases.values()]
        report.points(f"$\\lambda$ = {ratio:g}", list(cases), found, marker=marker)
        away = max(found, key=lambda f: abs(f[0] - 1) / f[1])
        name = f"⟨D⟩ that differs most from 1, λ = {ratio:g}"
        report.state(name, "not 1 (paper)", shown(away), abs(away[0] - 1) > 2 * away[1])
    report.panels[0].axhline(1, color="0.5", label="one size")
    report.label(r"$\phi_2/\phi_1$", r"$\langle D \rangle$", xscale="log", ylim=(0, None))
    return report


if __name__ == "__main__":
    main(draw)
