"""Spheres between walls and above one: eight spheres against sums without a grid, one sphere against the exact resistance and
motion, without lubrication and with it, and the limit of a distant wall."""

import csv

import numpy as np
from support.page import table, write_section
from support.program import ROOT, mobility

TOLERANCES = (1e-2, 1e-3, 1e-4)
# Allowed relative error for one sphere with lubrication, up to this radius over half of the distance of two walls.
ALLOWED, WIDEST = 0.01, 0.5
# The same for the velocity across the walls.
ACROSS_ALLOWED, WIDEST_ACROSS = 0.025, 0.6


# Edges of the box along walls, such that periodic images change the mobility by at most some tenths of a percent: their effect is less
# than about 2 (h / L)^3 near one wall, and about 1.5 a H / L^2 along two walls at distance H.
def beside_one_wall(place):
    return max(60.0, 12.0 * place)


def between_two(height):
    return max(8 * height, min(24 * height, 160.0))


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
    lines = [[f"{tolerance:.0e}", *(f"{error:.1e}" for error in errors), plan.splitlines()[1].split(maxsplit=1)[1]]
             for tolerance, errors, plan in found]
    return table(["tolerance", "velocities", "angular velocities", "stresslets", "grid"], lines)


def missed(found):
    return [tolerance for tolerance, errors, _ in found if max(errors) >= tolerance]


def drag(axis, gap, lubrication):
    """Drag over 6 pi a U of a torque-free sphere near a wall across z, along an axis."""
    force = [[float(i == axis) for i in range(3)]]
    case = {
        "box": [beside_one_wall(1 + gap)] * 2 + [2 * gap + 6],
        "boundaries": ["periodic", "periodic", "wall"],
        "viscosity": 1.0,
        "positions": [[0.3, 0.7, 1 + gap]],
        "radii": 1.0,
        "forces": force,
        "lubrication": lubrication,
    }
    return 1 / (6 * np.pi * mobility(case, 1e-4)["velocities"][0][axis])


def one_wall():
    """The resistance of one sphere near a wall over the exact one, and the largest error with lubrication."""
    lines, errors = [], []
    for row in rows_of("sphere-wall.csv"):
        # Free to rotate along the wall: the torque-free resistance, with torque 4 pi YB and 8 pi YC.
        exact = row["XA11"], row["YA11"] - row["YB11"] ** 2 / (3 * row["YC11"])
        ratios = [[drag(axis, row["gap"], lubrication) / value for lubrication in (False, True)] for axis, value in zip((2, 0), exact)]
        errors += [abs(ratio - 1) for _, ratio in ratios]
        lines.append([f"{row['gap']:g}", *(text for value, pair in zip(exact, ratios)
                                           for text in (f"{value:.5g}", *(f"{ratio:.3f}" for ratio in pair)))])
    return table(["gap", "across", "without", "with", "along", "without", "with"], lines), max(errors)


def free(case, row):
    """The exact motions of a sphere between two walls, and those of a case: 6 pi a U / F across and along them, then velocity and
    angular velocity with the upper wall moving, and with a pressure gradient."""
    place = 1 / row["a_over_h"]
    height = place / row["frac"]
    across, along = (6 * np.pi * mobility({**case, "forces": [[float(i == axis) for i in range(3)]]}, 1e-4)["velocities"][0][axis] for axis in (2, 0))
    gradient = np.zeros((3, 3))
    gradient[0, 2] = 1 / height
    flows = [
        ({"velocity_gradient": gradient.tolist()}, place / height, 0.5 / height),
        # The centre's speed is H^2 p' / 8 mu.
        ({"pressure_gradient": [-8 / height**2, 0, 0]}, 4 * place * (height - place) / height**2, 2 * (height - 2 * place) / height**2),
    ]
    moved = []
    for background, velocity, turning in flows:
        answer = mobility({**case, "background": background}, 1e-4)
        moved += [answer["velocities"][0][0] + velocity, answer["angular_velocities"][0][1] + turning]
    exact = [row.get(name, np.nan) for name in ("perp", "par", "couette_U", "couette_Omega", "poiseuille_U", "poiseuille_Omega")]
    return list(zip(exact, [across, along, *moved]))


def two_walls(lubrication):
    """The motion of one sphere between two walls and the exact one, the largest relative error of its velocities up to
    `WIDEST`, and that of its velocity across up to `WIDEST_ACROSS`."""
    lines, errors, across = [], [], []
    for row in rows_of("sphere-two-walls.csv"):
        place = 1 / row["a_over_h"]
        height = place / row["frac"]
        case = {
            "box": [between_two(height)] * 2 + [height],
            "boundaries": ["periodic", "periodic", "walls"],
            "viscosity": 1.0,
            "positions": [[0.3, 0.7, place]],
            "radii": 1.0,
            "lubrication": lubrication,
        }
        pairs = free(case, row)
        if 2 / height <= WIDEST:
            errors += [abs(found / exact - 1) for exact, found in (pairs[k] for k in (0, 1, 2, 4))]
        if 2 / height <= WIDEST_ACROSS + 1e-9:
            across.append(abs(pairs[0][1] / pairs[0][0] - 1))
        texts = [f"{found:.4f}" + ("" if np.isnan(exact) else f" ({abs(exact):.4f})") for exact, found in pairs]
        lines.append([f"{row['frac']:g}", f"{row['a_over_h']:g}", f"{2 / height:.2g}", *texts])
    return table(["z / H", "a / z", "2 a / H", "across", "along", "Couette, U", "Ω", "Poiseuille, U", "Ω"],
                 lines), max(errors), max(across)


def far():
    """The velocity of a sphere between walls at increasing distance, and at a single wall."""
    case = {"viscosity": 1.0, "positions": [[0.0, 0.0, 3.0]], "radii": 1.0, "forces": [[0.0, 0.0, 1.0]]}

    def speed(height, boundary):
        box = {"box": [30.0, 30.0, height], "boundaries": ["periodic", "periodic", boundary]}
        return 6 * np.pi * mobility({**case, **box}, 1e-4)["velocities"][0][2]

    single = speed(10.0, "wall")
    return table(["H", "two walls", "one wall"],
                 [[f"{height:g}", f"{speed(height, 'walls'):.5f}", f"{single:.5f}"] for height in (8.0, 16.0, 32.0, 64.0)])


def main():
    spheres = eight("slit-8.csv", [14.0, 14.0, 12.0], ["periodic", "periodic", "walls"])
    near, with_lubrication = one_wall()
    (alone, *_), (between, widest, across) = (two_walls(lubrication) for lubrication in (False, True))
    failed = [f"{tolerance:.0e}" for tolerance in missed(spheres)]
    verdict = "Every error is below its tolerance." if not failed else f"Not below the tolerance at {', '.join(failed)}."
    is_exact = max(with_lubrication, widest) < ALLOWED and across < ACROSS_ALLOWED
    verdict_of_limit = "within" if is_exact else "not within"
    lines = [
        "Eight rigid spheres of radii 1 and 2 between walls under forces and torques: relative errors with respect to sums without a grid.",
        "",
        *report(spheres),
        "",
        verdict,
        "",
        "One sphere near a wall: the exact drag over \\\\(6 \\pi \\mu a U\\\\) for motion across the wall, and along it when free to",
        "rotate (Brenner 1961, O'Neill 1964), and the ratio of the computed drag to it, without and with lubrication.",
        "",
        *near,
        "",
        "One sphere between two walls at distance H, without lubrication: the mobilities \\\\(6 \\pi \\mu a U / F\\\\) across and",
        "along them, and the velocity and angular velocity of a free sphere in Couette and Poiseuille flow, where the upper",
        "wall or the centre of the flow has the speed 1. Exact values are in parentheses.",
        "",
        *alone,
        "",
        "The same with lubrication.",
        "",
        *between,
        "",
        f"With lubrication the drag near one wall has an error of at most {with_lubrication:.1%}. Velocities between two walls have an error of",
        f"at most {widest:.1%} up to a radius of {WIDEST:g} of half their distance, which is {verdict_of_limit} the allowed {ALLOWED:.0%}. At",
        f"{WIDEST_ACROSS:g} the error of the velocity across the walls is {across:.1%}.",
        "",
        "Limit of a distant wall: \\\\(6 \\pi \\mu a U / F\\\\) across the walls for a sphere three radii above the lower wall.",
        "",
        *far(),
    ]
    write_section("walls.md", "walls", "Between walls", lines)
    if failed or not is_exact:
        raise SystemExit("; ".join([*([verdict] if failed else []), *([] if is_exact else ["failed: lubrication at walls is not within the limit"])]))


if __name__ == "__main__":
    main()
