"""Magnetic dipoles: cubic lattices, conducting lattices, forces and torques of pairs, near contact, and a doublet in a rotating field."""

import csv
import math
import sys

import numpy as np
from support.page import table, write_section
from support.program import results

TOLERANCE = 1e-4
# Errors of forces and torques at a distance, relative to point dipoles: images in the box contribute as (r/L)^5.
TOLERATED = 2e-3
# Error of the critical frequency: the doublet is nearly rigid.
CRITICAL = 0.02


def series(scene):
    """The time series of a run, by the names of its columns."""
    with results(scene) as out, open(out / "observables.csv") as file:
        rows = list(csv.reader(file))
    return {name: np.array([float(row[k]) for row in rows[1:]]) for k, name in enumerate(rows[0])}


def scene(edge, species, positions, field="", keys="", steps=1, step=1e-6, hydrodynamics=""):
    places = ", ".join(str([float(x) for x in place]) for place in positions)
    return f"""box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles = {{ initial = "positions", positions = [{places}] }}
hydrodynamics = {{ tolerance = {TOLERANCE}{hydrodynamics} }}
time = {{ step = {step}, steps = {steps} }}
output = {{ trajectory_every = 0, checkpoint_every = 0, observables_every = 1 }}
{field}
{keys}
""" + "".join(f"[[species]]\nname = \"{name}\"\nradius = 1.0\ncount = {count}\n{more}\n" for name, count, more in species)


def lattices():
    rows, good = [], True
    # Farther apart than near pairs.
    for fraction in (0.02, 0.04, 0.06):
        edge = (4 / 3 * math.pi / fraction) ** (1 / 3)
        sites = [np.array([i, j, k]) * edge + 0.3 for i in range(2) for j in range(2) for k in range(2)]
        for chi in (-0.5, 1.0, 10.0, 1000.0):
            species = [("one", 8, f"magnetic_susceptibility = {chi}")]
            found = series(scene(2 * edge, species, sites, "magnetic = { field = [0.0, 0.0, 1.0] }"))
            mu = 1 + found["magnetic_moment_z[one]"][0] / edge**3
            beta = chi / (chi + 3)
            exact = (1 + 2 * fraction * beta) / (1 - fraction * beta)
            rows.append([f"{fraction}", f"{chi:g}", f"{mu:.6f}", f"{exact:.6f}", f"{mu / exact - 1:+.1e}"])
            print(*rows[-1], flush=True)
            good &= abs(mu / exact - 1) < TOLERANCE
    lines = [
        "Spheres at the sites of a simple cubic lattice: effective permeability \\\\(1 + \\bar M / H_0\\\\), and",
        "\\\\((1 + 2\\phi\\beta) / (1 - \\phi\\beta)\\\\), exact for dipoles in cubic lattices.",
        "",
        *table(["volume fraction", "susceptibility", "permeability", "exact", "error"], rows),
    ]
    return "### Cubic lattices", lines, good


def sangani_acrivos(fraction, chi):
    """Conductivity of a simple cubic lattice of spheres over that of the matrix (Sangani & Acrivos, Proc. R. Soc. Lond. A 386,
    263, 1983, their coefficients for c1 to c6), whose error grows towards contact."""
    c1, c2, c3, c4, c5, c6 = 1.3047, 0.2305, 0.4054, 0.07231, 0.1526, 0.0105
    response = [None, *(chi / (chi + 1 + 2 * n / (2 * n - 1)) for n in range(1, 6))]
    near = c1 * response[2] * fraction ** (10 / 3) * (1 + c2 * response[3] * fraction ** (11 / 3)) / (1 - c3 * response[2] * fraction ** (7 / 3))
    far = c4 * response[3] * fraction ** (14 / 3) + c5 * response[4] * fraction**6 + c6 * response[5] * fraction ** (22 / 3)
    return 1 - 3 * fraction / (-1 / response[1] + fraction + near + far)


def conducting():
    rows, good = [], True
    for fraction in (0.1, 0.2, 0.3, 0.4, 0.45):
        edge = (4 / 3 * math.pi / fraction) ** (1 / 3)
        sites = [np.array([i, j, k]) * edge + 0.3 for i in range(4) for j in range(4) for k in range(4)]
        for chi in (1.0, 10.0, 1e6):
            species = [("one", 64, f"magnetic_susceptibility = {chi}")]
            found = series(scene(4 * edge, species, sites, "magnetic = { field = [0.0, 0.0, 1.0] }"))
            mu = 1 + found["magnetic_moment_z[one]"][0] / edge**3
            beta = chi / (chi + 3)
            garnett, exact = (1 + 2 * fraction * beta) / (1 - fraction * beta), sangani_acrivos(fraction, chi)
            rows.append([f"{fraction}", f"{chi:g}", f"{mu:.4f}", f"{exact:.4f}", f"{mu / exact - 1:+.1e}", f"{garnett / exact - 1:+.1e}"])
            print(*rows[-1], flush=True)
            # The corrections of pairs improve on dipoles.
            good &= abs(mu - exact) < max(0.5 * abs(garnett - exact), 1e-3 * exact)
    lines = [
        "The same lattices up to near contact, where dipoles alone (Maxwell-Garnett) are not enough and pairs have their",
        "corrections in the applied field: permeability, which is the conductivity of a lattice of conducting spheres too, and",
        "the series of Sangani & Acrivos (Proc. R. Soc. Lond. A 386, 263, 1983), which continues that of McPhedran & McKenzie",
        "(Proc. R. Soc. Lond. A 359, 45, 1978) and does not converge at contact, at a volume fraction of 0.52.",
        "",
        *table(["volume fraction", "susceptibility", "permeability", "series", "error", "error of dipoles alone"], rows),
    ]
    return "### Conducting lattices", lines, good


def pair(distance, field, moments, pulls=None, radius=1.0):
    """Relative velocity along x of two spheres a distance apart along x, the second of a given radius, under a field or
    pulls."""
    edge = 60.0
    middle = np.full(3, edge / 2)
    places = [middle, middle + [distance, 0, 0]]
    species = [(name, 1, more) for name, more in zip(("one", "other"), pulls or moments)]
    text = scene(edge, species, places, field, hydrodynamics=", lubrication = false")
    first, last = text.rsplit("radius = 1.0", 1)
    found = series(f"{first}radius = {radius}{last}")
    velocity = [found[f"mean_velocity_x[{name}]"][0] for name in ("one", "other")]
    return velocity[1] - velocity[0]


def forces():
    rows, good = [], True
    for distance in (2.001, 2.1, 3.0, 5.0, 8.0):
        for name, axis, factor in (("in line", [1.0, 0.0, 0.0], -2.0), ("side by side", [0.0, 0.0, 1.0], 1.0)):
            moment = f'orientation = "aligned"\norientation_axis = {axis}\nmagnetic_moment = 5.0'
            field = "magnetic = { field = [0.0, 0.0, 0.0], permeability = 2.0, tolerance = 1e-6 }"
            moved = pair(distance, field, [moment, moment])
            unit = pair(distance, "", None, ["force = [-1.0, 0.0, 0.0]", "force = [1.0, 0.0, 0.0]"])
            force, exact = moved / unit, factor * 3 * 2.0 * 25.0 / (4 * math.pi * distance**4)
            rows.append([f"{distance:g}", name, f"{force:.5f}", f"{exact:.5f}", f"{force / exact - 1:+.1e}"])
            print(*rows[-1], flush=True)
            good &= abs(force / exact - 1) < TOLERATED
    lines = [
        "Two permanent moments of 5 at a distance, with \\\\(\\mu_0 = 2\\\\): the force, from the velocity over that by unit forces,",
        "and that of points, \\\\(-3 \\mu_0 m^2 / 2\\pi r^4\\\\) in line and minus half of it side by side.",
        "",
        *table(["distance", "moments", "force", "points", "error"], rows),
    ]
    return "### Forces of pairs", lines, good


def torque(distance):
    """Angular velocity of the first of two spheres apart along x, its moment along z, the other's along x."""
    edge = 60.0
    middle = np.full(3, edge / 2)
    oriented = 'orientation = "aligned"\norientation_axis = {}\nmagnetic_moment = 5.0'
    species = [("one", 1, oriented.format([0.0, 0.0, 1.0])), ("other", 1, oriented.format([1.0, 0.0, 0.0]))]
    step = 1e-3
    field = "magnetic = { field = [0.0, 0.0, 0.0], permeability = 2.0 }"
    found = series(scene(edge, species, [middle, middle + [distance, 0, 0]], field, step=step, steps=1))
    # The axis turns from z by the angle w t about y.
    return found["orientation_x[one]"][1] / step


def torques():
    rows, good = [], True
    for distance in (3.0, 5.0, 8.0):
        # H = 2 m x / (4 pi r^3) at the first sphere: T = mu_0 m z cross H = mu_0 m H y; it turns at T / (8 pi mu a^3).
        exact = 2.0 * 5.0 * 2 * 5.0 / (4 * math.pi * distance**3)
        found = torque(distance) * 8 * math.pi
        rows.append([f"{distance:g}", f"{found:.5f}", f"{exact:.5f}", f"{found / exact - 1:+.1e}"])
        print(*rows[-1], flush=True)
        good &= abs(found / exact - 1) < 2 / distance**3 + TOLERATED
    lines = [
        "A moment across the line of centres in the field of another along it: the torque, \\\\(8\\pi\\mu a^3\\\\) times the angular",
        "velocity, and that of points, \\\\(\\mu_0 m^2 / 2\\pi r^3\\\\). The flow of the forces and of the other sphere's rotation adds",
        "to the angular velocity.",
        "",
        *table(["distance", "torque", "points", "error"], rows),
    ]
    return "### Torques of pairs", lines, good


def multipole_moment(chi, distance, order, other=1.0, highest=120):
    """Sum of the moments over 4 pi H of two spheres with the radii 1 and `other`, from all multipoles up to `highest` about
    both centres: field along the line of centres for order 0, across for order 1."""
    degrees = np.arange(1, highest + 1)
    lgamma = np.vectorize(math.lgamma)
    l, n = np.meshgrid(degrees, degrees)
    sizes = lgamma(l + n + 1) - lgamma(l - order + 1) - lgamma(n + order + 1)
    system, right = np.eye(2 * highest), np.zeros(2 * highest)
    radii = (1.0, other)
    for i in (0, 1):
        response = degrees * chi / (degrees * (chi + 2) + 1)
        # Multipoles over the powers of their radii, which keeps them of one size.
        scaled = sizes + n * np.log(radii[i] / distance) + (l + 1) * np.log(radii[1 - i] / distance)
        block = response[:, None] * np.exp(scaled)
        system[i * highest : (i + 1) * highest, (1 - i) * highest : (2 - i) * highest] = block if order else -block
        right[i * highest] = response[0] * radii[i]
    found = np.linalg.solve(system, right)
    return sum(found[i * highest] * radii[i] ** 2 for i in (0, 1))


def exact_force(chi, distance, order, other=1.0):
    """Force over mu_0 H^2 a^2 between two spheres in a field, positive if they repel each other: 2 pi dA/dr."""
    step = 1e-4 * (distance - 1 - other)
    after, before = (multipole_moment(chi, distance + sign * step, order, other) for sign in (1, -1))
    return 2 * math.pi * (after - before) / (2 * step)


def contact():
    rows, good = [], True
    for radius, chi in ((radius, chi) for radius in (1.0, 2.0) for chi in (0.3, 1.0, 10.0, 1e6)):
        row = [f"1:{radius:g}", f"{chi:g}"]
        for axis, order in (([1.0, 0.0, 0.0], 0), ([0.0, 0.0, 1.0], 1)):
            for gap in (2.0, 0.5, 0.1, 0.01):
                distance = 1 + radius + gap
                moment = f"magnetic_susceptibility = {chi}"
                moved = pair(distance, f"magnetic = {{ field = {axis} }}", [moment, moment], radius=radius)
                pulls = ["force = [-1.0, 0.0, 0.0]", "force = [1.0, 0.0, 0.0]"]
                unit = pair(distance, "", None, pulls, radius)
                ratio = moved / unit / exact_force(chi, distance, order, radius)
                row.append(f"{ratio:.3f}")
                good &= abs(ratio - 1) < (0.02 if gap > 1 else 5e-3)
        rows.append(row)
        print(*row, flush=True)
    lines = [
        "Two susceptible spheres in a field: the force over the exact one, by a solution with 120 multipoles of each sphere.",
        "Gaps are over the first radius.",
        "",
        *table(
            [
                "radii",
                "susceptibility",
                *(f"{name}, gap {gap}" for name in ("in line", "side by side") for gap in ("2", "0.5", "0.1", "0.01")),
            ],
            rows,
        ),
    ]
    return "### Near contact", lines, good


def critical_frequency(edge, places, chi, field):
    """Frequency up to which two bonded spheres along x follow a rotating field: largest torque over resistance."""
    distance = places[1][0] - places[0][0]
    pulls = ["force = [0.0, -1.0, 0.0]", "force = [0.0, 1.0, 0.0]"]
    unit = series(scene(edge, [(name, 1, more) for name, more in zip(("one", "other"), pulls)], places))
    # Angular velocity over torque: that of the couple of two unit forces, the distance.
    mobility = (unit["mean_velocity_y[other]"][0] - unit["mean_velocity_y[one]"][0]) / distance / distance
    along, across = (4 * math.pi * multipole_moment(chi, distance, order) for order in (0, 1))
    return 0.5 * field**2 * (along - across) * mobility


def rotating(ratio, distance=2.05, chi=1.0, field=1.0):
    """Mean angular velocity of a bonded doublet over the critical one, for a field at `ratio` times the critical frequency."""
    edge = 40.0
    middle = np.full(3, edge / 2)
    places = [middle - [distance / 2, 0, 0], middle + [distance / 2, 0, 0]]
    bond = f"bonds = [{{ pairs = [[0, 1]], stiffness = 2000.0, length = {distance} }}]"
    critical = critical_frequency(edge, places, chi, field)
    frequency = ratio * critical
    periods, steps = 12, 1200
    species = [("one", 2, f"magnetic_susceptibility = {chi}")]
    text = scene(
        edge,
        species,
        places,
        f"magnetic = {{ field = [{field}, 0.0, 0.0], frequency = {frequency}, rotation_axis = [0.0, 0.0, 1.0] }}",
        bond,
        steps=steps,
        step=periods * 2 * math.pi / frequency / steps,
    ).replace("trajectory_every = 0", "trajectory_every = 5").replace("time = {", 'time = { integrator = "implicit",')
    import h5py

    with results(text) as out, h5py.File(out / "trajectory.h5") as file:
        group = file["particles/all"]
        times, x = group["position/time"][:], group["position/value"][:]
    apart = x[:, 1] - x[:, 0]
    apart -= edge * np.round(apart / edge)
    angle = np.unwrap(np.arctan2(apart[:, 1], apart[:, 0]))
    if ratio < 1:
        return (angle[-1] - angle[len(angle) // 2]) / (times[-1] - times[len(times) // 2]) / critical, critical
    # Whole periods of the slip of the doublet behind the field.
    slip = frequency * times - angle
    whole = math.pi * np.floor((slip[-1] - slip[0]) / math.pi)
    end = np.interp(slip[0] + whole, slip, times)
    return (frequency - whole / (end - times[0])) / critical, critical


def doublets():
    rows, good = [], True
    for ratio in (0.5, 0.9, 1.1, 1.5, 3.0):
        found, critical = rotating(ratio)
        exact = ratio if ratio < 1 else ratio - math.sqrt(ratio**2 - 1)
        rows.append([f"{ratio:g}", f"{found:.4f}", f"{exact:.4f}"])
        print(*rows[-1], flush=True)
        good &= abs(found - exact) < CRITICAL
    lines = [
        "Two susceptible spheres (\\\\(\\chi = 1\\\\)) bonded at a distance \\\\(r = 2.05 a\\\\) in a rotating field. With the angle",
        "\\\\(\\theta\\\\) between the doublet and the field, the torque is \\\\(T \\sin 2\\theta\\\\) with",
        "\\\\(T = \\mu_0 H_0 (m_\\parallel - m_\\perp) / 2\\\\), where the moments of both in fields along and across the doublet are those of",
        "120 multipoles of each sphere. Up to the critical frequency, \\\\(T\\\\) over the rotational resistance of the doublet, it",
        "follows the field; beyond it, it slips at the mean angular velocity",
        "\\\\(\\omega - (\\omega^2 - \\omega_c^2)^{1/2}\\\\). The resistance is that under two opposite forces in the same box.",
        "",
        *table(["frequency over the critical one", "angular velocity over it", "exact"], rows),
    ]
    return "### A doublet in a rotating field", lines, good


if __name__ == "__main__":
    parts = [lattices, conducting, forces, torques, contact, doublets]
    found = [part() for part in parts]
    write_section("dipoles.md", "dipoles", "Validation", [line for title, lines, _ in found for line in (title, "", *lines, "")])
    failed = [title for title, _, good in found if not good]
    sys.exit(f"out of tolerance: {', '.join(failed)}" if failed else 0)
