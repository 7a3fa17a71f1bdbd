"""Fig. 23: settling of two sizes, radii 1 : 2, 6% by volume, against the width of the box."""

import settling
import theory
from report import Report, main
from runs import make, over_seeds


def draw(mode):
    """Means, independent of the box except for the images, and fluctuations, which grow with it."""
    widths = settling.WIDTHS[mode]
    cases = {width: settling.dynamic(settling.two_sizes(2.0, 0.06), mode, edge=width) for width in widths}
    make(sum(cases.values(), []))
    report = Report("fig23", mode, "Fig. 23: settling of two sizes in boxes of several widths", panels=2)
    for place, (name, stokes, marker) in enumerate((("small", 1.0, "o"), ("large", 4.0, "^"))):
        species = settling.two_sizes(2.0, 0.06)
        both = [settling.settled(runs, species, place, width) for width, runs in cases.items()]
        boxed, found = zip(*both)
        style = {"marker": marker, "linestyle": "none", "color": f"C{place}"}
        report.points(f"{name}, in the box", widths, boxed, 0, fillstyle="none", alpha=0.5, **style)
        report.points(f"{name}, without images", widths, found, 0, **style)
        for label, formula, style in (
            ("Batchelor & Wen", theory.batchelor_wen, "-"), ("Davis & Gecol", theory.davis_gecol, "--"),
        ):
            value = formula((0.03, 0.03), (1.0, 2.0))[place]
            report.curve(f"{label}, {name}", [widths[0], widths[-1]], [value] * 2, 0, color=f"C{place}", linestyle=style)
        fluctuations = [over_seeds(runs, settling.fluctuation(name, "zz")) for runs in cases.values()]
        fluctuations = [(value / stokes, error / stokes) for value, error in fluctuations]
        report.points(name, widths, fluctuations, 1, marker=marker, color=f"C{place}")
        (first, error), (last, last_error) = found[0], found[-1]
        apart = abs(last - first)
        fine = apart < max(2 * (error + last_error), 0.1 * last)
        report.state(f"mean of {name}, narrowest to widest", "the same (paper)", f"{first:.3f} to {last:.3f} ± {last_error:.1g}", fine)
        told = f"{fluctuations[0][0]:.3f} to {fluctuations[-1][0]:.3f}"
        report.state(f"fluctuation of {name}", "increases (paper)", told, fluctuations[-1][0] > fluctuations[0][0])
    report.label("$L/a_1$", "$U_i / U_{oi}$", 0, ylim=(0, 1.05))
    report.label("$L/a_1$", "vertical fluctuation $/ U_{oi}$", 1, ylim=(0, None))
    return report


if __name__ == "__main__":
    main(draw)
