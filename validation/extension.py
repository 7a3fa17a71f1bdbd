"""The viscosities of dense suspensions in planar, uniaxial and biaxial extension over that in shear, from the same starts.

All are the stress along the rate of strain over twice that rate: for the same viscosity the extensional stress is four times the shear
stress in planar (Trouton), three times in uniaxial and six times in biaxial extension. The rates of extension, 1/2, 1/sqrt(3) and
1/sqrt(12) of the shear rate, give the same dissipation as the shear in the fluid alone.

The viscosity in planar extension must be that in shear; the others depend on normal stresses. In a Reiner-Rivlin fluid, with a stress
proportional to the square of the rate of strain besides the viscous one, a second normal stress difference N2 in shear, and none of the
first, the ratio is 1 in planar, 1 + N2 / (sqrt(3) s) in uniaxial and 1 - N2 / (sqrt(3) s) in biaxial extension, with s the shear
stress. That must hold without friction; with friction both values are given."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support.page import table, write_section
from support.program import series

FULL = "--full" in sys.argv[1:]
SEEDS = range(1, 4 if FULL else 2)
COUNTS = {1.0: 73, 1.4: 27}
# Ratio in planar extension by pair lubrication and contacts alone with its error, by volume fraction and friction.
PAIRS_ALONE = {(0.40, 0.0): (1.02, 0.03), (0.45, 0.0): (0.98, 0.04), (0.45, 0.5): (1.00, 0.08), (0.50, 0.0): (0.96, 0.04), (0.50, 0.5): None}
CASES = list(PAIRS_ALONE) if FULL else [(0.40, 0.0), (0.45, 0.5)]
FLOWS = {"shear": 1.0, "planar-extension": 0.5, "uniaxial-extension": 3**-0.5, "biaxial-extension": 12**-0.5}
SHEAR, *EXTENSIONS = FLOWS
# Contribution of N2 over the shear stress to the ratio.
OF_NORMAL_STRESS = {"planar-extension": 0.0, "uniaxial-extension": 3**-0.5, "biaxial-extension": -(3**-0.5)}
COLUMNS = ["relative_viscosity", "second_normal_stress_difference"]
SETTLED, END, STEP = 2.0, 6.0, 0.005
ALLOWED = 0.1


def scene(fraction, friction, flow, seed):
    edge = (sum(4 / 3 * np.pi * radius**3 * count for radius, count in COUNTS.items()) / fraction) ** (1 / 3)
    species = "".join(f'[[species]]\nname = "{a:g}"\nradius = {a}\ncount = {n}\n' for a, n in COUNTS.items())
    return f"""seed = {seed}
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
flow = {{ kind = "{flow}", rate = {FLOWS[flow]} }}
contacts = {{ friction = {friction} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = {STEP}, duration = {END} }}
output = {{ trajectory_every = 0, observables_every = 2, checkpoint_every = 0 }}
{species}"""


def observed(case):
    """Means of the viscosity and of N2 over parts of a run, where the fluid and the shear have a viscosity and a rate of 1."""
    late = np.array([[row[name] for name in COLUMNS] for row in series(scene(*case)) if row["time"] > SETTLED])
    return [block.mean(axis=0) for block in np.array_split(late, 4)]


def mean(found, case, flow, column=0):
    """Mean over starts and parts of the runs, with its error."""
    blocks = np.concatenate([found[(*case, flow, seed)] for seed in SEEDS])[:, column]
    return blocks.mean(), blocks.std(ddof=1) / np.sqrt(len(blocks))


def ratio(extension, shear):
    """Over the viscosity in shear, with its error."""
    found = extension[0] / shear[0]
    return found, found * np.hypot(extension[1] / extension[0], shear[1] / shear[0])


def main():
    runs = [(*case, flow, seed) for case in CASES for flow in FLOWS for seed in SEEDS]
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(runs, two.map(observed, runs)))
    rows, failed = [], []
    for case in CASES:
        shear, pairs = mean(found, case, SHEAR), PAIRS_ALONE[case]
        normal = mean(found, case, SHEAR, 1)[0] / shear[0]
        ratios = [ratio(mean(found, case, flow), shear) for flow in EXTENSIONS]
        expected = [1.0 + OF_NORMAL_STRESS[flow] * normal for flow in EXTENSIONS]
        both = [f"{value:.2f} ± {error:.2f} ({wanted:.2f})" for (value, error), wanted in zip(ratios, expected)]
        rows.append([f"{case[0]:.0%}", f"{case[1]:g}", f"{normal:.2f}", *both,
                     f"{pairs[0]:.2f} ± {pairs[1]:.2f}" if pairs else ""])
        print(*rows[-1], flush=True)
        off = [abs(value - wanted) > ALLOWED + 2.0 * error for (value, error), wanted in zip(ratios, expected)]
        meant = EXTENSIONS if case[1] == 0.0 else EXTENSIONS[:1]
        failed += [f"{case}, {flow}: {text}" for flow, text, is_off in zip(meant, both, off) if is_off]
    starts = f"{len(SEEDS)} start{'s' if len(SEEDS) > 1 else ''}"
    lines = [
        f"{sum(COUNTS.values())} spheres of radii 1 and 1.4, half the volume each, averaged over times from {SETTLED:g} to {END:g} and {starts}:",
        "\\\\(N_2\\\\) over the shear stress at a rate of 1, and the viscosities in extension at rates of 1/2, 1/√3 and 1/√12",
        "relative to that in shear. Errors are from quarters of the runs. In parentheses is the ratio expected from the normal",
        "stress, \\\\(1 \\pm N_2 / (\\sqrt3\\\\, s)\\\\) in uniaxial and biaxial extension, for an otherwise Newtonian fluid. Ratios",
        f"must agree with it within {ALLOWED:g} plus two errors, in planar extension at any friction and in all flows without friction.",
        "With friction, the viscosity in uniaxial extension is found to equal that in shear in spite of the normal stress. The",
        "last column is the ratio in planar extension for pair lubrication and contacts without a far field.",
        "",
        *table(["φ", "μ", "N₂ over stress", "planar", "uniaxial", "biaxial", "pairs only"], rows),
    ]
    write_section("dense.md", "extension", "Extension over shear", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
