"""Fig. 6: off-diagonal terms of the velocity fluctuation tensor against concentration."""

import shear
from report import Report, main, shown
from runs import make, over_seeds

TERMS = (("xy", "$T_{12}$"), ("xz", "$T_{13}$"), ("yz", "$T_{23}$"))


def draw(mode):
    """Only the term in the plane of shear is nonzero."""
    cases = shear.by_fraction(mode)
    make(sum(cases.values(), []))
    report = Report("fig6", mode, "Fig. 6: off-diagonal velocity fluctuations in shear")
    found = {term: [over_seeds(runs, shear.tensor(term)) for runs in cases.values()] for term, _ in TERMS}
    for (term, label), marker in zip(TERMS, "D^v"):
        report.points(label, list(cases), found[term], marker=marker, linestyle="none")
    report.label(r"$\phi$", r"$T_{ij} / (\dot\gamma a)^2$")
    report.panels[0].axhline(0, color="0.7", linewidth=0.8)
    value, error = found["xy"][-1]
    report.state("T12 at 20%", "negative (paper)", shown((value, error)), value + 2 * error < 0)
    for term, name in (("xz", "T13"), ("yz", "T23")):
        value, error = found[term][-1]
        report.state(f"{name} at 20%", "zero (paper)", shown((value, error)), abs(value) < 3 * error)
    return report


if __name__ == "__main__":
    main(draw)
