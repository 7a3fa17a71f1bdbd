"""Common parts of the figures of bidisperse sheared suspensions."""

import shear
from report import Report
from runs import make, over_seeds


def lines(report, mode, quantity):
    """Lines for equal spheres alone at 10% and 5%."""
    alone = {phi: shear.monodisperse(phi, mode) for phi in (0.10, 0.05)}
    make(sum(alone.values(), []))
    for (phi, runs), style in zip(alone.items(), ("-", "--")):
        value, _ = over_seeds(runs, quantity())
        report.panels[0].axhline(value, color="0.5", linestyle=style, label=f"one size, $\\phi$ = {phi:.0%}")
        report.curves.append((f"one size at {phi:g}", phi, *over_seeds(runs, quantity())))
    return {phi: over_seeds(runs, quantity()) for phi, runs in alone.items()}


def both_species(name, mode, title, quantity, against):
    """A quantity of small and large spheres in their own units, against the ratio of radii or of concentrations.
    `quantity(species, radius)` evaluates it for a run. Returns the report and the points by species."""
    cases = shear.by_ratio(mode) if against == "ratio" else shear.by_mixture(2.0, mode)
    make(sum(cases.values(), []))
    report = Report(name, mode, title)
    found = {}
    for species, style in (("small", {"marker": "s"}), ("large", {"marker": "o", "fillstyle": "none", "linestyle": "--"})):
        radius = {key: 1.0 if species == "small" else key if against == "ratio" else 2.0 for key in cases}
        found[species] = {key: over_seeds(runs, quantity(species, radius[key])) for key, runs in cases.items()}
        report.points(f"{species} spheres", list(cases), list(found[species].values()), **style)
    return report, found


def x_axis(against):
    """Label and scale of the axis."""
    return (r"$\lambda$", {}) if against == "ratio" else (r"$\phi_2/\phi_1$", {"xscale": "log"})
