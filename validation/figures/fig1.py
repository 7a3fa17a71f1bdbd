"""Fig. 1: mean settling velocity of equal spheres against concentration. The data of Buscall et al., Nicolai et al. and Revay &
Higdon in the paper's figure are not available as numbers and are omitted. Brownian spheres, distributed like hard spheres at
equilibrium, settle more slowly than others."""

import numpy as np

import settling
import theory
from report import Report, main
from runs import make


def draw(mode):
    """Positions from runs, and equilibrium ones; the compared velocities are corrected for the periodic images."""
    fractions = settling.MONODISPERSE
    dynamic = {phi: settling.dynamic(settling.equal_spheres(phi), mode) for phi in fractions}
    closer = {0.20: settling.dynamic(settling.equal_spheres(0.20), mode, reach=settling.SHORT_RANGE)}
    static = {phi: settling.static(settling.equal_spheres(phi), mode) for phi in fractions}
    forces = {phi: settling.static(settling.equal_spheres(phi), mode, "monopole") for phi in fractions}
    make(sum([*dynamic.values(), *closer.values(), *static.values(), *forces.values()], []))
    report = Report("fig1", mode, "Fig. 1: settling of equal spheres", panels=2)
    found = {}
    for cases, panel, label, marker in (
        (dynamic, 0, "runs", "o"), (closer, 0, "runs, shorter barrier", "s"),
        (static, 1, "equilibrium", "^"), (forces, 1, "equilibrium, forces alone", "x"),
    ):
        boxed, free = {}, {}
        for phi, runs in cases.items():
            species = settling.equal_spheres(phi)
            boxed[phi], free[phi] = settling.settled(runs, species, 0, settling.edge_for(species, mode), cases is not forces)
        style = {"marker": marker, "linestyle": "none"}
        report.points(f"{label}, in the box", list(cases), list(boxed.values()), panel, fillstyle="none", color="0.6", **style)
        report.points(f"{label}, without images", list(cases), list(free.values()), panel, **style)
        found[label] = free
    phi = np.linspace(0, 0.2, 41)
    report.curve("Richardson & Zaki, n = 4.7", phi, theory.richardson_zaki(phi), 0, color="k")
    report.curve("Brownian spheres, n = 5.6", phi, theory.brownian(phi), 0, color="k", linestyle="--")
    report.curve("Batchelor", phi[:25], theory.batchelor(phi[:25]), 1, color="k", linestyle=":")
    report.curve("Brady & Durlofsky", phi, theory.brady_durlofsky(phi), 1, color="k")
    report.curve("Brownian spheres, n = 5.6", phi, theory.brownian(phi), 1, color="k", linestyle="--")
    for panel in (0, 1):
        report.label(r"$\phi$", "$U/U_0$", panel, ylim=(0, 1.05))
    for fraction in (0.05, 0.10, 0.20):
        expected = theory.richardson_zaki(fraction)
        report.compare(f"runs at {fraction:.0%}", "Richardson & Zaki", expected, found["runs"][fraction], 0.15)
    name = f"runs at 20%, barrier of range {settling.SHORT_RANGE:g} a"
    report.compare(name, "Richardson & Zaki", theory.richardson_zaki(0.20), found["runs, shorter barrier"][0.20], 0.15)
    for fraction in (0.02, 0.10, 0.20):
        places = f"equilibrium at {fraction:.0%}"
        report.compare(places, "Brownian spheres (Brzinski & Durian)", theory.brownian(fraction), found["equilibrium"][fraction])
        expected = theory.brady_durlofsky(fraction)
        report.compare(f"{places}, forces alone", "Brady & Durlofsky", expected, found["equilibrium, forces alone"][fraction])
    return report


if __name__ == "__main__":
    main(draw)
