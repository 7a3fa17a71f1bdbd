"""Brownian displacements of hard spheres at equilibrium: whitened with the matrix of the mobility, and their short-time diffusivity
against the trace of that matrix."""

import sys

import numpy as np
from support import hard_spheres
from support.page import table, write_section
from support.program import mobility

FULL = "--full" in sys.argv[1:]
FRACTIONS = (0.1, 0.2, 0.3, 0.4) if FULL else (0.1, 0.3)
SPHERES, DRAWS = 32, 4000 if FULL else 1000
TOLERANCE = 1e-3
# Allowed deviation of the mean square of whitened numbers from 1: standard errors, and a part for the tolerance.
ERRORS, TOLERATED = 3.0, 2e-3


def matrix(case):
    """Forces and torques to velocities and angular velocities, column by column."""
    columns = []
    for kind in ("forces", "torques"):
        for place in range(3 * SPHERES):
            load = np.zeros(3 * SPHERES)
            load[place] = 1.0
            answer = mobility(case | {kind: load.reshape(-1, 3).tolist()}, TOLERANCE)
            columns.append(np.concatenate([np.ravel(answer["velocities"]), np.ravel(answer["angular_velocities"])]))
    found = np.array(columns).T
    return 0.5 * (found + found.T)


def row(fraction, lubrication):
    places, edge = hard_spheres.equilibrium(SPHERES, fraction, seed=1)
    case = {"box": [edge] * 3, "viscosity": 1.0, "radii": 1.0, "positions": places.tolist(), "lubrication": lubrication}
    dense = matrix(case)
    answer = mobility(case | {"noise": {"draws": DRAWS, "seed": 3}}, TOLERANCE)
    drawn = np.concatenate([np.reshape(answer[name], (DRAWS, -1)) for name in ("noise_velocities", "noise_angular_velocities")], axis=1)
    white = np.linalg.solve(np.linalg.cholesky(dense), drawn.T)
    energy, error = np.mean(white**2), np.sqrt(2 / white.size)
    ratio = white.shape[0] / DRAWS
    values = np.linalg.eigvalsh(white @ white.T / DRAWS)
    edges = (1 - np.sqrt(ratio)) ** 2, (1 + np.sqrt(ratio)) ** 2
    diffusivity = 6 * np.pi * np.mean(drawn[:, : 3 * SPHERES] ** 2)
    trace = 6 * np.pi * np.trace(dense[: 3 * SPHERES, : 3 * SPHERES]) / (3 * SPHERES)
    cells = [f"{fraction:.0%}", "yes" if lubrication else "no", f"{energy:.4f} ± {error:.4f}", f"{values[0]:.3f} to {values[-1]:.3f}",
             f"{edges[0]:.3f} to {edges[1]:.3f}", f"{diffusivity:.4f}", f"{trace:.4f}"]
    print(*cells, flush=True)
    return cells, abs(energy - 1) <= ERRORS * error + TOLERATED


def main():
    found = [row(fraction, lubrication) for fraction in FRACTIONS for lubrication in (False, True)]
    lines = [
        f"{SPHERES} hard spheres at equilibrium, {DRAWS} draws at a tolerance of {TOLERANCE:g}. The draws are whitened with the Cholesky factor",
        "of the mobility matrix (forces and torques to velocities and angular velocities). Their mean square must then be 1,",
        "and the eigenvalues of their covariance must lie between the limits of Marchenko and Pastur, except for fluctuations",
        "at these limits. The diffusivity of the draws relative to that of an isolated sphere must equal the normalised trace",
        "of the matrix.",
        "",
        *table(["φ", "lubrication", "mean square", "eigenvalues", "Marchenko-Pastur", "diffusivity", "trace"], [cells for cells, _ in found]),
    ]
    write_section("brownian.md", "brownian-noise", "Random motions", lines)
    if not all(good for _, good in found):
        raise SystemExit("failed: the mean square of whitened motions is not 1")


if __name__ == "__main__":
    main()
