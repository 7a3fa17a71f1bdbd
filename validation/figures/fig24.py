"""Fig. 24: settling of equal spheres of two densities, the first 2% by volume, against the total concentration. The theory is that
of pairs at random with exact mobilities; Davis & Gecol's coefficients for other ratios of densities and the data of Revay &
Higdon are not known as numbers and are left out."""

import numpy as np

import settling
import theory
from report import Report, main
from runs import make


def draw(mode):
    """Both sink, or one rises; what the images in the box take off is added back."""
    seconds = settling.SECOND[mode]
    own, other = theory.random_pairs()
    report = Report("fig24", mode, "Fig. 24: settling of two densities", panels=2)
    for panel, ratio in enumerate((2.0, -1.0)):
        both = {phi: settling.two_densities(ratio, phi) for phi in seconds}
        dynamic = {phi: settling.dynamic(species, mode) for phi, species in both.items()}
        static = {phi: settling.static(species, mode) for phi, species in both.items()}
        make(sum([*dynamic.values(), *static.values()], []))
        totals = [0.02 + phi for phi in seconds]
        line = np.linspace(0.02, totals[-1], 20)
        for place, (name, stokes) in enumerate((("first", 1.0), ("second", ratio))):
            velocities = {}
            for kind, cases, marker in (("runs", dynamic, "o"), ("random places", static, "^")):
                edges = {phi: settling.edge_for(species, mode) for phi, species in both.items()}
                velocities[kind] = [
                    settling.settled(runs, both[phi], place, edges[phi])[1] for phi, runs in cases.items()
                ]
                style = {"marker": marker, "linestyle": "none", "color": f"C{place}", "fillstyle": "none"}
                report.points(f"{name}: {kind}", totals, velocities[kind], panel, **style)
            of_first = own + other * (1 / stokes)
            of_second = own + other * (ratio / stokes)
            theory_line = 1 + 0.02 * of_first + (line - 0.02) * of_second
            report.curve(f"{name}: pairs at random", line, theory_line, panel, color=f"C{place}")
            expected = 1 + 0.02 * of_first + seconds[0] * of_second
            name_of = f"{name}, γ = {ratio:g}, {totals[0]:.0%}, random places"
            report.compare(name_of, "pairs at random", expected, velocities["random places"][0], 0.15)
            if ratio < 0 and name == "first":
                values = [value for value, _ in velocities["runs"]]
                told = ", ".join(f"{value:.3f}" for value in values)
                report.state("first, γ = -1, runs", "grows with the total (paper)", told, values[-1] > values[0])
                last = [velocities[kind][-1][0] for kind in ("runs", "random places")]
                told = f"{last[0]:.3f} in runs, {last[1]:.3f} at random"
                report.state(f"first, γ = -1, {totals[-1]:.0%}", "larger in runs (paper)", told, last[0] > last[1])
        report.label(r"$\phi$", "$U_i / U_{oi}$", panel)
    return report


if __name__ == "__main__":
    main(draw)
