"""Chains of 1,320 paramagnetic beads in rotating fields: shorter chains at low frequencies, sheets at high ones."""

import numpy as np
from dipoles import critical_frequency
from support.page import table, write_section
from support.program import results

COUNT, LENGTH, FRACTION = 1320, 30, 0.003
EDGE = (COUNT * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
SUSCEPTIBILITY, FIELD = 3.0, 4.0
# Centres of neighbours in the chains at the start, and least distance of two chains.
SPACING, APART = 2.1, 6.0
DURATION = 800.0
# Frequencies over that up to which a doublet follows the field.
RATIOS = (0.1, 0.5, 3.0, 10.0)
# Neighbours are nearer than this: the gap at which the repulsion balances the mean attraction, and some more.
NEAR = 2.6
# Clusters of at least this many beads have a shape.
LARGE = 6


def nearest(vectors):
    return vectors - EDGE * np.round(vectors / EDGE)


def chains():
    """Straight chains along x at random places."""
    random, places = np.random.default_rng(1), np.zeros((0, 3))
    while len(places) < COUNT:
        chain = random.random(3) * EDGE + np.outer(np.arange(LENGTH) * SPACING, [1, 0, 0])
        distances = np.linalg.norm(nearest(chain[:, None] - places[None]), axis=2)
        if not np.any(distances < APART):
            places = np.vstack([places, chain])
    return (places % EDGE).round(4).tolist()


def clusters(places):
    """Members of each cluster as positions that are not wrapped, and the number of neighbours of each bead."""
    apart = nearest(places[:, None] - places[None])
    near = np.linalg.norm(apart, axis=2) < NEAR
    np.fill_diagonal(near, False)
    left, found = set(range(len(places))), []
    while left:
        first = left.pop()
        members, waiting = {first: places[first]}, [first]
        while waiting:
            one = waiting.pop()
            for other in left.intersection(np.flatnonzero(near[one])):
                left.remove(other)
                members[other] = members[one] - apart[one, other]
                waiting.append(other)
        found.append(np.array(list(members.values())))
    return found, near.sum(axis=1)


def shape(cluster):
    """Width and thickness over length, by the radii of gyration, and the component of the thin axis along the axis of the
    field's rotation."""
    squares, axes = np.linalg.eigh(np.cov(cluster.T))
    thickness, width, length = np.sqrt(np.maximum(squares, 0))
    return width / length, thickness / length, abs(axes[2, 0])


def last_frame(frequency, places):
    import h5py

    scene = f"""seed = 1
box.edges = [{EDGE}, {EDGE}, {EDGE}]
fluid.viscosity = 1.0
particles = {{ initial = "positions", positions = {places} }}
repulsion = {{ strength = 60.0, range = 0.4 }}
hydrodynamics = {{ tolerance = 1e-2, multipoles = "monopole" }}
time = {{ step = 0.05, duration = {DURATION}, order = 2 }}
magnetic = {{ field = [{FIELD}, 0.0, 0.0], frequency = {frequency}, rotation_axis = [0.0, 0.0, 1.0] }}
output = {{ trajectory_every = {round(DURATION / 0.05)}, observables_every = 1000, checkpoint_every = 0 }}
species = [{{ name = "beads", radius = 1.0, count = {COUNT}, magnetic_susceptibility = {SUSCEPTIBILITY} }}]
"""
    with results(scene) as out, h5py.File(out / "trajectory.h5") as file:
        return file["particles/all/position/value"][-1]


def main():
    places, middle = chains(), 20.0
    doublet = [[middle, middle, middle], [middle + SPACING, middle, middle]]
    critical = critical_frequency(2 * middle, doublet, SUSCEPTIBILITY, FIELD)
    rows, good = [], True
    for ratio in RATIOS:
        found, neighbours = clusters(last_frame(ratio * critical, places))
        sizes = np.array([len(cluster) for cluster in found])
        width, thickness, normal = np.mean([shape(cluster) for cluster in found if len(cluster) >= LARGE], axis=0)
        many = np.mean(neighbours > 2)
        numbers = [np.sum(sizes**2) / COUNT, neighbours.mean(), many, width, thickness, normal]
        rows.append([f"{ratio:g}", f"{numbers[0]:.1f}", *(f"{number:.2f}" for number in numbers[1:])])
        print(*rows[-1], flush=True)
        good &= thickness < 0.05 and normal > 0.95 and (width > 0.15 if ratio > 1 else width < 0.1 and many < 0.05)
    lines = [
        f"{COUNT:,} paramagnetic beads at {FRACTION:.1%} by volume, in straight chains of {LENGTH} beads at the start, in a field that",
        f"rotates in their plane, after {DURATION:g} units of time, with the radius and the viscosity as units. Flow and repulsion of",
        f"forces alone. Frequencies are over that up to which two bonded beads at a distance of {SPACING:g} radii follow the field,",
        f"{critical:.3f}. The mean size of a bead's cluster, the mean number of neighbours with centres nearer than {NEAR:g} radii, and",
        f"the share of beads with more than two. For clusters of {LARGE} beads and more: width and thickness over length, by the radii of",
        "gyration, and the component of the thin axis along the axis of rotation. Below the critical frequency chains break into",
        "shorter ones. Above it they collapse into sheets, one bead thick, in the plane of the field.",
        "",
        *table(["frequency", "size", "neighbours", "more than two", "width", "thickness", "thin axis"], rows),
    ]
    write_section("dipoles.md", "magnetic-sheets", "Chains and sheets", lines)
    if not good:
        raise SystemExit("failed: see the table")


if __name__ == "__main__":
    main()
