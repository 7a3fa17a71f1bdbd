"""Sheared suspensions, figures 5 to 18 of Abbas et al. (2006): scenes and evaluation.

Lengths are in units of the (small) radius, times of the inverse shear rate; viscosity 1."""

from runs import Run, volume

# The force at contact that keeps spheres of radius 1 apart at all volume fractions here, and the gap at which it vanishes: that
# of the paper's figures 4 and 10, without and with lubrication.
BARRIER, RANGE, RANGE_WITH_LUBRICATION = 80.0, 0.2, 0.05

# Strain between samples, divided so that the errors of positions, in radii, meet the tolerance.
STEP, TOLERANCE = 0.1, 3e-3
# Particles at each volume fraction or edge of the box, strains of equal spheres and of two sizes, seeds of equal spheres, of
# those with lubrication, and of two sizes.
SIZE = {
    "quick": {"particles": 150, "edge": 22.0, "strains": (80.0, 40.0), "seeds": 2, "lubricated": 1, "mixed": 2},
    "full": {"particles": None, "edge": 48.0, "strains": None, "seeds": 1, "lubricated": 1, "mixed": 1},
}
# Strains before sampling.
SETTLED = 10.0
FRACTIONS = (0.01, 0.05, 0.10, 0.15, 0.20)
# Time after which correlations have decayed (figure 8) and motion is diffusive (figure 9).
DIFFUSIVE = 8.0


def scene(species, edge, mode, seed, lubrication=False):
    """A sheared suspension of species given as (name, radius, volume fraction)."""
    size = SIZE[mode]
    fraction = sum(phi for _, _, phi in species)
    largest = max(radius for _, radius, _ in species)
    # The paper's length by default.
    strain = size["strains"][largest > 1] if size["strains"] else 100 * fraction ** (-1 / 3)
    return {
        "title": "Sheared suspension",
        "seed": seed,
        "box": {"edges": [edge] * 3},
        "fluid": {"viscosity": 1.0},
        "species": [{"name": name, "radius": radius, "volume_fraction": phi} for name, radius, phi in species],
        "particles": {"initial": "random", "minimum_gap": 0.05},
        "flow": {"kind": "shear", "rate": 1.0, "lees_edwards": True},
        "repulsion": {"strength": BARRIER * largest, "range": RANGE_WITH_LUBRICATION if lubrication else RANGE},
        "hydrodynamics": {"tolerance": 1e-2, "lubrication": lubrication},
        "time": {"step": STEP, "duration": strain, "integrator": "implicit", "tolerance": TOLERANCE},
        "output": {"trajectory_every": 0, "observables_every": 1, "checkpoint_every": 100},
        "statistics": {"every": 1, "from": SETTLED, "diffusive_from": DIFFUSIVE},
    }


def monodisperse(fraction, mode, lubrication=False):
    """The runs of equal spheres at a volume fraction, which differ in their seeds."""
    size = SIZE[mode]
    edge = size["edge"] if size["particles"] is None else (size["particles"] * volume(1) / fraction) ** (1 / 3)
    kind, seeds = ("lubrication", size["lubricated"]) if lubrication else ("barrier", size["seeds"])
    species = [("sphere", 1.0, fraction)]
    return [
        Run(f"shear/{mode}-{kind}-{fraction:g}-{seed}", scene(species, edge, mode, seed, lubrication))
        for seed in range(1, seeds + 1)
    ]


def bidisperse(ratio, large_to_small, mode, fraction=0.10):
    """The runs of spheres of radii 1 and `ratio` at a ratio of their volume fractions."""
    size = SIZE[mode]
    large = fraction * large_to_small / (1 + large_to_small)
    species = [("small", 1.0, fraction - large), ("large", ratio, large)]
    return [
        Run(f"shear/{mode}-{ratio:g}-{large_to_small:.3g}-{seed}", scene(species, size["edge"], mode, seed))
        for seed in range(1, size["mixed"] + 1)
    ]


def tensor(component, name="sphere", radius=1.0, what="T"):
    """Function of a run: a component of the fluctuation tensor of a species, over `(rate radius)^2`, or over `rate^2` for `w`."""

    def of(run):
        value, error = run.summary()[f"{what}_{component}", name]
        scale = radius**2 if what == "T" else 1.0
        return value / scale, error / scale

    return of


def diffusivity(axis, name="sphere", radius=1.0, by="slope"):
    """Function of a run: the diffusivity of a species along an axis, over `rate radius^2`."""

    def of(run):
        value, error = run.summary()[f"D_{by}_{axis}", name]
        return value / radius**2, error / radius**2

    return of


def quotient(above, below):
    """Function of a run: the quotient of two quantities."""

    def of(run):
        (a, da), (b, db) = above(run), below(run)
        return a / b, abs(a / b) * ((da / a) ** 2 + (db / b) ** 2) ** 0.5

    return of


# The pairs of species of figures 11 to 18.
RATIOS = {"quick": (1.5, 2.0, 2.5), "full": (1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5)}
MIXTURES = (1 / 9, 1 / 3, 1.0, 3.0, 9.0)
# Ratios of radii for which the mixtures are varied.
MIXED = {"quick": (2.0,), "full": (2.0, 2.5)}


def by_ratio(mode):
    """Ratios of radii and their runs, equal volumes of both species."""
    return {ratio: bidisperse(ratio, 1.0, mode) for ratio in RATIOS[mode]}


def by_mixture(ratio, mode):
    """Ratios of volume fractions and their runs."""
    return {mixture: bidisperse(ratio, mixture, mode) for mixture in MIXTURES}


def by_fraction(mode, lubrication=False):
    """Volume fractions and the runs of equal spheres."""
    return {fraction: monodisperse(fraction, mode, lubrication) for fraction in FRACTIONS}
