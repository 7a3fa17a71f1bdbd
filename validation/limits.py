"""Limits of lubricated FCM: many-body effects that neither the multipoles of the far field nor pairs include,
against published values.

Random hard spheres settle, or are each moved by a separate force: the settling velocity over that of one sphere is the
fit of Riest, Eckert, Richtering & Naegele, Soft Matter 11, 2821 (2015), to the simulations of Abade et al., J. Chem.
Phys. 132, 014503 (2010),

    1 - 6.5464 phi (1 - 3.348 phi + 7.426 phi^2 - 10.034 phi^3 + 5.882 phi^4);

the self-mobility is that of `high_frequency_viscosity.py`. A box of N spheres settles too slowly by 1.7601 (phi/N)^(1/3) S(0) over
the relative viscosity (Ladd, J. Chem. Phys. 93, 3484 (1990); Mo & Sangani, Phys. Fluids 6, 1637 (1994)), with Carnahan and
Starling's S(0); the results are corrected for that.

Cubic lattices: drag, torque and viscosity of `data/lattices.csv`.

With `--full` there are more configurations of random spheres."""

import concurrent.futures
import csv
import math
import os
import sys

import numpy as np
from high_frequency_viscosity import TOLERANCE, probes, published_mobility, published_viscosity, steadied
from support import hard_spheres
from support.page import table, write_section
from support.program import ROOT, mobility

REFERENCE = ROOT / "validation" / "data" / "lattices.csv"
FRACTIONS = (0.05, 0.15, 0.25, 0.35, 0.45)
SPHERES, SAMPLES = 108, 10 if "--full" in sys.argv else 4
KINDS = {"FCM": False, "lubricated FCM": True}
# By lattice: the positions in a cubic cell, and the number of cells along each axis that contains all lubricated pairs.
LATTICES = {
    "sc": ([[0, 0, 0]], 3),
    "bcc": ([[0, 0, 0], [0.5, 0.5, 0.5]], 2),
    "fcc": ([[0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]], 2),
}
LATTICE_TOLERANCE = 1e-4
# Largest relative error of lubricated FCM in its range of validity: settling up to a volume fraction, drag at 10%.
SETTLING_LIMIT, SETTLING_UP_TO, DILUTE_DRAG_LIMIT = 0.1, 0.25, 0.03


def published_settling(phi):
    return 1 - 6.5464 * phi * (1 - 3.348 * phi + 7.426 * phi**2 - 10.034 * phi**3 + 5.882 * phi**4)


def structure(phi):
    """The structure factor of hard spheres at the wavenumber 0, by Carnahan and Starling's equation of state."""
    return (1 - phi) ** 4 / ((1 + 2 * phi) ** 2 + phi**3 * (phi - 4))


def settling(case):
    """The mean velocity along equal forces over that of one sphere, the mean over three axes."""
    found = []
    for axis in np.eye(3):
        answer = mobility(case | {"forces": np.tile(6 * np.pi * axis, (SPHERES, 1))}, TOLERANCE)
        found.append((np.array(answer["velocities"]) @ axis).mean())
    return np.mean(found)


def sample(job):
    """Settling velocity and self-mobility of one configuration, by kind, each corrected for the size of the box."""
    phi, seed = job
    centres, edge = hard_spheres.equilibrium(SPHERES, phi, 1000 * seed + round(100 * phi))
    case = {"box": [edge] * 3, "viscosity": 1.0, "positions": centres, "radii": 1.0}
    correction = 1.7601 * (phi / SPHERES) ** (1 / 3) / published_viscosity(phi)
    known = probes(case | {"rigid": False}, seed)
    found = []
    for lubrication in KINDS.values():
        kind = case | {"lubrication": lubrication}
        own = steadied(probes(kind, seed), known, phi).mean()
        found.append([settling(kind) + correction * structure(phi), own + correction])
    return found


def random_spheres():
    """Means and standard errors by volume fraction and kind, of settling velocity and self-mobility."""
    jobs = [(phi, seed) for phi in FRACTIONS for seed in range(SAMPLES)]
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        samples = np.array(list(pool.map(sample, jobs))).reshape(len(FRACTIONS), SAMPLES, len(KINDS), 2)
    return samples.mean(1), samples.std(1, ddof=1) / math.sqrt(SAMPLES)


def lattice(name, phi, lubrication):
    """Drag, torque and both viscosities of a lattice."""
    basis, cells = LATTICES[name]
    edge = (len(basis) * 4 / 3 * np.pi / phi) ** (1 / 3)
    corners = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), -1).reshape(-1, 1, 3)
    places = ((corners + np.array(basis)) * edge).reshape(-1, 3)
    along = np.tile([1.0, 0.0, 0.0], (len(places), 1))
    case = {"box": [cells * edge] * 3, "viscosity": 1.0, "positions": places, "radii": 1.0, "lubrication": lubrication}

    def mean(quantity, place, **loads):
        return np.mean(np.array(mobility(case | loads, LATTICE_TOLERANCE)[quantity])[:, place])

    def viscosity(gradient, place):
        strained = mean("stresslets", place, background={"velocity_gradient": gradient})
        return 1 + strained * len(basis) / edge**3

    return [
        1 / (6 * np.pi * mean("velocities", 0, forces=along)),
        1 / (8 * np.pi * mean("angular_velocities", 0, torques=along)),
        viscosity([[0, 0.5, 0], [0.5, 0, 0], [0, 0, 0]], 1),
        viscosity([[0.5, 0, 0], [0, -0.5, 0], [0, 0, 0]], 0),
    ]


def reference():
    """Rows of the published values, as dictionaries."""
    with open(REFERENCE) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def beside(found, right):
    """A value and its relative difference."""
    return f"{found:.4g} ({100 * (found / right - 1):+.1f}%)"


def cells_of_fraction(k, phi, means, errors):
    line = [f"{phi:.2f}"]
    for quantity, right in enumerate((published_settling(phi), published_mobility(phi))):
        line.append(f"{right:.3f}")
        for kind in range(len(KINDS)):
            value, error = means[k, kind, quantity], errors[k, kind, quantity]
            line.append(f"{value:.3f} ± {error:.3f} ({100 * (value / right - 1):+.1f}%)")
    return line


def cells_of_lattice(row, found):
    """The cells of a row for the tables of loads and of strains; found values are by kind."""
    start = [row["lattice"], f"{float(row['fraction']):g}"]
    tables = []
    for quantities in (("drag", "torque"), ("viscosity_xy", "viscosity_xx")):
        line = list(start)
        for name in quantities:
            right = row[name]
            place = ("drag", "torque", "viscosity_xy", "viscosity_xx").index(name)
            line += [right, *(beside(values[place], float(right)) if right else "" for values in found)]
        tables.append(line)
    return tables


def all_lattices():
    rows = reference()
    jobs = [(row["lattice"], float(row["fraction"]), lubrication) for row in rows for lubrication in KINDS.values()]
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lattice, *zip(*jobs)))
    return rows, [found[k : k + len(KINDS)] for k in range(0, len(found), len(KINDS))]


def header(first, *quantities):
    return [*first, *(column for name in quantities for column in (f"{name} published", *KINDS))]


def main():
    means, errors = random_spheres()
    rows, found = all_lattices()
    loads, strains = zip(*(cells_of_lattice(row, values) for row, values in zip(rows, found)))
    lines = [
        f"{SPHERES} hard spheres at equilibrium, {SAMPLES} configurations per row, with standard errors over them. Velocities are relative to",
        "that of an isolated sphere and corrected for the size of the box.",
        "",
        *table(header(["φ"], "settling", "self-mobility"), [cells_of_fraction(k, phi, means, errors) for k, phi in enumerate(FRACTIONS)]),
        "",
        "Cubic lattices: force over \\\\(6 \\pi \\mu a U\\\\) and torque over \\\\(8 \\pi \\mu a^3 \\Omega\\\\) when all spheres move alike.",
        "",
        *table(header(["lattice", "φ"], "drag", "torque"), loads),
        "",
        "Relative viscosity in the strains \\\\(E_{xy} = E_{yx}\\\\) and \\\\(E_{xx} = -E_{yy}\\\\) along the axes of the cube.",
        "",
        *table(header(["lattice", "φ"], "η(xy)", "η(xx)"), [line for line in strains if line[2]]),
    ]
    write_section("limits.md", "limits", "Random spheres and lattices", lines)
    print("\n".join(lines))
    settled = [abs(means[k, 1, 0] / published_settling(phi) - 1) for k, phi in enumerate(FRACTIONS) if phi <= SETTLING_UP_TO]
    drag = abs(found[0][1][0] / float(rows[0]["drag"]) - 1)
    if max(settled) > SETTLING_LIMIT or drag > DILUTE_DRAG_LIMIT:
        raise SystemExit(f"failed: settling is off by {max(settled):.1%} up to {SETTLING_UP_TO:.0%}, the drag of dilute lattices by {drag:.1%}")


if __name__ == "__main__":
    main()
