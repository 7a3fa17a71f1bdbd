"""Fig. 1: mean settling velocity of equal spheres against concentration. The data of Buscall et al., Nicolai et al. and Revay &
Higdon in the paper's figure are not known as numbers and are left out."""

import numpy as np

import settling
import theory
from report import Report, main
from runs import make


def draw(mode):
    """Places that the flow has made, and random ones; compared is what the images in the box leave out."""
    fractions = settling.MONODISPERSE
    dynamic = {phi: settling.dynamic(settling.equal_spheres(phi), mode) for phi in fractions}
    static = {phi: settling.static(settling.equal_spheres(phi), mode) for phi in fractions}
    forces = {phi: settling.static(settling.equal_spheres(phi), mode, "monopole") for phi in fractions}
    make(sum([*dynamic.values(), *static.values(), *forces.values()], []))
    report = Report("fig1", mode, "Fig. 1: settling of equal spheres", panels=2)
    found = []
    for cases, panel, label, marker in (
        (dynamic, 0, "runs", "o"), (static, 1, "random places", "^"), (forces, 1, "random, forces alone", "x"),
    ):
        boxed, free = {}, {}
        for phi, runs in cases.items():
            species = settling.equal_spheres(phi)
            boxed[phi], free[phi] = settling.settled(runs, species, 0, settling.edge_for(species, mode))
        style = {"marker": marker, "linestyle": "none"}
        report.points(f"{label}, in the box", fractions, list(boxed.values()), panel, fillstyle="none", color="0.6", **style)
        report.points(f"{label}, without images", fractions, list(free.values()), panel, **style)
        found.append(free)
    phi = np.linspace(0, 0.2, 41)
    report.curve("Richardson & Zaki, n = 4.7", phi, theory.richardson_zaki(phi), 0, color="k")
    report.curve("Batchelor", phi[:25], theory.batchelor(phi[:25]), 1, color="k", linestyle=":")
    report.curve("Brady & Durlofsky", phi, theory.brady_durlofsky(phi), 1, color="k")
    for panel in (0, 1):
        report.label(r"$\phi$", "$U/U_0$", panel, ylim=(0, 1.05))
    for fraction in (0.05, 0.10, 0.20):
        expected = theory.richardson_zaki(fraction)
        report.compare(f"runs at {fraction:.0%}", "Richardson & Zaki", expected, found[0][fraction], 0.15)
    for fraction in (0.02, 0.10, 0.20):
        expected = theory.brady_durlofsky(fraction)
        report.compare(f"random places at {fraction:.0%}", "Brady & Durlofsky", expected, found[1][fraction], 0.15)
        report.compare(f"the same, forces alone, {fraction:.0%}", "Brady & Durlofsky", expected, found[2][fraction], 0.15)
    return report


if __name__ == "__main__":
    main(draw)
