"""Spheres between walls and above one: eight spheres against sums without a grid, one sphere against the exact resistance and
motion, walls that are far away."""

import csv

import numpy as np
from support.page import table, write_section
from support.program import ROOT, mobility

TOLERANCES = (1e-2, 1e-3, 1e-4)
GAPS = (0.1, 0.3, 0.5, 1.0, 2.0)
# Boxes along walls so wide that a sphere's copies change its mobility by less than a percent of what the wall does.
WIDE = 60.0


def rows_of(name):
    """A table of numbers by name of its columns."""
    with open(ROOT / "validation" / "data" / name) as file:
        return [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(line for line in file if line[0] != "#")]


def columns(rows, names):
    return np.array([[row[name] for name in names.split()] for row in rows])


def relative(found, exact):
    return np.linalg.norm(np.asarray(found) - exact) / np.linalg.norm(exact)


def eight(name, box, boundaries):
    """Errors of velocities, angular velocities and stresslets of rigid spheres at each tolerance."""
    rows = rows_of(name)
    case = {
        "box": box,
        "boundaries": boundaries,
        "viscosity": 1.0,
        "positions": columns(rows, "x y z"),
        "radii": columns(rows, "radius")[:, 0],
        "forces": columns(rows, "Fx Fy Fz"),
        "torques": columns(rows, "Tx Ty Tz"),
    }
    exact = {"velocities": "Vx Vy Vz", "angular_velocities": "Ox Oy Oz", "stresslets": "Sxx Sxy Sxz Syy Syz"}
    found = []
    for tolerance in TOLERANCES:
        answer = mobility(case, tolerance)
        found.append((tolerance, [relative(answer[key], columns(rows, names)) for key, names in exact.items()], answer["plan"]))
    return found


def report(found):
    """Lines of a table of errors."""
    lines = [[f"{tolerance:.0e}", *(f"{error:.1e}" for error in errors), plan.splitlines()[1].split(maxsplit=1)[1]] for tolerance, errors, plan in found]
    return table(["tolerance", "velocities", "angular velocities", "stresslets", "grid"], lines)


def missed(found):
    return [tolerance for tolerance, errors, _ in found if max(errors) >= tolerance]


def drag(axis, gap):
    """The force that moves a sphere that may turn, over 6 pi a U, along an axis near a wall across z."""
    force = [[float(i == axis) for i in range(3)]]
    case = {
        "box": [WIDE, WIDE, 2 * gap + 6],
        "boundaries": ["periodic", "periodic", "wall"],
        "viscosity": 1.0,
        "positions": [[0.3, 0.7, 1 + gap]],
        "radii": 1.0,
        "forces": force,
    }
    return 1 / (6 * np.pi * mobility(case, 1e-4)["velocities"][0][axis])


def one_wall():
    """The resistance of one sphere near a wall over the exact one, without lubrication."""
    lines = []
    for row in (row for row in rows_of("sphere-wall.csv") if row["gap"] in GAPS):
        # Free to turn along the wall: the torque-free resistance, with torque 4 pi YB and 8 pi YC.
        parallel = row["YA11"] - row["YB11"] ** 2 / (3 * row["YC11"])
        across = drag(2, row["gap"])
        along = drag(0, row["gap"])
        lines.append([f"{row['gap']:g}", f"{across:.4f}", f"{row['XA11']:.4f}", f"{across / row['XA11']:.3f}", f"{along:.4f}", f"{parallel:.4f}", f"{along / parallel:.3f}"])
    return table(["gap", "across", "exact", "ratio", "along", "exact", "ratio"], lines)


def two_walls():
    """The motion of one sphere between two walls over the exact one."""
    lines = []
    for row in (row for row in rows_of("sphere-two-walls.csv") if row["a_over_h"] in (0.1, 0.2, 0.4, 0.5)):
        place = 1 / row["a_over_h"]
        height = place / row["frac"]
        case = {
            "box": [8 * height, 8 * height, height],
            "boundaries": ["periodic", "periodic", "walls"],
            "viscosity": 1.0,
            "positions": [[0.3, 0.7, place]],
            "radii": 1.0,
        }
        across, along = (
            6 * np.pi * mobility({**case, "forces": [[float(i == axis) for i in range(3)]]}, 1e-4)["velocities"][0][axis] for axis in (2, 0)
        )
        gradient = np.zeros((3, 3))
        gradient[0, 2] = 1 / height
        sheared = mobility({**case, "background": {"velocity_gradient": gradient.tolist()}}, 1e-4)["velocities"][0][0] + place / height
        # The centre's speed is H^2 p' / 8 mu.
        driven = mobility({**case, "background": {"pressure_gradient": [-8 / height**2, 0, 0]}}, 1e-4)["velocities"][0][0]
        driven += 4 * place * (height - place) / height**2
        exact = row["perp"], row["par"], row["couette_U"], row["poiseuille_U"]
        pairs = zip((across, along, sheared, driven), exact)
        lines.append([f"{row['frac']:g}", f"{row['a_over_h']:g}", *(f"{found:.4f} ({value:.4f})" for found, value in pairs)])
    return table(["place / H", "a / place", "across", "along", "Couette", "Poiseuille"], lines)


def far():
    """The velocity of a sphere by walls that go away, less that of a single wall or of none."""
    case = {"viscosity": 1.0, "positions": [[0.0, 0.0, 3.0]], "radii": 1.0, "forces": [[0.0, 0.0, 1.0]]}

    def speed(height, boundary):
        box = {"box": [30.0, 30.0, height], "boundaries": ["periodic", "periodic", boundary]}
        return 6 * np.pi * mobility({**case, **box}, 1e-4)["velocities"][0][2]

    single = speed(10.0, "wall")
    return table(["H", "two walls", "one wall"], [[f"{height:g}", f"{speed(height, 'walls'):.5f}", f"{single:.5f}"] for height in (8.0, 16.0, 32.0, 64.0)])


def main():
    spheres = eight("slit-8.csv", [14.0, 14.0, 12.0], ["periodic", "periodic", "walls"])
    failed = missed(spheres)
    verdict = "Every error is below its tolerance." if not failed else f"Not below the tolerance at {', '.join(f'{tolerance:.0e}' for tolerance in failed)}."
    lines = [
        "Eight rigid spheres of radii 1 and 2 between walls, forces and torques on all, against sums without a grid:",
        "",
        *report(spheres),
        "",
        verdict,
        "",
        "One sphere near a wall, force-coupling without lubrication, against Brenner (1961) and O'Neill (1964): the force over",
        "\\\\(6 \\pi \\mu a U\\\\), of a sphere that may turn.",
        "",
        *one_wall(),
        "",
        "Between two walls: \\\\(6 \\pi \\mu a U / F\\\\) across and along them, and the velocity of a free sphere where the upper wall or the",
        "centre of the flow has the speed 1, in parentheses the exact ones:",
        "",
        *two_walls(),
        "",
        "A wall that goes away, \\\\(6 \\pi \\mu a U / F\\\\) of a sphere three radii above the other wall, across it:",
        "",
        *far(),
    ]
    write_section("walls.md", "walls", "Between walls", lines)
    if failed:
        raise SystemExit(verdict)


if __name__ == "__main__":
    main()
