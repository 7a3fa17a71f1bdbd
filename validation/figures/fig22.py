"""Fig. 22: mean settling velocities of two sizes of equal density against the total concentration. The coefficients of the theories
are those of the pair distribution due to encounters; those of random pairs are larger."""

import numpy as np

import settling
import theory
from report import Report, main
from runs import make


def draw(mode):
    """From dilute to moderately concentrated; the compared velocities are corrected for the periodic images."""
    totals = settling.TOTALS[mode]
    cases = {(ratio, phi): settling.dynamic(settling.two_sizes(ratio, phi), mode) for ratio in (2.0, 3.0) for phi in totals}
    make(sum(cases.values(), []))
    report = Report("fig22", mode, "Fig. 22: settling of two sizes", panels=2)
    line = np.linspace(0, 0.16, 33)
    for panel, ratio in enumerate((2.0, 3.0)):
        radii = (1.0, ratio)
        for place, (name, marker) in enumerate((("small", "o"), ("large", "^"))):
            boxed, found = [], []
            for phi in totals:
                species = settling.two_sizes(ratio, phi)
                both = settling.settled(cases[ratio, phi], species, place, settling.edge_for(species, mode))
                boxed.append(both[0])
                found.append(both[1])
            colour = f"C{place}"
            style = {"marker": marker, "linestyle": "none", "color": colour}
            report.points(f"{name}, in the box", totals, boxed, panel, fillstyle="none", alpha=0.5, **style)
            report.points(f"{name}, $\\lambda$ = {ratio:g}, without images", totals, found, panel, **style)
            for label, formula, style in (
                ("Batchelor & Wen", theory.batchelor_wen, "-"), ("Davis & Gecol", theory.davis_gecol, "--"),
                ("Davis & Gecol, pairs at random", at_random, ":"),
            ):
                values = [formula((phi / 2, phi / 2), radii)[place] for phi in line]
                report.curve(f"{label}, {name}", line, values, panel, color=colour, linestyle=style)
            for phi, point in zip(totals, found):
                if phi in (0.02, 0.10):
                    formula = theory.batchelor_wen if phi < 0.06 else theory.davis_gecol
                    source = "Batchelor & Wen" if phi < 0.06 else "Davis & Gecol"
                    for said, expected in ((source, formula), ("pairs at random", at_random)):
                        value = expected((phi / 2, phi / 2), radii)[place]
                        report.compare(f"{name}, λ = {ratio:g}, {phi:.0%}", said, value, point, 0.15)
        report.label(r"$\phi$", "$U_i / U_{oi}$", panel, ylim=(-0.15, 1.05))
        report.panels[panel].legend(fontsize=6, loc="upper right")
    return report


def at_random(fractions, radii):
    """Davis & Gecol's formula with the coefficients of pairs at random."""
    return theory.davis_gecol(fractions, radii, theory.random_coefficient)


if __name__ == "__main__":
    main(draw)
