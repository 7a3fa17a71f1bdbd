"""Rigid bodies in runs: Jeffery orbits of a doublet, settling of an inclined one, and rigidity."""

import h5py
import numpy as np
from support.page import table, write_section
from support.program import results

# Exact values of two touching spheres: (r^2 - 1)/(r^2 + 1) and the period in a unit shear, and the resistance along and
# across the axis over that of the two spheres alone.
BRETHERTON, PERIOD, ALONG, ACROSS = 0.59406, 15.62, 0.64514, 0.72466
TOLERATED = 3e-3
# Deviation of the distances in a body from those at the start.
RIGID = 1e-12
AXES = [("in the plane of the flow", [1.0, 1.0, 0.0]), ("inclined", [0.3, 1.0, 1.0]), ("near the vorticity", [0.2, 0.1, 1.0])]
INTEGRATORS = [("Adams-Bashforth", "order = 4"), ("adaptive", 'integrator = "adaptive"'), ("implicit", 'integrator = "implicit"')]


def frames(scene, *names):
    """Times and values of columns of the trajectory of a run."""
    with results(scene) as out, h5py.File(out / "trajectory.h5") as file:
        group = file["particles/all"]
        return group["position/time"][:], *(group[name + "/value"][:] for name in names)


def axes_of(quaternions):
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    return np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), w * w + z * z - x * x - y * y], -1)


def doublet(axis, loads, flow, steps, step):
    return f"""box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
{flow}
hydrodynamics = {{ tolerance = 1e-3, lubrication = true }}
time = {{ step = {step}, steps = {steps} }}
output = {{ trajectory_every = 1, observables_every = 0, checkpoint_every = 0 }}
[[bodies]]
shape = "doublet"
radius = 1.0
positions = [[0.0, 0.0, 0.0]]
orientation = "aligned"
orientation_axis = {axis}
{loads}
"""


def jeffery():
    rows, good = [], True
    for name, axis in AXES:
        times, turns = frames(doublet(axis, "", 'flow = { kind = "shear", rate = 1.0 }', 640, 0.1), "orientation")
        p = axes_of(turns[:, 0])
        angle = -np.unwrap(np.arctan2(p[:, 1], p[:, 0]))
        whole = int((angle[-1] - angle[0]) // (2 * np.pi))
        period = np.interp(angle[0] + 2 * np.pi * whole, angle, times) / whole
        aspect = np.sqrt((1 + BRETHERTON) / (1 - BRETHERTON))
        constant = np.hypot(p[:, 0] / aspect, p[:, 1]) / np.maximum(abs(p[:, 2]), 1e-300)
        drift = "" if abs(axis[2]) < 1e-9 else f"{constant.max() / constant.min() - 1:.1e}"
        rows.append([name, f"{period:.3f}", f"{period / PERIOD - 1:+.1e}", drift])
        print(*rows[-1], flush=True)
        good &= abs(period / PERIOD - 1) < TOLERATED
    lines = [
        "A doublet of touching spheres in unbounded fluid under a unit shear, for 64 units of time in steps of 0.1: its axis follows",
        f"Jeffery's orbit of a spheroid with \\\\((r^2 - 1)/(r^2 + 1) = {BRETHERTON}\\\\), the value of two touching spheres. The orbit's",
        "constant varies along the orbit by the last column.",
        "",
        *table(["axis at the start", "period", f"over {PERIOD} - 1", "variation of the constant"], rows),
    ]
    return lines, good


def settling():
    rows, good = [], True
    for degrees in (0, 30, 60, 90):
        angle = np.radians(degrees)
        axis = np.array([np.sin(angle), 0.0, np.cos(angle)])
        force = np.array([0.0, 0.0, -12 * np.pi])
        times, positions, turns = frames(doublet(axis.tolist(), f"force = {force.tolist()}", "", 40, 0.5), "position", "orientation")
        found = (positions[-1].mean(0) - positions[0].mean(0)) / times[-1]
        along = axis * (axis @ force)
        exact = (along / ALONG + (force - along) / ACROSS) / (12 * np.pi)
        error = np.linalg.norm(found - exact) / np.linalg.norm(exact)
        turned = np.degrees(np.arccos(min(1.0, abs(axes_of(turns[-1, :1])[0] @ axis))))
        rows.append([f"{degrees}", f"{-found[2]:.4f}", f"{-exact[2]:.4f}", f"{found[0]:.4f}", f"{exact[0]:.4f}", f"{turned:.1e}"])
        print(*rows[-1], flush=True)
        good &= error < TOLERATED and turned < 1e-2
    lines = [
        "A doublet of touching spheres that settles along -z in unbounded fluid, over the Stokes velocity of its spheres, with its axis",
        "inclined to z, for 20 units of time: the velocity down and the drift sideways, and the angle by which it has turned, 0 by symmetry.",
        "",
        *table(["degrees", "down", "exact", "sideways", "exact", "turned (degrees)"], rows),
    ]
    return lines, good


def crowd(integrator):
    return f"""seed = 3
box.edges = [16.0, 16.0, 16.0]
fluid.viscosity = 1.0
flow = {{ kind = "shear", rate = 1.0 }}
particles = {{ initial = "random", minimum_gap = 0.05 }}
repulsion = {{ strength = 10.0, range = 0.1 }}
hydrodynamics = {{ tolerance = 1e-2, lubrication = true }}
time = {{ step = 0.01, steps = 300, {integrator} }}
output = {{ trajectory_every = 50, observables_every = 0, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = 20 }}]
bodies = [
    {{ name = "rods", shape = "rod", spheres = 4, radius = 0.7, count = 20 }},
    {{ name = "piles", shape = "tetrahedron", edge = 2, radius = 0.8, gap = 0.1, count = 10 }},
]
"""


def distances(positions, images, cells, bodies):
    """All distances within bodies, frame by frame."""
    members = [np.flatnonzero(bodies == body) for body in range(bodies.max() + 1)]
    pairs = np.array([(i, j) for of_one in members for i in of_one for j in of_one if i < j])
    found = []
    for x, steps, cell in zip(positions, images, cells):
        apart = x[pairs[:, 1]] - x[pairs[:, 0]]
        shortest = np.full(len(pairs), np.inf)
        for shift in np.ndindex(5, 3, 3):
            shortest = np.minimum(shortest, np.linalg.norm(apart + (np.array(shift) - [2, 1, 1]) @ cell, axis=1))
        found.append(shortest)
    return np.array(found)


def rigidity():
    rows, good = [], True
    for name, keys in INTEGRATORS:
        with results(crowd(keys)) as out, h5py.File(out / "trajectory.h5") as file:
            group = file["particles/all"]
            values = [group[name][:] for name in ("position/value", "image/value", "box/edges/value", "body")]
        found = distances(*values)
        error = abs(found / found[0] - 1).max()
        rows.append([name, f"{error:.1e}"])
        print(*rows[-1], flush=True)
        good &= error < RIGID
    lines = [
        "Twenty rods of four spheres, ten tetrahedra and twenty spheres in a shear flow, for 300 steps: largest relative change of a",
        "distance within a body.",
        "",
        *table(["steps", "change"], rows),
    ]
    return lines, good


def main():
    titles = [("### Jeffery orbits", jeffery), ("### Settling", settling), ("### Rigidity", rigidity)]
    found = [(title, *case()) for title, case in titles]
    write_section("bodies.md", "bodies", "Motion", [line for title, lines, _ in found for line in (title, "", *lines, "")])
    if not all(good for *_, good in found):
        raise SystemExit("failed: see the table")


if __name__ == "__main__":
    main()
