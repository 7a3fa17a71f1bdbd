"""Fig. 15: fluctuations of large over small spheres against the ratio of concentrations, radii 1 : 2."""

import shear
from report import Report, main, root
from runs import make, over_seeds


def draw(mode):
    """The quotient hardly depends on the mixture."""
    cases = shear.by_mixture(2.0, mode)
    make(sum(cases.values(), []))
    report = Report("fig15", mode, "Fig. 15: fluctuations of large over small spheres")
    quantities = {
        "$w_{33}$": [shear.tensor("zz", name, what="w") for name in ("large", "small")],
        "$T_{22}$": [shear.tensor("yy", "large", 2.0), shear.tensor("yy", "small", 1.0)],
    }
    for (label, (large, small)), marker in zip(quantities.items(), "^o"):
        found = [over_seeds(runs, shear.quotient(large, small)) for runs in cases.values()]
        report.points(label, list(cases), found, marker=marker)
        name = label.strip("$").replace("_", "").replace("{", "").replace("}", "")
        report.compare(f"{name}, large over small, φ₂/φ₁ = 1", "nearly 1/2 (paper)", 0.5, found[2], 0.2)
        report.compare("its square root", "nearly 1/2 (paper)", 0.5, root(found[2]), 0.2)
    report.label(r"$\phi_2/\phi_1$", "large over small", xscale="log", ylim=(0, 1))
    return report


if __name__ == "__main__":
    main(draw)
