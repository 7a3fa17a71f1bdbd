"""The mean stresslet of sheared suspensions, as relative viscosity, against Stokesian dynamics on the same positions: 100 spheres
at 20%, at equilibrium, without lubrication and with it up to several cutoffs.

scripts/validate mean-stresslet. The results of Stokesian dynamics are in validation/data/mean-stresslet.csv, by
scripts/peers/jfsd_viscosity.py."""

import csv
import concurrent.futures
import math
import os
import pathlib

import numpy as np
from support.hard_spheres import equilibrium
from support.page import table, write_section
from support.program import mobility

KNOWN = pathlib.Path(__file__).parent / "data" / "mean-stresslet.csv"
CUTOFFS = (None, 0.2, 0.5, 1.0, 2.0, 2.5)
TOLERANCE = 1e-3


def viscosity(centres, edge, cutoff):
    """`1 + sum of S_xy / (V mu rate)` in the shear u = y of fluid of viscosity 1."""
    case = {
        "box": [edge] * 3,
        "viscosity": 1.0,
        "positions": centres,
        "radii": 1.0,
        "background": {"velocity_gradient": [[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]},
    }
    if cutoff is not None:
        case |= {"lubrication": True, "lubrication_cutoff": cutoff}
    stresslets = np.array(mobility(case, TOLERANCE)["stresslets"])
    return 1 + stresslets[:, 1].sum() / edge**3


def of_seed(row):
    """Viscosities by cutoff for the configuration of a row of the reference."""
    centres, edge = equilibrium(int(row["count"]), float(row["fraction"]), int(row["seed"]))
    return [viscosity(centres, edge, cutoff) for cutoff in CUTOFFS]


def mean_and_error(values):
    values = np.asarray(values)
    return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))


def report(known, found):
    """The lines of the section, and the difference with the largest cutoff."""
    differences = found / known[:, None] - 1
    names = ["none" if cutoff is None else f"{cutoff:g}" for cutoff in CUTOFFS]
    rows = []
    for name, values, apart in zip(names, found.T, differences.T):
        (mean, error), (difference, spread) = mean_and_error(values), mean_and_error(apart)
        worst = apart[np.abs(apart).argmax()]
        rows.append([name, f"{mean:.3f} ± {error:.3f}", f"{difference:+.2%} ± {spread:.2%}", f"{worst:+.2%}"])
    mean, error = mean_and_error(known)
    lines = [
        f"Relative viscosity of {len(known)} equilibrium configurations of 100 spheres at 20% in a sheared cube. Stokesian dynamics gives",
        f"{mean:.3f} ± {error:.3f} for the same positions. Errors are standard errors over the configurations.",
        "",
        *table(["cutoff / a", "relative viscosity", "difference", "largest"], rows),
    ]
    return lines, abs(mean_and_error(differences[:, -1])[0])


def main():
    with open(KNOWN) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        found = np.array(list(pool.map(of_seed, rows)))
    lines, difference = report(np.array([float(row["relative_viscosity"]) for row in rows]), found)
    write_section("lubrication.md", "mean-stresslet", "Mean stresslet", lines)
    print("\n".join(lines))
    if difference > 0.01:
        raise SystemExit(f"failed: with the widest cutoff the mean differs by {difference:.2%}, more than 1%")


if __name__ == "__main__":
    main()
