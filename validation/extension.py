"""The viscosity of dense suspensions in planar extension over that in shear, from the same starts.

Both are the stress along the rate of strain over twice that rate: four times as much extensional stress as shear stress for the
same viscosity (Trouton). An extension of half the rate of the shear dissipates as much in the fluid alone."""

import csv
import pathlib
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support.page import table, write_section
from support.program import run

FULL = "--full" in sys.argv[1:]
SEEDS = range(1, 4 if FULL else 2)
COUNTS = {1.0: 73, 1.4: 27}
# Ratio of pair lubrication and contacts alone with its error, by volume fraction and friction.
PAIRS_ALONE = {(0.40, 0.0): (1.02, 0.03), (0.45, 0.0): (0.98, 0.04), (0.45, 0.5): (1.00, 0.08), (0.50, 0.0): (0.96, 0.04), (0.50, 0.5): None}
CASES = list(PAIRS_ALONE) if FULL else [(0.40, 0.0), (0.45, 0.5)]
FLOWS = {"shear": 1.0, "planar-extension": 0.5}
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


def viscosities(case):
    """Means of the viscosity over parts of a run."""
    with tempfile.TemporaryDirectory() as place:
        out = pathlib.Path(place) / "out"
        ended = run(scene(*case), out)
        if ended.returncode:
            raise SystemExit(ended.stderr)
        with open(out / "observables.csv") as file:
            rows = [(float(row["time"]), float(row["relative_viscosity"])) for row in csv.DictReader(file)]
    late = np.array([viscosity for time, viscosity in rows if time > SETTLED])
    return [block.mean() for block in np.array_split(late, 4)]


def mean(found, case, flow):
    """Mean over starts and parts of the runs, with its error."""
    blocks = np.concatenate([found[(*case, flow, seed)] for seed in SEEDS])
    return blocks.mean(), blocks.std(ddof=1) / np.sqrt(len(blocks))


def main():
    runs = [(*case, flow, seed) for case in CASES for flow in FLOWS for seed in SEEDS]
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(runs, two.map(viscosities, runs)))
    rows, failed = [], []
    for case in CASES:
        (shear, of_shear), (extension, of_extension) = (mean(found, case, flow) for flow in FLOWS)
        ratio = extension / shear
        error = ratio * np.hypot(of_shear / shear, of_extension / extension)
        pairs = PAIRS_ALONE[case]
        rows.append([f"{case[0]:.0%}", f"{case[1]:g}", f"{shear:.1f} ± {of_shear:.1f}", f"{extension:.1f} ± {of_extension:.1f}",
                     f"{ratio:.2f} ± {error:.2f}", f"{pairs[0]:.2f} ± {pairs[1]:.2f}" if pairs else ""])
        print(*rows[-1], flush=True)
        if abs(ratio - 1.0) > ALLOWED + 2.0 * error:
            failed.append(f"{case}: {ratio:.2f} ± {error:.2f}")
    lines = [
        f"{sum(COUNTS.values())} spheres of radii 1 and 1.4, half the volume each, means over times from {SETTLED:g} to {END:g} of {len(SEEDS)} "
        f"start{'s' if len(SEEDS) > 1 else ''}, in shear at",
        "a rate of 1 and in planar extension at 0.5; errors are those of means over quarters of the runs. Relative viscosities are",
        f"`relative_viscosity`; ratios of {1 - ALLOWED:g} to {1 + ALLOWED:g} are allowed, and two errors beyond. Beside the ratio: that of pair lubrication and",
        "contacts without a far field.",
        "",
        *table(["φ", "μ", "shear", "planar extension", "ratio", "pairs alone"], rows),
    ]
    write_section("dense.md", "extension", "Planar extension over shear", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
