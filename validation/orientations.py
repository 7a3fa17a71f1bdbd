"""Orientations: a thousand turns of a sphere in shear, the order of the step for rotations about changing axes, and rotational
diffusion."""

import sys

import h5py
import numpy as np
from support.page import table, write_section
from support.program import results, rows_of

FULL = "--full" in sys.argv[1:]
TURNS = 1000
# Steps a turn of each integrator.
TURNING = [("Adams-Bashforth, order 2", "order = 2", 20), ("Adams-Bashforth, order 4", "order = 4", 3),
           ("adaptive", 'integrator = "adaptive"', 3), ("implicit", 'integrator = "implicit"', 3)]
# Allowed angle after all turns: round-off of so many steps; and allowed deviation of the rate.
ROUND_OFF, TOLERATED = 1e-9, 1e-9
ORDERS, STEPS, REFERENCE = (2, 3, 4), (0.1, 0.05, 0.025), 0.003125
SCHEMES = ("drifter-corrector", "random-finite-difference")
SPHERES, SAMPLES = (216, 1000) if FULL else (64, 400)
# Volume fraction of the diffusing spheres, and their rotational diffusivity over that of one alone, to order 1 in it.
FRACTION = 0.01
EXPECTED = 1 - 0.631 * FRACTION
# Allowed deviation at short times, for the tolerance 1e-2 of the run.
NOISE_TOLERATED = 1e-2


def product(a, b):
    """The product of quaternions w, x, y, z."""
    return np.concatenate([[a[0] * b[0] - a[1:] @ b[1:]], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])])


def exponential(rotation):
    angle = np.linalg.norm(rotation)
    return np.concatenate([[np.cos(angle / 2)], np.sinc(angle / (2 * np.pi)) / 2 * rotation])


def angle(a, b):
    """The angle between two orientations."""
    between = product(a, b * [1, -1, -1, -1])
    return 2 * np.arctan2(np.linalg.norm(between[1:]), abs(between[0]))


def ends(scene):
    """Orientations at the start and the end of a run, and angular velocities at the end."""
    with results(scene) as out, h5py.File(out / "trajectory.h5") as file:
        orientations = file["particles/all/orientation/value"]
        return orientations[0], orientations[-1], file["particles/all/angular_velocity/value"][-1]


def turning(keys, steps):
    """The angular velocity of a sphere in a unit shear over -1/2, and the angle of its orientation after all turns from
    that of a rotation with this angular velocity."""
    time = 4 * np.pi * TURNS
    begun, ended, (found,) = ends(f"""box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
flow = {{ kind = "shear", rate = 1.0 }}
particles = {{ initial = "positions", positions = [[0.0, 0.0, 0.0]] }}
hydrodynamics = {{ tolerance = 1e-3, iteration_tolerance = 1e-12 }}
time = {{ step = {time / (TURNS * steps)!r}, steps = {TURNS * steps}, {keys} }}
output = {{ trajectory_every = {TURNS * steps}, observables_every = 0, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = 1, orientation = "aligned", orientation_axis = [0.0, 2.0, 1.0] }}]
""")
    exact = product(exponential(found * time), begun[0])
    return found[2] / -0.5 - 1, angle(ended[0], exact)


def shear():
    rows, good = [], True
    for name, keys, steps in TURNING:
        rate, error = turning(keys, steps)
        rows.append([name, f"{steps}", f"{rate:+.1e}", f"{error:.1e}"])
        print(*rows[-1], flush=True)
        good &= abs(rate) < TOLERATED and error < ROUND_OFF
    lines = [
        f"A sphere in unbounded fluid under shear, for {TURNS} turns, with an iteration tolerance of 1e-12. The angle, in radians, is",
        "that between the orientation at the end and the rotation by the angular velocity that was found: the rotation of a",
        "step is exact, since its axis is constant.",
        "",
        *table(["integrator", "steps a turn", "rate over half the shear rate - 1", "angle"], rows),
    ]
    return lines, good


def three(order, step):
    """Orientations of three near spheres under forces and torques at a time."""
    steps = round(0.8 / step)
    return ends(f"""seed = 4
box.edges = [9.0, 9.0, 9.0]
fluid.viscosity = 1.0
flow = {{ kind = "shear", rate = 0.2 }}
particles = {{ initial = "positions", positions = [[3.0, 4.0, 4.0], [5.3, 4.2, 4.4], [4.0, 6.2, 3.6]] }}
hydrodynamics = {{ method = "dense", tolerance = 1e-6, iteration_tolerance = 1e-12 }}
time = {{ step = {step}, steps = {steps}, order = {order} }}
output = {{ trajectory_every = {steps}, observables_every = 0, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = 3, force = [1.0, 0.0, -3.0], torque = [8.0, -12.0, 14.0], orientation = "random" }}]
""")[1]


def order():
    exact, rows, good = three(4, REFERENCE), [], True
    for order in ORDERS:
        errors = [max(map(angle, three(order, step), exact)) for step in STEPS]
        found = [np.log2(before / after) for before, after in zip(errors, errors[1:])]
        rows.append([f"{order}", *(f"{error:.1e}" for error in errors), *(f"{value:.2f}" for value in found)])
        print(*rows[-1], flush=True)
        good &= found[-1] > order - 0.5
    lines = [
        "Three spheres within a radius of each other, which settle and rotate about changing axes in a sheared box: largest angle at",
        f"the time 0.8 from the orientations of a run with steps of {REFERENCE:g}, and the order found from each pair of steps.",
        "",
        *table(["order", *(f"step {step:g}" for step in STEPS), "found", "found"], rows),
    ]
    return lines, good


def diffusing(scheme):
    """The rotational diffusivity over that of a sphere alone and its error, and the table of rotations."""
    edge = (SPHERES * 4 / 3 * np.pi / FRACTION) ** (1 / 3)
    with results(f"""seed = 5
box.edges = [{edge}, {edge}, {edge}]
fluid = {{ viscosity = 1.0, thermal_energy = 1.0 }}
particles.initial = "random"
hydrodynamics.tolerance = 1e-2
repulsion = {{ strength = 60.0, range = 0.4 }}
time = {{ step = 0.05, steps = {2 * SAMPLES}, brownian = "{scheme}" }}
statistics = {{ every = 2, diffusive_from = 0.5 }}
output = {{ trajectory_every = 0, observables_every = 2, checkpoint_every = 0 }}
species = [{{ radius = 1.0, count = {SPHERES}, orientation = "random" }}]
""") as out:
        summary = {row["quantity"]: row for row in rows_of(out / "statistics" / "summary.csv")}
        rotations = rows_of(out / "statistics" / "rotations.csv")
    found = summary["rotational_diffusivity"]
    return float(found["value"]) * 8 * np.pi, float(found["error"]) * 8 * np.pi, rotations


def diffusion():
    rows, good = [], True
    for scheme in SCHEMES:
        found, error, rotations = diffusing(scheme)
        times, correlations = (np.array([float(row[name]) for row in rotations]) for name in ("time", "correlation"))
        step = np.mean([float(rotations[1][f"rotation_{axis}"]) for axis in "xyz"]) / (2 * times[1]) * 8 * np.pi
        scatter = step * np.sqrt(2 / (3 * SPHERES * SAMPLES))
        at = [np.argmin(abs(times - time)) for time in (2.0, 6.0, 12.0)]
        exact = np.exp(-EXPECTED * times / (4 * np.pi))
        diffusivities = [f"{step:.4f} ± {scatter:.4f}", f"{found:.3f} ± {error:.3f}"]
        rows.append([scheme, *diffusivities, *(f"{correlations[k]:.3f} ({exact[k]:.3f})" for k in at)])
        print(*rows[-1], flush=True)
        good &= abs(found - EXPECTED) < 3 * error and abs(step - EXPECTED) < 3 * scatter + NOISE_TOLERATED
    lines = [
        f"{SPHERES} Brownian spheres at {FRACTION:.0%}, {2 * SAMPLES} steps of 0.05 with \\\\(kT = \\mu = a = 1\\\\): rotational diffusivity",
        "over that of an isolated sphere, from the rotation in two steps and as the answer of the run, where the virial",
        f"expansion is {EXPECTED:.4f}; and the correlation",
        "\\\\(\\langle \\mathbf p(0) \\cdot \\mathbf p(t) \\rangle\\\\) of axes, with \\\\(e^{-2 D t}\\\\) of the virial expansion in brackets.",
        "",
        *table(["scheme", "in two steps", "answer", *(f"at {time}" for time in (2, 6, 12))], rows),
    ]
    return lines, good


def main():
    titles = [("### A sphere in shear", shear), ("### Changing axes", order), ("### Rotational diffusion", diffusion)]
    found = [(title, *case()) for title, case in titles]
    write_section("orientations.md", "orientations", "Validation", [line for title, lines, _ in found for line in (title, "", *lines, "")])
    if not all(good for *_, good in found):
        raise SystemExit("failed: see the table")


if __name__ == "__main__":
    main()
