"""Squirmers at a wall: velocities against the exact solution for a sphere at a wall, and where they swim to."""

import math

import h5py
import numpy as np
from support.page import table, write_section
from support.program import results, two_sphere

EDGE, HEIGHT = 40.0, 30.0
GAPS, BETAS = (1e-3, 0.03, 0.3, 1.0, 3.0), (-3.0, 0.0, 3.0)
# Angles of the axis to the wall: along it, towards it at 30 degrees, straight away from it.
ANGLES = (0.0, -30.0, 90.0)
# Largest difference over the speed: of a passive sphere at a wall, and of periodic images.
ALLOWED = 5e-3
# Paths: the angle at the start, to the wall, the height, and the time, in radii and speeds.
START, ABOVE, TIME = -45.0, 4.0, 60.0


def axis(degrees):
    return [math.cos(math.radians(degrees)), 0.0, math.sin(math.radians(degrees))]


def scene(beta, degrees, height, time, more=""):
    return f"""
box = {{ edges = [{EDGE}, {EDGE}, {HEIGHT}], boundaries = ["periodic", "periodic", "wall"] }}
fluid.viscosity = 1.0
particles = {{ initial = "positions", positions = [[10.0, 20.0, {height}]] }}
hydrodynamics = {{ tolerance = 1e-3, lubrication = true }}
time = {time}
species = [{{ radius = 1.0, count = 1, orientation = "aligned", orientation_axis = {axis(degrees)},
  swimming = {{ speed = 1.0, beta = {beta} }} }}]
{more}
"""


def last_motion(text):
    """Velocity and angular velocity of the last frame."""
    with results(text) as out, h5py.File(out / "trajectory.h5") as file:
        particles = file["particles/all"]
        return [particles[f"{name}/value"][-1, 0] for name in ("velocity", "angular_velocity")]


def exact(beta, degrees, gap):
    """`U_z, U_x, Omega_y` of a free squirmer above a wall: its loads by slip, held, and by its motion add up to zero."""
    rigid, slip = two_sphere(math.inf, gap), two_sphere(math.inf, gap, "--slip")
    p = np.array(axis(degrees))
    first, second = 1.5 * p, 1.5 * beta * (np.outer(p, p) - np.eye(3) / 3)
    # The axis of the functions points down, to the wall.
    load = lambda name, amounts: amounts[0] * slip[f"{name}1"] + amounts[1] * slip[f"{name}2"]
    along = -load("XF", (-first[2], 1.5 * second[2, 2])) / (6 * np.pi * rigid["XA"])
    across = (first[0], -second[0, 2])
    resistance = np.pi * np.array([[6 * rigid["YA"], -4 * rigid["YB"]], [-4 * rigid["YB"], 8 * rigid["YC"]]])
    moved, turned = -np.linalg.solve(resistance, [load("YF", across), load("YT", across)])
    return -along, moved, -turned


def motions():
    rows, worst = [], 0.0
    for gap in GAPS:
        for beta in BETAS:
            for degrees in ANGLES:
                (u, omega), known = last_motion(scene(beta, degrees, 1 + gap, "{ step = 1e-9, steps = 1 }")), exact(beta, degrees, gap)
                found = (u[2], u[0], omega[1])
                worst = max(worst, *(abs(a - b) for a, b in zip(found, known)))
                rows.append([f"{gap:g}", f"{beta:g}", f"{degrees:g}°", *(f"{a:.3f} ({b:.3f})" for a, b in zip(found, known))])
                print(*rows[-1], flush=True)
    lines = [
        "Velocities along the wall's normal and along the wall, and the angular velocity, of a free squirmer of radius and speed 1",
        f"above a wall, with the exact values in parentheses (`fcm-solve two-sphere --wall --slip`): at most {worst:.1e} apart.",
        "The angle is that of the axis to the wall; a positive angular velocity turns the axis towards the wall.",
        "",
        *table(["gap", "\\\\(\\beta\\\\)", "angle", "\\\\(U_z\\\\)", "\\\\(U_x\\\\)", "\\\\(\\Omega_y\\\\)"], rows),
    ]
    return lines, worst < ALLOWED


def path(beta):
    """Height and angle to the wall at the end of a path that begins towards it."""
    text = scene(beta, START, ABOVE, f'{{ step = 0.02, duration = {TIME}, integrator = "adaptive" }}', """
repulsion = { strength = 130.0, range = 0.05 }
output = { trajectory_every = 50, observables_every = 50, checkpoint_every = 0 }
""")
    with results(text) as out, h5py.File(out / "trajectory.h5") as file:
        particles = file["particles/all"]
        heights, (w, x, y, z) = particles["position/value"][:, 0, 2], particles["orientation/value"][-1, 0]
        return heights, math.degrees(math.asin(w * w - x * x - y * y + z * z))


def paths():
    rows, fates = [], {}
    for beta in (-5.0, -1.0, 0.0, 1.0, 5.0):
        heights, degrees = path(beta)
        fates[beta] = heights[-1]
        rows.append([f"{beta:g}", f"{heights.min() - 1:.3f}", f"{heights[-1] - 1:.3f}", f"{degrees:.1f}°"])
        print(*rows[-1], flush=True)
    lines = [
        f"Squirmers that start at a height of {ABOVE:g} radii, at {-START:g}° towards the wall, with a repulsion up to a gap of 0.05:",
        f"the smallest gap on the way, and the gap and the angle of the axis to the wall after a time of {TIME:g} radii over the speed.",
        "",
        *table(["\\\\(\\beta\\\\)", "smallest gap", "gap at the end", "angle at the end"], rows),
    ]
    return lines, fates[0.0] > 3


def main():
    found = [(title, *case()) for title, case in (("### Velocities", motions), ("### Paths", paths))]
    lines = [line for title, lines, _ in found for line in (title, "", *lines, "")]
    write_section("squirmers.md", "squirmers-at-walls", "At a wall", lines)
    if not all(good for *_, good in found):
        raise SystemExit("failed: see the tables")


if __name__ == "__main__":
    main()
