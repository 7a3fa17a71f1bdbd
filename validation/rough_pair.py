"""Two rough spheres that meet in a shear flow: their offset afterwards, against the exact two-sphere functions.

Rough spheres stay in contact from where they meet until their line of centres is across the flow, at any friction,
and then follow the trajectory of smooth spheres (da Cunha & Hinch, J. Fluid Mech. 309, 211, 1996)."""

import itertools

import h5py
import numpy as np
from support.page import table, write_section
from support.program import results

# Offsets across the flow where the spheres are 3 radii apart along it, by roughness.
EXACT = {1e-3: 0.783, 5e-3: 1.0175, 1e-2: 1.126}
FRICTIONS = (0.0, 0.5, 5.0)
STEPS = (0.02, 0.01, 0.005)
ALLOWED = 0.01
EDGE, STRAIN = 24.0, 8.0
SCENE = f"""
box.edges = [{EDGE}, {EDGE}, {EDGE}]
fluid.viscosity = 1.0
hydrodynamics = {{ lubrication = true, tolerance = 1e-3 }}
flow = {{ kind = "shear", rate = 1.0 }}
output = {{ trajectory_every = 1, observables_every = 0, checkpoint_every = 0 }}
particles = {{ initial = "positions", positions = [[11.0, 12.4, 12.0], [13.0, 11.6, 12.0]] }}
[[species]]
radius = 1.0
count = 2
"""


def separations(file):
    """Vectors from one sphere to the nearest image of the other, by frame."""
    particles = file["particles/all"]
    apart = -np.diff(particles["position/value"][:], axis=1)[:, 0]
    strains = particles["box/strain/value"][:]
    crossed = np.round(apart[:, 1] / EDGE)
    apart[:, 1] -= crossed * EDGE
    apart[:, 0] -= crossed * strains * EDGE
    apart[:, 0] -= np.round(apart[:, 0] / EDGE) * EDGE
    return apart


def offset(roughness, friction, step):
    """The offset at a distance of 3 radii along the flow, and the largest overlap over the roughness."""
    stiffness = 1e4 / roughness
    contacts = f"contacts = {{ friction = {friction}, roughness = {roughness}, stiffness = {stiffness} }}\n"
    time = f"time = {{ step = {step}, duration = {STRAIN} }}\n"
    with results(contacts + time + SCENE) as out:
        with h5py.File(out / "trajectory.h5") as file:
            apart = separations(file)
    after = np.argmax(apart[:, 0] > 3.0)
    x, y, _ = apart[after - 1 : after + 1].T
    smallest = np.linalg.norm(apart, axis=1).min() - 2.0
    return np.interp(3.0, x, y), 1.0 - smallest / roughness


def main():
    rows, failed = [], []
    for (roughness, exact), friction in itertools.product(EXACT.items(), FRICTIONS):
        found = [offset(roughness, friction, step) for step in STEPS]
        errors = [y / exact - 1.0 for y, _ in found]
        rows.append([f"{roughness:g}", f"{friction:g}", f"{exact:g}", *(f"{y:.4f} ({error:+.2%})" for (y, _), error in zip(found, errors)),
                     f"{found[-1][1]:.3f}"])
        print(*rows[-1], flush=True)
        failed += [f"roughness {roughness:g}, friction {friction:g}: {errors[-1]:+.2%}"] if abs(errors[-1]) > ALLOWED else []
    lines = [
        "Offset of the spheres across the flow, in radii, when they are 3 radii apart along it after the encounter, in a box of",
        f"{EDGE:g} radii, for three time steps in strain. With the shortest the error may be at most {ALLOWED:.0%}. The last column is the",
        "largest overlap over the roughness.",
        "",
        *table(["roughness", "friction", "exact", *(f"step {step:g}" for step in STEPS), "overlap"], rows),
    ]
    write_section("dense.md", "rough-pair", "Two rough spheres", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
