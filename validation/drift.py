"""Drift of Brownian motion: the mean of draws against the divergence of the program's own mobility, by central differences, for
velocities and for stresslets."""

import sys

import numpy as np
from support.page import table, write_section
from support.program import mobility

FULL = "--full" in sys.argv[1:]
PLACES = np.array([[0.0, 0.0, 0.0], [1.9, 0.85, 0.2], [1.0, -0.6, 2.95]]) + 5.0
CASE = {"box": [14.0] * 3, "strain": 0.2, "viscosity": 1.0, "radii": [1.0, 1.0, 2.0]}
DRAWS, TOLERANCE, EXACT = 4000 if FULL else 500, 1e-4, 1e-6
# Displacements of the central differences.
LENGTH = 0.01
# Allowed deviation of the projection from 1: standard errors, and a part for the tolerance of the solve.
ERRORS, TOLERATED = 3.0, 0.03


def along_basis(stresslets):
    """Components xx, xy, xz, yy, yz in an orthonormal basis."""
    xx, xy, xz, yy, yz = np.moveaxis(np.asarray(stresslets), -1, 0)
    return np.stack([-np.sqrt(1.5) * (xx + yy), (xx - yy) / np.sqrt(2), *(np.sqrt(2) * c for c in (xy, xz, yz))], axis=-1)


def divergence(lubrication):
    """Divergence of the mobility (velocities first) and of the stresslets under unit forces: each sphere displaced along its force."""
    sums = [np.zeros(18), np.zeros(15)]
    for sphere, axis in np.ndindex(3, 3):
        for sign in (1, -1):
            places, forces = PLACES.copy(), np.zeros((3, 3))
            places[sphere, axis] += sign * LENGTH
            forces[sphere, axis] = 1.0
            answer = mobility(CASE | {"positions": places, "forces": forces, "lubrication": lubrication}, EXACT)
            motion = np.concatenate([np.ravel(answer["velocities"]), np.ravel(answer["angular_velocities"])])
            for total, part in zip(sums, (motion, along_basis(answer["stresslets"]).ravel())):
                total += sign * part / (2 * LENGTH)
    return sums


def row(lubrication, name, draws, exact):
    """Projection of the mean on the divergence, distance of the mean from it, both over its norm, and the scatter of each."""
    size = np.linalg.norm(exact)
    along = draws @ exact / size**2
    mean, error = along.mean(), along.std(ddof=1) / np.sqrt(len(along))
    distance = np.linalg.norm(draws.mean(axis=0) - exact) / size
    scatter = np.sqrt((draws.var(axis=0, ddof=1) / len(draws)).sum()) / size
    cells = ["yes" if lubrication else "no", name, f"{size:.4g}", f"{mean:.3f} ± {error:.3f}", f"{distance:.3f}", f"{scatter:.3f}"]
    print(*cells, flush=True)
    return cells, abs(mean - 1) <= ERRORS * error + TOLERATED


def rows(lubrication):
    motion, stresslets = divergence(lubrication)
    noise = {"draws": DRAWS, "seed": 4, "drift": True}
    answer = mobility(CASE | {"positions": PLACES, "lubrication": lubrication, "noise": noise}, TOLERANCE)
    drawn = [np.reshape(answer[f"drift_{name}"], (DRAWS, -1)) for name in ("velocities", "angular_velocities")]
    drawn_stresslets = along_basis(answer["drift_stresslets"]).reshape(DRAWS, -1)
    exact = [("velocities", drawn[0], motion[:9]), ("angular velocities", drawn[1], motion[9:]), ("stresslets", drawn_stresslets, stresslets)]
    return [row(lubrication, *one) for one in exact]


def main():
    found = rows(False) + rows(True)
    lines = [
        f"Three spheres, two of radius 1 and one of radius 2, at gaps of 0.1 to 0.25 in a sheared box: the drift of {DRAWS} draws",
        "of the scheme of two evaluations, compared with the divergence of the program's own mobility by central differences.",
        "The columns are the norm of the divergence; the mean drift projected on it, relative to this norm, which must be 1;",
        "the distance of the mean drift from it; and the distance expected from scatter alone. Without the second evaluation",
        "all projections are 0.",
        "",
        *table(["lubrication", "drift of", "norm", "projection", "distance", "scatter"], [cells for cells, _ in found]),
    ]
    write_section("brownian.md", "drift", "Drift", lines)
    if not all(good for _, good in found):
        raise SystemExit("failed: the mean of draws is not the divergence of the mobility")


if __name__ == "__main__":
    main()
