"""Fig. 10: shear-induced self-diffusion along the gradient against concentration."""

import shear
from fig5 import quotient
from report import Report, main, shown
from runs import make, over_seeds


def draw(mode):
    """Diffusivity by slope and by integral, with lubrication and without; other data in the paper's figure are not available as
    numbers and are omitted."""
    cases = shear.by_fraction(mode)
    lubricated = shear.by_fraction(mode, lubrication=True)
    make(sum([*cases.values(), *lubricated.values()], []))
    report = Report("fig10", mode, "Fig. 10: self-diffusion in shear")
    found = {}
    for by, marker in (("slope", "v"), ("integral", "o")):
        for axis, filled in (("y", "full"), ("z", "none")):
            found[by, axis] = [over_seeds(runs, shear.diffusivity(axis, by=by)) for runs in cases.values()]
            label = f"$D_{{{'22' if axis == 'y' else '33'}}}$ by {by}"
            report.points(label, list(cases), found[by, axis], marker=marker, fillstyle=filled, linestyle="none")
    points = [over_seeds(runs, shear.diffusivity("y")) for runs in lubricated.values()]
    report.points("$D_{22}$ by slope, lubrication", list(lubricated), points, marker="s", fillstyle="none", linestyle="none")
    report.label(r"$\phi$", r"$D / \dot\gamma a^2$", yscale="log")
    slope, integral = found["slope", "y"], found["integral", "y"]
    report.compare("D22 at 20%, slope against integral", "integral", integral[-1][0], slope[-1], 0.2)
    grows = all(a[0] < b[0] for a, b in zip(slope[1:], slope[2:]))
    report.state("D22 from 5 to 20%", "increases (paper)", ", ".join(map(shown, slope[1:])), grows)
    for fraction in (0.05, 0.15):
        place = shear.FRACTIONS.index(fraction)
        over = quotient(points[place], slope[place])
        report.compare(f"D22 with over without lubrication, {fraction:.0%}", "35% less (paper)", 0.65, over, 0.2)
    across = over_seeds(cases[0.20], shear.quotient(shear.diffusivity("y"), shear.diffusivity("z")))
    report.compare("D22/D33 at 20%", "about 1.5 (paper)", 1.5, across, 0.2)
    return report


if __name__ == "__main__":
    main(draw)
