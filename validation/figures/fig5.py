"""Fig. 5: diagonal terms of the velocity fluctuation tensor against concentration."""

import numpy as np

import shear
from cost import spheres
from report import Report, main
from runs import make, over_seeds
from theory import DilutePairs

DENSEST = shear.FRACTIONS[-1]
TERMS = (("xx", "$T_{11}$"), ("yy", "$T_{22}$"), ("zz", "$T_{33}$"))


def draw(mode):
    """Fluctuations of equal spheres, with lubrication and without, compared with the theory of pairs."""
    cases = {kind: shear.by_fraction(mode, kind == "lubricated") for kind in ("barrier", "lubricated")}
    make(sum([runs for one in cases.values() for runs in one.values()], []))
    report = Report("fig5", mode, "Fig. 5: velocity fluctuations in shear")
    fractions = np.array(shear.FRACTIONS)
    found = {}
    for kind, fill, suffix in (("barrier", "full", ""), ("lubricated", "none", ", lubrication")):
        for place, ((term, label), marker) in enumerate(zip(TERMS, "so^")):
            found[kind, term] = [over_seeds(runs, shear.tensor(term)) for runs in cases[kind].values()]
            style = {"marker": marker, "fillstyle": fill, "color": f"C{place}", "linestyle": "none"}
            report.points(label + suffix, fractions, found[kind, term], **style)
    pairs = DilutePairs()
    for kind, style in (("sheared", "-"), ("random", "--")):
        in_plane, _, across = pairs.slopes(kind)
        report.curve(f"pairs, {kind}: $T_{{11}} = T_{{22}}$", fractions, in_plane * fractions, color="0.3", linestyle=style)
        report.curve(f"pairs, {kind}: $T_{{33}}$", fractions, across * fractions, color="0.6", linestyle=style)
    report.label(r"$\phi$", r"$T_{ii} / (\dot\gamma a)^2$")
    for name, kind in (("", "barrier"), (", lubrication", "lubricated")):
        judge(report, name, {term: found[kind, term][shear.FRACTIONS.index(0.05)] for term, _ in TERMS}, pairs)
    growth = [quotient(*both) for both in zip(found["lubricated", "yy"], found["barrier", "yy"])]
    for fraction in (0.05, 0.15):
        over = growth[shear.FRACTIONS.index(fraction)]
        report.compare(f"T22 with over without lubrication, {fraction:.0%}", "10% less without (paper)", 1 / 0.9, over)
    compare_in_plane(report, cases["barrier"][DENSEST], found)
    return report


def compare_in_plane(report, runs, found):
    """T11 over T22 at the largest concentration: at the start, with random positions, and in the run."""
    of_pairs = "pairs of any structure (Drazer et al.)"
    report.compare(f"T11 / T22 at {DENSEST:.0%}, start, at random", of_pairs, 1.0, over_seeds(runs, at_start))
    in_run = quotient(*(found["barrier", term][shear.FRACTIONS.index(DENSEST)] for term in ("xx", "yy")))
    report.compare(f"T11 / T22 at {DENSEST:.0%}", of_pairs, 1.0, in_run)


def at_start(run):
    """T11 over T22 at the start of a run, with the error of a sample of its number of spheres."""
    along, across = (run.series(f"velocity_variance_{axis}[sphere]")[1][0] for axis in "xy")
    return along / across, 2 / spheres(run) ** 0.5


def judge(report, name, at_five, pairs):
    """Comparison with the theories at 5%."""
    for term, place in (("yy", 1), ("zz", 2)):
        value, error = at_five[term]
        for kind in ("random", "sheared"):
            expected = pairs.slopes(kind)[place]
            quantity = f"T{place + 1}{place + 1}/φ at 5%{name}"
            report.compare(quantity, f"pairs, {kind} (Drazer et al.)", expected, (value / 0.05, error / 0.05))
    apart = at_five["yy"][0] / at_five["zz"][0]
    report.state(f"T22 / T33 at 5%{name}", "nearly 4 (paper)", f"{apart:.2f}", 3 < apart < 5)


def quotient(above, below):
    """A quotient with its error."""
    value = above[0] / below[0]
    return value, value * ((above[1] / above[0]) ** 2 + (below[1] / below[0]) ** 2) ** 0.5


if __name__ == "__main__":
    main(draw)
