"""Fig. 5: diagonal terms of the velocity fluctuation tensor against concentration."""

import numpy as np

import shear
from report import Report, main
from runs import make, over_seeds
from theory import DilutePairs

TERMS = (("xx", "$T_{11}$"), ("yy", "$T_{22}$"), ("zz", "$T_{33}$"))


def draw(mode):
    """Fluctuations of equal spheres, beside those of pairs."""
    cases = shear.by_fraction(mode)
    make(sum(cases.values(), []))
    report = Report("fig5", mode, "Fig. 5: velocity fluctuations in shear")
    fractions = np.array(list(cases))
    found = {term: [over_seeds(runs, shear.tensor(term)) for runs in cases.values()] for term, _ in TERMS}
    pairs = DilutePairs()
    for (term, label), marker in zip(TERMS, "*o^"):
        report.points(label, fractions, found[term], marker=marker, linestyle="none")
    for kind, style in (("sheared", "-"), ("random", "--")):
        in_plane, _, across = pairs.slopes(kind)
        report.curve(f"pairs, {kind}: $T_{{11}} = T_{{22}}$", fractions, in_plane * fractions, color="0.3", linestyle=style)
        report.curve(f"pairs, {kind}: $T_{{33}}$", fractions, across * fractions, color="0.6", linestyle=style)
    report.label(r"$\phi$", r"$T_{ii} / (\dot\gamma a)^2$")
    five = list(fractions).index(0.05)
    for term, place in (("yy", 1), ("zz", 2)):
        value, error = found[term][five]
        for kind in ("random", "sheared"):
            expected = pairs.slopes(kind)[place]
            name = f"T{place + 1}{place + 1}/φ at 5%"
            report.compare(name, f"pairs, {kind} (Drazer et al.)", expected, (value / 0.05, error / 0.05))
    plane, across = found["yy"][five][0], found["zz"][five][0]
    report.state("T22 / T33 at 5%", "nearly 4 (paper)", f"{plane / across:.2f}", 3 < plane / across < 5)
    return report


if __name__ == "__main__":
    main(draw)
