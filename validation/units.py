"""The same problems in other units: spheres at random positions in thirty systems of units, and short runs in several."""

import csv
import itertools
import pathlib
import subprocess
import tempfile

import numpy as np
from support.page import table, write_section
from support.program import PROGRAM, ROOT, mobility, series

# Allowed differences by tolerance: grids are f32 at 1e-3 and f64 at 1e-7.
ALLOWED = {1e-3: 1e-6, 1e-7: 1e-12}
# Tolerance of runs, and allowed difference: rounding can decide whether a solve takes one more iteration.
ALLOWED_OF_RUN = 1e-4
# Units of length, viscosity and force.
SI = (2.5e-6, 1e-3, 6.4e-13)
SYSTEMS = [
    tuple(digits * 10.0**exponent for digits, exponent in zip((1.37, 0.83, 2.71), exponents))
    for exponents in [*itertools.product((-30, 0, 30), repeat=3), (-6, -3, -12), (7, 0, 1), (-13, 22, 5)]
]
OF_RUNS = (SI, SYSTEMS[0], SYSTEMS[8], SYSTEMS[18], SYSTEMS[26])


def spheres(strain=0.0, count=8, edge=8.0, seed=4):
    """A case of spheres of radii 1 and 1.5 at random positions, at least 0.1 apart."""
    random = np.random.default_rng(seed)
    radii, centres = np.resize([1.0, 1.5], count), []
    while len(centres) < count:
        centre = random.random(3) * edge
        apart = [separation(centre - other, edge, strain) for other in centres]
        if all(gap > radii[i] + radii[len(centres)] + 0.1 for i, gap in enumerate(apart)):
            centres.append(centre)
    force = random.standard_normal((count, 3))
    torque = random.standard_normal((count, 3))
    gradient = np.array([[0.1, 0.3, 0.0], [-0.2, 0.1, 0.2], [0.0, 0.4, -0.2]])
    return {"box": np.full(3, edge), "strain": strain, "viscosity": 1.0, "positions": np.array(centres), "radii": radii,
            "forces": force, "torques": torque, "background": {"velocity_gradient": gradient}}


def separation(between, edge, strain):
    """The distance to the nearest image in a cubic box of a strain."""
    images = np.array(list(itertools.product((-1, 0, 1), repeat=3))) @ (edge * np.array([[1, 0, 0], [strain, 1, 0], [0, 0, 1]]))
    return np.linalg.norm(between - np.round(between / edge) * edge * [1, 0, 1] + images, axis=1).min()


def in_units(case, units):
    """The case in other units of length, viscosity and force."""
    length, viscosity, force = units
    factors = {"box": length, "positions": length, "radii": length, "viscosity": viscosity, "forces": force, "torques": force * length}
    scaled = {key: value * factors[key] if key in factors else value for key, value in case.items()}
    gradient = case["background"]["velocity_gradient"] * force / (viscosity * length**2)
    return scaled | {"background": {"velocity_gradient": gradient.tolist()}}


def answer(case, units, tolerance):
    """Velocities, angular velocities, rates of strain and stresslets of a case in other units, converted back."""
    length, viscosity, force = units
    found = mobility(in_units(case, units), tolerance)
    rate = force / (viscosity * length**2)
    factors = {"velocities": rate * length, "angular_velocities": rate, "strain_rates": rate, "stresslets": force * length}
    return {name: np.array(found[name]) / factor for name, factor in factors.items()}


def difference(found, expected):
    """The largest difference of any answer over its norm; rates of strain of rigid spheres are zero."""
    names = ("velocities", "angular_velocities", "stresslets")
    return max(np.linalg.norm(found[name] - expected[name]) / np.linalg.norm(expected[name]) for name in names)


def worst_answer(lubrication, tolerance, strain=0.0, systems=SYSTEMS):
    """The largest difference between the answers in any units and those in units of 1."""
    case = spheres(strain) | {"lubrication": lubrication}
    expected = answer(case, (1.0, 1.0, 1.0), tolerance)
    return max(difference(answer(case, units, tolerance), expected) for units in systems)


KINDS = ("settling", "calibrated", "adaptive", "sheared", "lubricated", "forces alone")
# Powers of length, viscosity and force of the columns of the time series.
DIMENSIONS = {"time": (2, 1, -1), "mean_velocity": (-1, -1, 1), "velocity_variance": (-2, -2, 2), "smallest_gap": (1, 0, 0)}
DIMENSIONS |= {name: (-2, 0, 1) for name in ("stress_", "first_normal", "second_normal", "particle_pressure")}
DIMENSIONS |= {name: (0, 0, 0) for name in ("relative_viscosity", "segregation")}


def scene(kind, units):
    """Text of a scene in given units of length, viscosity and force; in units of 1 its viscosity is 1."""
    length, viscosity, force = units
    time = viscosity * length**2 / force
    fixed = f"time = {{ step = {0.02 * time!r}, steps = 4, order = 2 }}\n"
    adaptive = f'time = {{ step = {0.1 * time!r}, steps = 3, integrator = "adaptive" }}\n'
    shear = f'flow = {{ kind = "shear", rate = {1 / time!r}, lees_edwards = true }}\n'
    repulsion = f"repulsion = {{ strength = {10 * force!r}, range = 0.2 }}\n"
    least = f"repulsion = {{ strength = {3 * force / length!r}, radius_power = 1, calibrate = true }}\n"
    bodies = {
        "settling": fixed + repulsion + "statistics.every = 1\n",
        "calibrated": fixed + least,
        "adaptive": adaptive,
        "sheared": fixed + shear + repulsion + "statistics.every = 1\n",
        "lubricated": adaptive + shear + "hydrodynamics.lubrication = true\n",
        "forces alone": fixed + 'hydrodynamics.multipoles = "monopole"\nhydrodynamics.method = "direct"\n',
    }
    weights = (0, 0) if kind in ("sheared", "lubricated") else (-6 * force, -10 * force)
    return f"""seed = 5
box.edges = [{10 * length!r}, {10 * length!r}, {12 * length!r}]
fluid.viscosity = {viscosity!r}
hydrodynamics.tolerance = {ALLOWED_OF_RUN!r}
output = {{ observables_every = 1, trajectory_every = 0 }}
particles = {{ initial = "random", minimum_gap = {0.01 * length!r} }}
{bodies[kind]}""" + "".join(f"""
[[species]]
name = "{name}"
radius = {radius * length!r}
count = 10
force = [0.0, 0.0, {weight!r}]
""" for name, radius, weight in zip(("light", "heavy"), (1.0, 1.3), weights))


def powers_of(column):
    """The powers of a column of the time series; none for what has no units or depends on the machine."""
    return next((powers for start, powers in DIMENSIONS.items() if column.startswith(start)), None)


def in_units_of_one(kind, units):
    """The time series of a run, by column, in units of 1."""
    rows = series(scene(kind, units))
    names = [name for name in rows[0] if powers_of(name)]
    factors = {name: np.prod([unit**power for unit, power in zip(units, powers_of(name))]) for name in names}
    return {name: np.array([row[name] for row in rows]) / factors[name] for name in names}


def difference_of_runs(kind, units, expected):
    """The largest difference in any column over the largest number of a column with the same dimensions."""
    found, largest = in_units_of_one(kind, units), {}
    for name, values in expected.items():
        largest[powers_of(name)] = max(largest.get(powers_of(name), 0.0), np.abs(values).max())
    scaled = {name: np.abs(found[name] - values).max() / largest[powers_of(name)] for name, values in expected.items() if values.any()}
    return max(scaled.values())


def worst_run(kind, systems=OF_RUNS):
    """The largest difference between a run in any units and the same in units of 1."""
    expected = in_units_of_one(kind, (1.0, 1.0, 1.0))
    return max(difference_of_runs(kind, units, expected) for units in systems)


def printed(command):
    """Output of the program at the end, without its progress lines."""
    ended = subprocess.run([PROGRAM, *map(str, command)], check=True, capture_output=True, text=True)
    lines = (ended.stdout + ended.stderr).splitlines()
    return [line for line in lines if not line.startswith("step ")]


def silica():
    """Output of `check` and `run` for the scene in SI units, and its results."""
    path = ROOT / "scenes" / "silica-in-water.toml"
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place) / "silica-in-water"
        checked, ended = printed(["check", path]), printed(["run", path, "--out", folder])
        with open(folder / "observables.csv") as file:
            rows = list(csv.DictReader(file))
    ended = [line.replace(str(folder), "results/silica-in-water") for line in ended]
    header = ["time (s)", "mean velocity (m/s)", "over the Stokes velocity", "smallest gap (m)"]
    stokes = 2 / 9 * 1000 * 9.81 * 2.5e-6**2 / 1e-3
    numbers = [[float(row[name]) for name in ("time", "mean_velocity_z[silica]", "smallest_gap")] for row in rows]
    cells = [[f"{t:g}", f"{v:.3e}", f"{-v / stokes:.3f}", f"{gap:.2e}"] for t, v, gap in numbers]
    blocks = [["```text", f"$ fcm-solve {command}", *lines, "```", ""] for command, lines in
              (("check scenes/silica-in-water.toml", checked), ("run scenes/silica-in-water.toml", ended))]
    remark = "The spheres settle more slowly than an isolated one, since the displaced fluid flows upwards between them:"
    return [*sum(blocks, []), remark, "", *table(header, [cells[i] for i in (0, 50, 100, 200)]), ""]


def main():
    failed, rows = [], []
    for (tolerance, allowed), lubrication, strain in itertools.product(ALLOWED.items(), (False, True), (0.0, 0.3)):
        worst = worst_answer(lubrication, tolerance, strain)
        kind = ("lubricated" if lubrication else "rigid") + (", sheared box" if strain else "")
        rows.append([f"eight spheres, {kind}", f"{tolerance:g}", str(len(SYSTEMS)), f"{worst:.1e}", f"{allowed:g}"])
        failed += [f"{kind} at {tolerance:g}: {worst:.1e}"] if worst > allowed else []
    for kind in KINDS:
        worst = worst_run(kind)
        rows.append([f"run, {kind}", f"{ALLOWED_OF_RUN:g}", str(len(OF_RUNS)), f"{worst:.1e}", f"{ALLOWED_OF_RUN:g}"])
        failed += [f"run, {kind}: {worst:.1e}"] if worst > ALLOWED_OF_RUN else []
    header = ["case", "tolerance", "systems of units", "largest difference", "allowed"]
    lines = ["Differences from the results in units of 1, relative to the norm of the result, or in a run to the largest"]
    lines += ["value with the same dimensions.", ""]
    lines += table(header, rows)
    lines = [*silica(), "### Thirty systems of units", "", *lines]
    write_section("si-units.md", "units", "Output, and other systems of units", lines)
    print("\n".join(lines))
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
