"""The global and mean diffusion coefficients of figures 16 to 18, eqs. (18) and (19)."""

import shear
from runs import make, over_seeds


def global_coefficient(run):
    """D_g of a run, over `rate <a>^2`."""
    return run.summary()["D_global_y", "all"]


def alone(mode):
    """The coefficient of equal spheres at 10%."""
    runs = shear.monodisperse(0.10, mode)
    make(runs)
    return over_seeds(runs, shear.diffusivity("y"))


def mean_coefficient(mode):
    """<D> of a run, in units of the coefficients of each size alone at the same concentration, which are equal when scaled."""
    one, _ = alone(mode)

    def of(run):
        summary = run.summary()
        value, error = summary["D_global_y", "all"]
        species = [(summary["radius", s][0], summary["volume_fraction", s][0]) for s in ("small", "large")]
        total = sum(phi for _, phi in species)
        radius = sum(a * phi for a, phi in species) / total
        scale = radius**2 / (one * sum(a * a * phi for a, phi in species) / total)
        return value * scale, error * scale

    return of
