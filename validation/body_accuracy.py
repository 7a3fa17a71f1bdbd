"""Rigid bodies made of spheres: exact doublets, spheres held apart, shells against one sphere, iterations and cost."""

import itertools

import numpy as np
from support.page import table, write_section
from support.program import mobility, two_sphere

OPEN = ["open", "open", "open"]
# Resistances of two touching spheres, over those of two spheres that are far apart, from the exact functions of two spheres.
TOUCHING = {"along the axis": 0.64514, "across": 0.72466, "spin about the axis": 0.90154, "end over end": 3.7401 / 2,
            "turning in a strain, (r^2 - 1)/(r^2 + 1)": 0.59406}
LARGEST_ERROR = 2e-3
PAIRS = [(ratio, gap) for ratio in (1.0, 2.0, 4.0) for gap in (1e-4, 1e-2, 0.1, 1.0)]
COUNTS = (8, 64, 512)
# Drag of rods of touching spheres along their axis, over that of as many spheres far apart: collocation of multipoles of all spheres.
RODS = {3: 0.51380, 5: 0.39731, 10: 0.29447}
FRACTION = 0.12


def shared(load, positions):
    """Forces and torques on spheres that add up to a force and a torque on their body."""
    force, torque = np.split(np.asarray(load, float), 2)
    arms = positions - positions.mean(axis=0)
    return np.tile(force, (len(arms), 1)) / len(arms), (torque - np.cross(arms, force)) / len(arms)


def moved(positions, radii, load, tolerance=1e-4, **more):
    """Velocity and angular velocity of one body in unbounded fluid under a force and a torque."""
    positions = np.asarray(positions, float)
    forces, torques = shared(load, positions)
    case = {"boundaries": OPEN, "viscosity": 1.0, "positions": positions, "radii": radii, "forces": forces, "torques": torques,
            "lubrication": True, "bodies": [0] * len(positions), **more}
    answer = mobility(case, tolerance)
    return np.array(answer["body_velocities"][0]), np.array(answer["body_angular_velocities"][0])


def pair(ratio, gap):
    distance = 1 + ratio + gap
    return [[0.0, 0.0, -distance / 2], [0.0, 0.0, distance / 2]]


def unit(place):
    return np.eye(6)[place]


def touching(**more):
    """Computed numbers of the touching doublet, with lubrication or without."""
    positions, force, torque = pair(1.0, 1e-6), 12 * np.pi, 16 * np.pi
    found = {
        "along the axis": 1 / moved(positions, 1.0, force * unit(2), **more)[0][2],
        "across": 1 / moved(positions, 1.0, force * unit(0), **more)[0][0],
        "spin about the axis": 1 / moved(positions, 1.0, torque * unit(5), **more)[1][2],
        "end over end": 1 / moved(positions, 1.0, torque * unit(3), **more)[1][0],
    }
    shear = {"velocity_gradient": [[0, 0, 0.5], [0, 0, 0], [0.5, 0, 0]]}
    turned = moved(positions, 1.0, np.zeros(6), background=shear, **more)[1][1]
    return [*found.values(), 2 * turned]


def held_apart(ratio, gap):
    """Relative errors of the resistances to translation along and across the line of centres and to spin."""
    positions, radii = pair(ratio, gap), [1.0, ratio]
    exact = two_sphere(ratio, gap)
    sizes = {"11": 2.0, "12": 1 + ratio, "21": 1 + ratio, "22": 2 * ratio}
    along, across = (sum(3 * np.pi * size * exact[f"{name}{spheres}"] for spheres, size in sizes.items()) for name in ("XA", "YA"))
    spin = sum(np.pi * size**3 * exact[f"XC{spheres}"] for spheres, size in sizes.items())
    by_force, by_torque = (moved(positions, radii, unit(place)) for place in (0, 4))
    block = np.linalg.inv([[by_force[0][0], by_torque[0][0]], [by_force[1][1], by_torque[1][1]]])
    found = [1 / moved(positions, radii, unit(2))[0][2], block[0, 0], 1 / moved(positions, radii, unit(5))[1][2]]
    return [value / wanted - 1 for value, wanted in zip(found, (along, across, spin), strict=True)]


def rod(count, **more):
    """The same drag of a rod of touching spheres, as computed."""
    positions = np.outer(np.arange(count), [0.0, 0.0, 2.000001])
    return 1 / (6 * np.pi * count * moved(positions, 1.0, unit(2), **more)[0][2])


def shell(level):
    """Points on the unit sphere: the vertices of an icosahedron whose faces are divided in four, again and again."""
    golden = (1 + 5**0.5) / 2
    points = [[0, a, b * golden] for a, b in itertools.product((-1, 1), repeat=2)]
    points = np.array([np.roll(point, turn) for point in points for turn in range(3)], float)
    points /= np.linalg.norm(points, axis=1)[:, None]
    for _ in range(level):
        apart = np.linalg.norm(points[:, None] - points[None], axis=2)
        apart[np.arange(len(points)), np.arange(len(points))] = np.inf
        # Every point has five or six neighbours at about the smallest distance.
        ends = np.argwhere(np.triu(apart < 1.3 * apart.min()))
        middles = points[ends[:, 0]] + points[ends[:, 1]]
        points = np.concatenate([points, middles / np.linalg.norm(middles, axis=1)[:, None]])
    return points


def shell_radii(level):
    """Number of spheres, their radius, and the hydrodynamic radii of a shell of touching spheres around the unit sphere."""
    points = shell(level)
    apart = np.linalg.norm(points[:, None] - points[None], axis=2) + 9 * np.eye(len(points))
    radius = apart.min() / 2
    velocity = moved(points, radius, 6 * np.pi * unit(2), 1e-3)[0][2]
    turned = moved(points, radius, 8 * np.pi * unit(5), 1e-3)[1][2]
    return len(points), radius, 1 / velocity, (1 / turned) ** (1 / 3)


def lattice_of_doublets(cells):
    """Touching doublets of random orientations on a cubic lattice: a case without its bodies."""
    random = np.random.default_rng(1)
    spacing = (2 * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
    centres = spacing * (0.5 + np.array(list(itertools.product(range(cells), repeat=3))))
    axes = random.normal(size=centres.shape)
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    positions = np.stack([centres - axes, centres + axes], axis=1).reshape(-1, 3)
    forces = np.tile(random.normal(size=(len(centres), 3)), 2).reshape(-1, 3)
    return {"box": [spacing * cells] * 3, "viscosity": 1.0, "positions": positions, "radii": 1.0, "forces": forces}


def work(cells):
    """Iterations and seconds with bodies, and of the same spheres a little apart and free."""
    case = {**lattice_of_doublets(cells), "lubrication": True}
    free = np.array(case["positions"]).reshape(-1, 2, 3)
    free = free + 0.005 * np.array([-1, 1])[:, None] * (free[:, 1:] - free[:, :1])
    bodies = np.repeat(np.arange(cells**3), 2)
    joined = min((mobility({**case, "bodies": bodies}, 1e-3) for _ in range(3)), key=lambda answer: answer["seconds"])
    alone = min((mobility({**case, "positions": free.reshape(-1, 3)}, 1e-3) for _ in range(3)), key=lambda answer: answer["seconds"])
    return joined, alone


def main():
    doublet, unlubricated = touching(), touching(lubrication=False)
    worst = max(abs(found / exact - 1) for found, exact in zip(doublet, TOUCHING.values(), strict=True))
    apart = {pair: held_apart(*pair) for pair in PAIRS}
    shells = [shell_radii(level) for level in range(4)]
    orders = [""] + [f"{np.log2((one[2] - 1) / (other[2] - 1)):.2f}" for one, other in itertools.pairwise(shells)]
    works = {count: work(round(count ** (1 / 3))) for count in COUNTS}
    lines = [
        "Two touching spheres (a gap of 1e-6 of the radius) in unbounded fluid: resistances over those of two spheres that are far apart.",
        "",
        *table(["", "computed", "exact", "without lubrication"],
               [[name, f"{found:.5f}", f"{exact:.5f}", f"{alone:.5f}"]
                for (name, exact), found, alone in zip(TOUCHING.items(), doublet, unlubricated, strict=True)]),
        "",
        f"The largest error is {worst:.1e}.",
        "",
        "Two spheres that are held apart: errors of the resistances of the body, relative to the exact functions of two spheres.",
        "",
        *table(["radii", "gap", "along", "across", "spin"],
               [[f"1 : {ratio:g}", f"{gap:g}", *(f"{error:+.1e}" for error in errors)] for (ratio, gap), errors in apart.items()]),
        "",
        "Rods of touching spheres: drag along the axis, over that of as many spheres far apart.",
        "",
        *table(["spheres", "computed", "exact", "without lubrication"],
               [[str(count), f"{rod(count):.5f}", f"{exact:.5f}", f"{rod(count, lubrication=False):.5f}"] for count, exact in RODS.items()]),
        "",
        "Shells of spheres with centres on the unit sphere, the closest of which touch: hydrodynamic radii, and the order in the radius of the",
        "spheres in which that of translation tends to 1.",
        "",
        *table(["spheres", "their radius", "translation", "rotation", "order"],
               [[str(count), f"{radius:.3f}", f"{by_force:.4f}", f"{by_torque:.4f}", order]
                for (count, radius, by_force, by_torque), order in zip(shells, orders, strict=True)]),
        "",
        f"Doublets of random orientations on a cubic lattice at {FRACTION:.0%}: iterations, and seconds over those of the same spheres, free and",
        "one hundredth of a radius apart.",
        "",
        *table(["bodies", "iterations", "of free spheres", "cost"],
               [[str(count), str(joined["iterations"]), str(alone["iterations"]), f"{joined['seconds'] / alone['seconds']:.2f}"]
                for count, (joined, alone) in works.items()]),
    ]
    write_section("lubrication.md", "body-accuracy", "Rigid bodies", lines)
    if worst > LARGEST_ERROR:
        raise SystemExit(f"the doublet has an error of {worst:.1e}")


if __name__ == "__main__":
    main()
