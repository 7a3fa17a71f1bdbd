"""Spheres in open space: eight spheres against closed forms, a pair against the method's own, a cloud that settles."""

import numpy as np
from support.page import table, write_section
from support.program import mobility
from walls import eight, missed, report

OPEN = ["open", "open", "open"]


def cloud(count, radius, seed):
    """The mean velocity of a cloud of spheres of radius 1 over Stokes' velocity, and its formula 6 N a / 5 R + 1."""
    random = np.random.default_rng(seed)
    places = []
    while len(places) < count:
        place = random.uniform(-radius, radius, 3)
        if np.linalg.norm(place) < radius and all(np.linalg.norm(place - other) > 2 for other in places):
            places.append(place)
    case = {"boundaries": OPEN, "viscosity": 1.0, "positions": np.array(places), "radii": 1.0, "forces": [[0.0, 0.0, -1.0]] * count}
    velocities = np.array(mobility(case, 1e-3)["velocities"])
    return -6 * np.pi * velocities[:, 2].mean(), 6 * count / (5 * radius) + 1


def single():
    """Stokes' velocity of one sphere."""
    case = {"boundaries": OPEN, "viscosity": 1.0, "positions": [[5.0, -3.0, 1e3]], "radii": 1.0, "forces": [[0.0, 0.0, 1.0]]}
    return 6 * np.pi * mobility(case, 1e-4)["velocities"][0][2]


def main():
    spheres = eight("free-space-8.csv", [12.0] * 3, OPEN)
    failed = missed(spheres)
    verdict = ("Every error is below its tolerance." if not failed
               else f"Not below the tolerance at {', '.join(f'{tolerance:.0e}' for tolerance in failed)}.")
    clouds = []
    for count, radius in ((50, 20.0), (200, 40.0), (200, 80.0)):
        found, formula = zip(*(cloud(count, radius, seed) for seed in range(4)))
        spread = np.std(found, ddof=1) / 2
        clouds.append([str(count), f"{radius:g}", f"{np.mean(found):.2f} ± {spread:.2f}", f"{formula[0]:.2f}"])
    lines = [
        "Eight rigid spheres of radii 1 and 2 in unbounded fluid under forces and torques: relative errors with respect to closed pair tensors.",
        "",
        *report(spheres),
        "",
        verdict,
        "",
        f"An isolated sphere has {single():.6f} of the Stokes velocity.",
        "",
        "Clouds of spheres of radius 1 at random positions in a ball of radius R: the initial mean velocity over the Stokes velocity, for",
        "four clouds, and \\\\(6 N a / 5 R + 1\\\\) (Ekiel-Jezewska, Metzger & Guazzelli 2006):",
        "",
        *table(["N", "R", "computed", "formula"], clouds),
    ]
    write_section("walls.md", "open", "Unbounded fluid", lines)
    if failed:
        raise SystemExit(verdict)


if __name__ == "__main__":
    main()
