"""Filaments: bending and twisting by end loads, Euler's load of buckling, tumbling in shear, settling, persistence."""

import csv
import math

import h5py
import numpy as np
from support.page import table, write_section
from support.program import results

SPACING = 2.2
# The deflection of the linear theory, at a slope of a thousandth; and the load of buckling with 13 spheres.
TOLERATED, BUCKLING = 1e-3, 0.02
# Orders of convergence with the number of spheres at large rotations.
ORDER = 0.3


def chain(count, ends, keys, places=None, more="", middle="", stiffness=1e4):
    """A chain along x in unbounded fluid, with loads on both ends and on the middle sphere: ids 0 and 1, and 2."""
    places = np.array([[SPACING * k, 0.0, 0.0] for k in range(count)]) if places is None else places
    half = count // 2
    inner = [k for k in range(1, count - 1) if k != half]
    order = [0, count - 1, half, *inner]
    ids = [order.index(k) for k in range(count)]
    sections = [("first", 1, ends[0]), ("last", 1, ends[1]), ("middle", 1, middle), ("inner", len(inner), "")]
    species = "".join(
        f'[[species]]\nname = "{name}"\nradius = 1.0\ncount = {number}\norientation = "aligned"\n'
        f"orientation_axis = [1.0, 0.0, 0.0]\n{loads}\n"
        for name, number, loads in sections
        if number
    )
    return f"""box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
particles = {{ initial = "positions", positions = {places[order].tolist()} }}
hydrodynamics.tolerance = 1e-3
{keys}
{species}
[[bonds]]
pairs = {[[a, b] for a, b in zip(ids, ids[1:])]}
stiffness = {stiffness}
rest_shape = "straight"
{more}
""", ids


def frames(scene, *names):
    """Times and values of columns of the trajectory of a run."""
    with results(scene) as out, h5py.File(out / "trajectory.h5") as file:
        group = file["particles/all"]
        return group["position/time"][:], *(group[name + "/value"][:] for name in names)


def series(scene):
    with results(scene) as out, open(out / "observables.csv") as file:
        rows = list(csv.reader(file))
    return {name: np.array([float(row[k]) for row in rows[1:]]) for k, name in enumerate(rows[0])}


def turned(quaternions, axis):
    """Axes of spheres in space, the one along `axis` of their own."""
    w, v = quaternions[..., :1], quaternions[..., 1:]
    axis = np.broadcast_to(np.array(axis, float), v.shape)
    twice = 2 * np.cross(v, axis)
    return axis + w * twice + np.cross(v, twice)


def implicit(time, steps, trajectory=0, series=0, tolerance=0.05):
    """Keys of implicit steps over a time, and of the output."""
    return f"""time = {{ step = {time / steps}, steps = {steps}, integrator = "implicit", tolerance = {tolerance} }}
output = {{ trajectory_every = {trajectory}, observables_every = {series}, checkpoint_every = 0 }}"""


def steady(time, steps):
    return implicit(time, steps, trajectory=steps)


def deflection():
    rows, good = [], True
    for count in (3, 5, 9):
        length, stiffness = SPACING * (count - 1), 1000.0
        force = 0.001 * 48 * stiffness / length**2
        ends = [f"force = [0.0, {-force / 2}, 0.0]"] * 2
        keys, middle = steady(2 * length**4 / stiffness, 40), f"force = [0.0, {force}, 0.0]"
        scene, _ = chain(count, ends, keys, more=f"bending_stiffness = {stiffness}", middle=middle)
        _, places = frames(scene, "position")
        found = places[-1][2, 1] - places[-1][:2, 1].mean()
        error = found / (0.001 * length) - 1
        rows.append([f"{count}", f"{found / length:.6f}", f"{error:+.1e}"])
        print(*rows[-1], flush=True)
        good &= abs(error) < TOLERATED
    lines = [
        "Forces at both ends and at the middle of a chain of length \\\\(L\\\\), whose middle is \\\\(P L^3 / 48 EI = L / 1000\\\\) from the",
        "line of its ends by Euler's beam theory.",
        "",
        *table(["spheres", "deflection over L", "error"], rows),
    ]
    return "### Three-point bending", lines, good


def torques(name, keys, loads, exact, measure, text):
    rows, errors = [], []
    for count in (3, 5, 9, 17):
        scale = 8 * SPACING / (SPACING * (count - 1))
        stiffness = 1000.0 / scale
        moment = exact * stiffness / (SPACING * (count - 1))
        ends = [f"torque = {[sign * moment * x for x in loads]}" for sign in (-1.0, 1.0)]
        length = SPACING * (count - 1)
        scene, ids = chain(count, ends, steady(3 * length**4 / stiffness, 60), more=keys(stiffness))
        _, turns = frames(scene, "orientation")
        errors.append(abs(measure(turns[-1][ids]) - exact))
        order = math.log2(errors[-2] / errors[-1]) if len(errors) > 1 else math.nan
        rows.append([f"{count}", f"{math.degrees(errors[-1]):.3f}", "" if len(errors) == 1 else f"{order:.2f}"])
        print(*rows[-1], flush=True)
    good = abs(math.log2(errors[-2] / errors[-1]) - 2) < ORDER
    return name, [*text, "", *table(["spheres", "error in degrees", "order"], rows)], good


def angles(turns):
    """Sum of the angles between the axes of neighbours."""
    axes = turned(turns, [0, 0, 1])
    return sum(math.acos(min(1.0, float(a @ b))) for a, b in zip(axes, axes[1:]))


def twist(turns):
    """Sum of the angles about x between neighbours, which have the same axes along x."""
    sides = turned(turns, [1, 0, 0])
    return sum(math.acos(min(1.0, float(a @ b))) for a, b in zip(sides, sides[1:]))


def bending():
    text = [
        "Torques \\\\(\\mp M\\\\) at both ends bend a chain of length \\\\(L\\\\) to an arc whose ends are at the angle",
        "\\\\(ML/EI = 90\\\\) degrees.",
    ]
    # Without resistance to twist it would buckle sideways.
    keys = lambda stiffness: f"bending_stiffness = {stiffness}\ntwisting_stiffness = {10 * stiffness}"
    return torques("### Bending to an arc", keys, [0, 0, 1], math.radians(90), angles, text)


def twisting():
    text = ["Torques along the chain twist it by \\\\(ML/GJ = 90\\\\) degrees."]
    keys = lambda stiffness: f"bending_stiffness = {20 * stiffness}\ntwisting_stiffness = {stiffness}"
    return torques("### Twisting", keys, [1, 0, 0], math.radians(90), twist, text)


def buckling():
    rows, found = [], []
    for count in (5, 7, 13):
        length, stiffness = SPACING * (count - 1), 1000.0
        x = SPACING * np.arange(count)
        places = np.stack([x, 1e-3 * length * np.sin(np.pi * x / length), 0 * x], -1)
        time = 0.1 * length**4 / stiffness
        keys = implicit(time, 100, series=1)
        rates = []
        for load in (0.9, 1.1):
            force = load * math.pi**2 * stiffness / length**2
            ends = [f"force = [{force}, 0.0, 0.0]", f"force = [{-force}, 0.0, 0.0]"]
            scene, _ = chain(count, ends, keys, places, f"bending_stiffness = {stiffness}", stiffness=1e6)
            energy = series(scene)["bending_energy"]
            rates.append(math.log(energy[-1] / energy[-21]) / 2 / (0.2 * time))
        critical = 0.9 + 0.2 * rates[0] / (rates[0] - rates[1])
        found.append(critical)
        rows.append([f"{count}", *(f"{rate * length**4 / stiffness:+.3f}" for rate in rates), f"{critical:.4f}"])
        print(*rows[-1], flush=True)
    lines = [
        "A chain with a small bend is compressed by forces at its ends. The bend decays below Euler's load",
        "\\\\(\\pi^2 EI / L^2\\\\) and grows above it: rates at 0.9 and 1.1 of this load, times \\\\(\\mu L^4 / EI\\\\), and the load",
        "without growth, over Euler's, interpolated between them.",
        "",
        *table(["spheres", "rate at 0.9", "rate at 1.1", "load of buckling"], rows),
    ]
    return "### Buckling", lines, abs(found[-1] - 1) < BUCKLING


def shear():
    count, rows, extents = 16, [], []
    length = SPACING * (count - 1) + 2
    slender = -math.log((2 / length) ** 2 * math.e)
    x = SPACING * (np.arange(count) - (count - 1) / 2)
    bend = 0.01 * length * np.sin(2 * np.pi * x / length + 0.5)
    angle = -math.radians(8)
    places = np.stack([x * math.cos(angle) - bend * math.sin(angle), x * math.sin(angle) + bend * math.cos(angle), 0 * x], -1)
    keys = """time = { step = 0.1, steps = 300, integrator = "implicit" }
output = { trajectory_every = 1, observables_every = 0, checkpoint_every = 0 }
flow = { kind = "shear", rate = 1.0 }
repulsion = { strength = 100.0 }"""
    for number in (150, 600, 2000, 10000):
        stiffness = 8 * math.pi * length**4 / (number * slender)
        beam = f"bending_stiffness = {stiffness}\ntwisting_stiffness = {stiffness}"
        scene, ids = chain(count, ["", ""], keys, places, beam, stiffness=2e4)
        times, found = frames(scene, "position")
        ends = found[:, ids[-1]] - found[:, ids[0]]
        extents.append((np.linalg.norm(ends, axis=1) / (length - 2)).min())
        turning = np.unwrap(np.arctan2(ends[:, 1], ends[:, 0]))
        upright = np.interp(math.pi / 2, -turning, times)
        rows.append([f"{number}", f"{stiffness:.0f}", f"{extents[-1]:.3f}", f"{upright:.1f}"])
        print(*rows[-1], flush=True)
    lines = [
        f"A chain of {count} spheres with a bend of 1% starts at 8 degrees from the flow, on the side from which it turns through the",
        "compressing direction. Rows are for the elastoviscous number \\\\(8 \\pi \\mu \\dot\\gamma L^4 / EI c\\\\) with",
        "\\\\(c = -\\ln(e\\\\, d^2/L^2)\\\\): the least distance of the ends over that of the straight chain, and the time until the",
        "line between the ends is across the flow. In slender-body theory straight fibres buckle above about 306 (Becker &",
        "Shelley, Phys. Rev. Lett. 87, 198301, 2001; the number is quoted from memory); in one passage through the compressing",
        "direction a small bend has time to grow only well above it.",
        "",
        *table(["number", "EI", "least distance of the ends", "time until across"], rows),
    ]
    return "### Tumbling in shear", lines, min(extents[:2]) > 0.97 and extents[2] < 0.9 and extents[3] < extents[2]


def settling():
    count, rows, depths = 16, [], []
    length = SPACING * (count - 1)
    for number in (5, 20, 100):
        stiffness = 100.0
        force = number * stiffness / length**2
        each = f"force = [0.0, 0.0, {-force / count}]"
        time = 30 * length**2 / force
        keys = steady(time, 200)
        scene, ids = chain(count, [each, each], keys, None, f"bending_stiffness = {stiffness}", each, 100 * force)
        scene = scene.replace('[1.0, 0.0, 0.0]\n\n', f'[1.0, 0.0, 0.0]\n{each}\n')
        _, found = frames(scene, "position")
        last = found[-1][ids]
        depth = (last[[0, -1], 2].mean() - last[count // 2 - 1 : count // 2 + 1, 2].mean()) / length
        depths.append(depth)
        rows.append([f"{number}", f"{depth:.4f}", f"{depth / number:.2e}"])
        print(*rows[-1], flush=True)
    lines = [
        f"A straight chain of {count} spheres settles across a force \\\\(F\\\\) that its spheres share. Its ends, which the others drag",
        "along less, lag behind: depth of the steady bow over \\\\(L\\\\), by the elasto-gravitational number",
        "\\\\(B = F L^2 / EI\\\\). It is in proportion to \\\\(B\\\\) as long as it is small.",
        "",
        *table(["B", "depth over L", "depth over L B"], rows),
    ]
    return "### Settling", lines, abs(depths[1] / depths[0] / 4 - 1) < 0.1 and all(np.diff(depths) > 0)


def persistence():
    count, spheres, steps = 12, 6, 6000
    length = 8.8
    scene = f"""seed = 4
box.edges = [40.0, 40.0, 40.0]
fluid = {{ viscosity = 1.0, thermal_energy = 1.0 }}
particles = {{ initial = "random", minimum_gap = 0.1 }}
hydrodynamics.tolerance = 1e-2
time = {{ step = 0.03, steps = {steps} }}
output = {{ trajectory_every = 20, observables_every = 0, checkpoint_every = 0 }}
[[filaments]]
spheres = {spheres}
radius = 1.0
gap = 0.2
count = {count}
stiffness = 20.0
bending_stiffness = {length}
twisting_stiffness = {length}
"""
    _, turns = frames(scene, "orientation")
    axes = turned(turns[len(turns) // 4 :], [0, 0, 1]).reshape(-1, count, spheres, 3)
    rows, good = [], True
    for apart in (1, 2, 3):
        cosine = np.einsum("tcsk,tcsk->tcs", axes[:, :, : spheres - apart], axes[:, :, apart:]).mean(2)
        by_filament = cosine.mean(0)
        mean, error = by_filament.mean(), by_filament.std(ddof=1) / math.sqrt(count)
        found, spread = -SPACING * apart / math.log(mean), SPACING * apart / math.log(mean) ** 2 * error / mean
        rows.append([f"{apart}", f"{mean:.4f} ± {error:.4f}", f"{math.exp(-SPACING * apart / length):.4f}", f"{found:.2f} ± {spread:.2f}"])
        print(*rows[-1], flush=True)
        good &= abs(mean - math.exp(-SPACING * apart / length)) < 3 * error + 0.02
    lines = [
        f"{count} Brownian filaments of {spheres} spheres with \\\\(EI/kT = {length}\\\\), four times the distance of neighbours:",
        "correlation of the axes of spheres that are so many bonds apart, with \\\\(e^{-s/l_p}\\\\) for the persistence length",
        "\\\\(l_p = EI/kT\\\\), and the length that the correlation gives. Errors are from the spread over the filaments.",
        "",
        *table(["bonds apart", "correlation", "exponential", "persistence length"], rows),
    ]
    return "### Persistence length", lines, good


def main():
    parts = [part() for part in (deflection, bending, twisting, buckling, settling, shear, persistence)]
    lines = []
    for title, text, _ in parts:
        lines += [title, "", *text, ""]
    write_section("filaments.md", "filaments", "Validation", lines)
    wrong = [title for title, _, good in parts if not good]
    if wrong:
        raise SystemExit(f"outside of the limits: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
