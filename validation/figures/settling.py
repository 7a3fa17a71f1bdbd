"""Settling suspensions, figures 1 and 19 to 25 of Abbas et al. (2006): scenes and evaluation.

Lengths are in units of the (small) radius, velocities of the Stokes velocity of a sphere of species 1; viscosity 1. Species
settle along -z."""

import sys

from runs import ROOT, WEIGHT, Run, kept, over_seeds, volume
from theory import periodic_images

sys.path.insert(0, str(ROOT / "validation"))
from support import hard_spheres

# Stokes times, those before sampling, seeds, spheres of the scarcer species, smallest edge of the box, samples of static positions.
SIZE = {
    "quick": {"time": 30.0, "settled": 5.0, "seeds": 1, "scarce": 8, "least": 20.0, "placings": 12},
    "full": {"time": 400.0, "settled": 20.0, "seeds": 1, "scarce": 100, "least": 48.0, "placings": 12},
}
# Step between samples in Stokes times, divided so that the errors of positions, in radii, meet the tolerance.
STEP, TOLERANCE = 0.5, 1e-2
# Force at contact over the weight of a small sphere and the squared harmonic mean radius, for equal and for unlike spheres; the gap
# at which it vanishes, and a shorter one.
BARRIER, BARRIER_OF_UNLIKE, RANGE, SHORT_RANGE = 2.0, 4.0, 0.2, 0.05


def scene(species, edge, mode, seed, time=None, reach=RANGE, stronger=1.0):
    """A settling suspension of species given as (name, radius, density difference, volume fraction or count), whose barrier
    vanishes at a gap of `reach` and is `stronger` times as strong as the default."""
    size = SIZE[mode]
    time = size["time"] if time is None else time
    alike = all(radius == 1 and density > 0 for _, radius, density, _ in species)
    strength = stronger * (BARRIER if alike else BARRIER_OF_UNLIKE)

    def kind(name, radius, density, amount):
        how_many = {"count": amount} if isinstance(amount, int) else {"volume_fraction": amount}
        return {"name": name, "radius": radius, "force": [0.0, 0.0, -WEIGHT * density * radius**3], **how_many}

    return {
        "title": "Settling suspension",
        "seed": seed,
        "box": {"edges": [edge] * 3},
        "fluid": {"viscosity": 1.0},
        "species": [kind(*one) for one in species],
        "particles": {"initial": "random", "minimum_gap": 0.01},
        "repulsion": {"strength": strength * WEIGHT, "range": reach, "radius_power": 2},
        "hydrodynamics": {"tolerance": 1e-2},
        "time": {"step": STEP, "steps": round(time / STEP), "integrator": "implicit", "tolerance": TOLERANCE},
        "output": {"trajectory_every": 0, "observables_every": 1, "checkpoint_every": 40},
        "statistics": {"every": 1, "from": min(size["settled"], time), "axis": "z"},
    }


def edge_for(species, mode):
    """The side of a box in which the scarcest species, by (name, radius, density difference, volume fraction), has enough
    spheres."""
    size = SIZE[mode]
    needed = max(size["scarce"] * volume(radius) / phi for _, radius, _, phi in species)
    return max(needed ** (1 / 3), size["least"])


def name_of(species):
    return "-".join(f"{radius:g}_{density:g}_{amount:g}" for _, radius, density, amount in species)


def dynamic(species, mode, edge=None, time=None, reach=RANGE, stronger=1.0):
    """Runs that differ in their seeds."""
    edge = edge or edge_for(species, mode)
    which = name_of(species) + (f"-{reach:g}" if reach != RANGE else "") + (f"-barrier-{stronger:g}" if stronger != 1 else "")
    return [
        Run(f"settling/{mode}-{which}-{edge:.3g}-{seed}", scene(species, edge, mode, seed, time, reach, stronger))
        for seed in range(1, SIZE[mode]["seeds"] + 1)
    ]


def static(species, mode, multipoles="dipole"):
    """Static configurations: spheres of radius 1 at the positions of hard spheres at equilibrium."""
    least = edge_for(species, mode)
    counts = [round(phi * least**3 / volume(1)) for *_, phi in species]
    total = sum(phi for *_, phi in species)

    def run(seed):
        centres, edge = places(sum(counts), total, seed)
        text = scene([(*one[:3], count) for one, count in zip(species, counts)], edge, mode, seed, 0.0)
        text["particles"] = {"initial": "positions", "positions": centres}
        text["hydrodynamics"]["multipoles"] = multipoles
        return Run(f"settling/{mode}-{multipoles}-{name_of(species)}-{seed}", text)

    return [run(seed) for seed in range(101, 101 + SIZE[mode]["placings"])]


def places(count, fraction, seed):
    """Centres, and the edge of their box."""

    def compute():
        centres, edge = hard_spheres.equilibrium(count, fraction, seed, sweeps=150)
        return centres.round(6).tolist(), edge

    return kept(f"hard-spheres-{count}-{fraction:g}-{seed}", compute)


def settled(runs, species, place, edge, rigid=True):
    """The mean downward velocity of a species, by its index in the list, over its Stokes velocity: in the box, and corrected for the
    periodic images, both with errors. Spheres that are not rigid do not increase the viscosity."""
    name, radius, density, _ = species[place]
    stokes = density * radius**2
    value, error = (number / stokes for number in over_seeds(runs, downwards(name)))
    return (value, abs(error)), (value + periodic_images(species, edge, rigid)[place], abs(error))


def downwards(name):
    """Function of a run: the mean velocity of a species along -z, with its error."""

    def of(run):
        value, error = run.summary()["mean_velocity_z", name]
        return -value, error

    return of


# The cases of each figure: Stokes times are those of species 1.
MONODISPERSE = (0.02, 0.05, 0.10, 0.15, 0.20)
TOTALS = {"quick": (0.02, 0.06, 0.10, 0.15), "full": (0.01, 0.02, 0.04, 0.06, 0.08, 0.10, 0.12, 0.15)}
WIDTHS = {"quick": (20.0, 28.0, 40.0), "full": (24.0, 32.0, 48.0)}
SECOND = {"quick": (0.02, 0.05, 0.10), "full": (0.01, 0.02, 0.04, 0.06, 0.08, 0.10, 0.13)}
PAIRS = {
    "quick": ((0.03, 0.03), (0.06, 0.06), (0.10, 0.10)),
    "full": ((0.02, 0.02), (0.04, 0.04), (0.06, 0.06), (0.08, 0.08), (0.10, 0.10), (0.05, 0.15), (0.02, 0.15), (0.12, 0.12)),
}
# Long enough for streams to form.
STREAMS_TIME = {"quick": 120.0, "full": 400.0}
TEST_RATIOS = {"quick": (1.2, 2.0, 2.8), "full": (1.0, 1.2, 1.6, 2.0, 2.4, 2.8)}
TEST_TIME = {"quick": 60.0, "full": 400.0}
# One test sphere as in the paper; several in the same box for quick runs.
TESTS = {"quick": 4, "full": 1}


def equal_spheres(phi):
    return [("sphere", 1.0, 1.0, phi)]


def two_sizes(ratio, phi):
    return [("small", 1.0, 1.0, phi / 2), ("large", ratio, 1.0, phi / 2)]


def two_densities(density_ratio, second, first=0.02):
    return [("first", 1.0, 1.0, first), ("second", 1.0, density_ratio, second)]


def segregation(first, second, mode, stronger=1.0):
    """Spheres that sink and spheres that rise; figure 24 uses the same runs."""
    return dynamic(two_densities(-1.0, second, first), mode, time=segregation_time(first, second), stronger=stronger)


def segregation_time(first, second):
    """Stokes times for streams to show, which begin late near the limit of 15% in total."""
    return 600.0 if 0.15 < first + second < 0.18 else 400.0


def test_sphere(stokes_ratio, mode):
    """Spheres of the density of the others and so large that their Stokes velocity is `stokes_ratio`, in 20% of others."""
    species = [("others", 1.0, 1.0, 0.20), ("test", round(stokes_ratio**0.5, 6), 1.0, TESTS[mode])]
    return dynamic(species, mode, edge=SIZE[mode]["least"], time=TEST_TIME[mode])


def fluctuation(name, component):
    """Of a run: the standard deviation of a species' velocity, with its error."""

    def of(run):
        value, error = run.summary()[f"T_{component}", name]
        return value**0.5, 0.5 * error / value**0.5

    return of
