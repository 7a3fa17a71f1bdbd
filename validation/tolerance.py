"""Ratios of errors of single evaluations to the requested tolerance, in random cases of every kind, against solves to a tighter tolerance.

The errors of velocities, angular velocities and stresslets are each to be at most the tolerance times the norm that the page
`tolerance` defines. Cases are the same in every run; `--cases N` takes the first N of them. Draws whose spheres cannot be placed are skipped."""

import argparse
import collections
import itertools
import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support import arrangements
from support.page import table, write_section
from support.program import mobility

CASES, SEED = 500, 7
TOLERANCES, EXACT = (1e-2, 1e-3, 1e-4, 1e-6), 1e-8
KINDS = ("velocities", "angular_velocities", "stresslets")
# Lower bounds of norms, as fractions of the values for isolated spheres: in general, and for velocities under forces.
LEAST, LEAST_UNDER_FORCES = 0.1, 0.01
# Boxes and how often they are drawn.
BOXES = {
    "periodic": 0.16, "long": 0.08, "sheared": 0.14, "lattice": 0.16, "primitive cell": 0.04, "dense": 0.12,
    "between walls": 0.12, "above a wall": 0.06, "open": 0.06, "layer": 0.06,
}  # fmt: skip
BOUNDARIES = {
    "between walls": ["periodic", "periodic", "walls"],
    "above a wall": ["periodic", "periodic", "wall"],
    "layer": ["periodic", "periodic", "open"],
    "open": ["open"] * 3,
}
MODELS = {"forces alone": 0.1, "given stresslets": 0.1, "rigid": 0.35, "lubricated": 0.45}
LOADS = {"equal": 0.2, "weights": 0.15, "random": 0.15, "torques": 0.1, "forces and torques": 0.15, "shear": 0.15, "all": 0.1}


def drawn(random, choices):
    return str(random.choice(list(choices), p=list(choices.values())))


def placed(box, random):
    """A box, centres, radii and volume fraction; `None` if the spheres were not placed."""
    if box in ("lattice", "primitive cell"):
        name = str(random.choice(list(arrangements.CUBIC)))
        fraction = random.uniform(0.2, min(0.95 * arrangements.CLOSE_PACKED[name], 0.7))
        if box == "primitive cell":
            return {"box": arrangements.primitive_cell(name, fraction)}, np.array([[0.3, 0.2, 0.1]]), np.ones(1), fraction
        centres, edges = arrangements.lattice(name, fraction, int(random.choice([1, 2, 3] if name == "sc" else [1, 2])))
        moved = 1e-6 * random.normal(size=centres.shape) * (random.random() < 0.3)
        return {"box": edges}, centres + 0.1 + moved, np.ones(len(centres)), fraction
    if box == "dense":
        fraction = random.uniform(0.45, 0.62)
        # Full face-centred lattices, which fit the box without being compressed.
        centres, edges = arrangements.dense(int(random.choice([32, 32, 108])), fraction, int(random.integers(1000)))
        return {"box": edges}, centres, np.ones(len(centres)), fraction
    return dilute(box, random)


def dilute(box, random):
    """The same of up to 32 spheres of radii 1 to 8 at up to 45% by volume."""
    count, ratio = int(random.integers(2, 33)), float(random.choice([1, 1, 2, 4, 8]))
    large = np.arange(count) < max(1, count // 8) if ratio == 8 else random.random(count) < 0.5
    radii = np.where(large, ratio, 1.0)
    fraction = random.uniform(0.01, 0.45 if box in ("periodic", "long", "sheared") else 0.3)
    shape = np.ones(3)
    if box == "long":
        shape[random.integers(3)] = random.uniform(2, 6)
    if box in ("between walls", "above a wall", "layer"):
        shape[2] = random.uniform(0.3, 1.2)
    edges = shape * (arrangements.volume(radii) / fraction / shape.prod()) ** (1 / 3)
    edges = np.maximum(edges, 2.25 * radii.max())
    strain = random.uniform(-0.5, 0.5) if box == "sheared" else 0.0
    repeats = [kind == "periodic" for kind in BOUNDARIES.get(box, ["periodic"] * 3)]
    centres = arrangements.random(radii, edges, random, repeats, strain, gap=10 ** random.uniform(-3, -1))
    if centres is None:
        return None
    case = {"box": edges, "strain": strain} if strain else {"box": edges}
    return case, centres, radii, arrangements.volume(radii) / edges.prod()


def acting(box, model, radii, random):
    """Loads on the spheres, as keys of a case, and their name."""
    name = drawn(random, LOADS)
    if model == "forces alone":
        name = str(random.choice(["equal", "weights", "random"]))
    if model == "given stresslets" and name == "shear":
        name = "forces and torques"
    direction = random.normal(size=3)
    direction /= np.linalg.norm(direction)
    case, sizes = {}, radii[:, None]
    if name == "equal":
        case["forces"] = np.tile(direction, (len(radii), 1))
    if name == "weights":
        case["forces"] = sizes**3 * direction
    if name in ("random", "forces and torques", "all"):
        case["forces"] = random.normal(size=(len(radii), 3)) * sizes
    if name in ("torques", "forces and torques", "all"):
        case["torques"] = random.normal(size=(len(radii), 3)) * sizes**3
    if name in ("shear", "all"):
        gradient = np.zeros((3, 3))
        gradient[0, 2 if box in BOUNDARIES else 1] = 1.0
        case["background"] = {"velocity_gradient": gradient.tolist()}
    if model == "forces alone":
        case |= {"multipoles": "monopole", "rigid": False}
    if model == "given stresslets":
        case |= {"rigid": False, "stresslets": random.normal(size=(len(radii), 5)) * sizes**3}
    if model == "lubricated":
        case["lubrication"] = True
    return case, name


def sample(index):
    """A case, and its box, model and loads; `None` if the spheres were not placed."""
    random = np.random.default_rng([SEED, index])
    box, model = drawn(random, BOXES), drawn(random, MODELS)
    found = placed(box, random)
    if found is None:
        return None
    case, centres, radii, fraction = found
    loads, name = acting(box, model, radii, random)
    case |= {"viscosity": 1.0, "positions": centres, "radii": radii, **loads}
    if box in BOUNDARIES:
        case["boundaries"] = BOUNDARIES[box]
    return case, (box, model, name, len(radii), fraction)


def scales(case):
    """Lower bounds of the norms, by kind, from the values for isolated spheres."""
    radii = case["radii"]
    lengths = {key: np.linalg.norm(case[key], axis=1) for key in ("forces", "torques", "stresslets") if key in case}
    gradient = np.array(case.get("background", {}).get("velocity_gradient", np.zeros((3, 3))))
    driven = lengths.get("forces", 0) / (6 * np.pi * radii)
    other = radii * np.linalg.norm((gradient + gradient.T) / 2) + lengths.get("torques", 0) / (8 * np.pi * radii**2)
    other = other + lengths.get("stresslets", 0) / (20 / 3 * np.pi * radii**2)
    speeds = LEAST * (driven + other)
    of = {
        "velocities": LEAST_UNDER_FORCES * driven + LEAST * other,
        "angular_velocities": speeds / radii,
        "stresslets": 20 / 3 * np.pi * radii**2 * speeds,
    }
    return {kind: np.linalg.norm(values) for kind, values in of.items()}


def ratios(case):
    """By tolerance and kind, the error over the tolerance and the norm."""
    exact, least = mobility(case, EXACT), scales(case)
    for tolerance in TOLERANCES:
        found = mobility(case, tolerance)
        for kind in KINDS:
            # Skip angular velocities and stresslets that are zero or given.
            if not found.get(kind) or (kind == "stresslets" and "stresslets" in case):
                continue
            error = np.linalg.norm(np.subtract(found[kind], exact[kind]))
            yield tolerance, kind, error / (tolerance * max(np.linalg.norm(exact[kind]), least[kind]))


def measured_cases(count):
    """The numbers of cases, their names and ratios; as many programs at a time as there are cores."""
    drawn_cases = ((index, sample(index)) for index in itertools.count())
    placed_cases = itertools.islice((of for of in drawn_cases if of[1]), count)

    def measured(of):
        index, (case, names) = of
        return index, names, list(ratios(case))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(measured, placed_cases)


def rows(worst):
    """Rows of a table: the name, the number of cases, and by kind the largest ratio and the median."""
    for name, found in worst.items():
        cells = []
        for kind in KINDS:
            values = [ratio for _, of, ratio in found if of == kind]
            cells.append(f"{max(values):.2f} ({np.median(values):.2f})" if values else "")
        yield [name, str(len({case for case, _, _ in found})), *cells]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=CASES)
    parser.add_argument("--full", action="store_true")
    count = parser.parse_args().cases
    groups = {key: collections.defaultdict(list) for key in ("box", "model", "loads", "tolerance")}
    above = []
    for index, (box, model, loads, spheres, fraction), measured in measured_cases(count):
        for tolerance, kind, ratio in measured:
            for key, name in (("box", box), ("model", model), ("loads", loads), ("tolerance", f"{tolerance:.0e}")):
                groups[key][name].append((index, kind, ratio))
            if ratio > 1:
                above.append([str(index), f"{tolerance:.0e}", box, model, loads, str(spheres), f"{fraction:.2f}",
                              kind.replace("_", " "), f"{ratio:.2f}"])
                print(*above[-1], flush=True)
    worst = max(ratio for found in groups["box"].values() for _, _, ratio in found)
    lines = [
        f"{count} random cases, each at {len(TOLERANCES)} tolerances, compared with solves to {EXACT:.0e}: largest ratio of error to tolerance,",
        "and the median in parentheses.",
        "",
    ]
    for key, found in groups.items():
        lines += table([key, "cases", "velocities", "angular velocities", "stresslets"], rows(found)) + [""]
    count_of_all = sum(map(len, groups["box"].values()))
    lines += [f"{len(above)} of {count_of_all} ratios are above 1:" if above else f"The largest ratio is {worst:.2f}.", ""]
    if above:
        lines += table(["case", "tolerance", "box", "model", "loads", "spheres", "fraction", "kind", "error over tolerance"], above)
    write_section("tolerance.md", "tolerance", "Ratios of errors to tolerances", lines)
    print(f"{count} cases, largest ratio {worst:.2f}, {len(above)} above 1")
    if above:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
