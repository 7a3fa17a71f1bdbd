"""Viscosity of dense suspensions of rough spheres by volume fraction and friction, beside those of a code without far field
and published fits; with the contacts' share, normal stresses, evaluations and processor time.

    scripts/validate contacts           100 spheres, a strain of 6, at 54% with frictions of 0 and 1 alone
    scripts/validate contacts --full    200 spheres, a strain of 12, more fractions"""

import csv
import itertools
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support.estimates import mean_and_error
from support.page import table, write_section
from support.program import PROGRAM

FULL = "--full" in sys.argv[1:]
FRACTIONS = (0.40, 0.45, 0.50, 0.54) if FULL else (0.40, 0.45, 0.50)
FRICTIONS = (0.0, 0.3, 0.5, 1.0) if FULL else (0.0, 0.5, 1.0)
CASES = [*itertools.product(FRACTIONS, FRICTIONS), *([] if FULL else [(0.54, 0.0), (0.54, 1.0)])]
SPHERES, STRAIN, SETTLED = (200, 12.0, 2.0) if FULL else (100, 6.0, 2.0)
RATIO, STEP, ROUGHNESS = 1.4, 0.005, 0.005
# Of pair lubrication and contacts alone, 100 spheres of radii 1 and 1.4, half the volume each.
PAIRS_ALONE = {
    (0.40, 0.0): "6.1 ± 0.1", (0.40, 0.5): "8.8 ± 0.3", (0.40, 1.0): "9.8 ± 0.4",
    (0.45, 0.0): "9.1 ± 0.2", (0.45, 0.3): "12.9 ± 0.5", (0.45, 0.5): "16.1 ± 0.4", (0.45, 1.0): "19.9 ± 0.8",
    (0.50, 0.0): "14.1 ± 0.4", (0.50, 0.5): "35.5 ± 1.3", (0.50, 1.0): "72 ± 4", (0.54, 0.0): "19.5 ± 0.7",
}


def fit(fraction, friction):
    """Of Lobry et al., J. Fluid Mech. 860, 682 (2019), without its prefactor of 0.7 to 1."""
    decay = (np.exp(-2.5 * np.arctan(friction)) - np.exp(-1.25 * np.pi)) / (1 - np.exp(-1.25 * np.pi))
    return (1 - fraction / (0.546 + 0.094 * decay)) ** -2


def scene(fraction, friction, spheres=SPHERES, seed=2, stiffness='"auto"', step=STEP):
    number = spheres / (1 + RATIO**-3)
    counts = {1.0: round(number), RATIO: round(number / RATIO**3)}
    volume = sum(4 / 3 * np.pi * radius**3 * count for radius, count in counts.items())
    edge = (volume / fraction) ** (1 / 3)
    species = "".join(f'[[species]]\nname = "{a:g}"\nradius = {a}\ncount = {n}\n' for a, n in counts.items())
    return f"""seed = {seed}
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
flow = {{ kind = "shear", rate = 1.0 }}
contacts = {{ friction = {friction}, roughness = {ROUGHNESS}, stiffness = {stiffness} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = {step}, duration = {STRAIN} }}
output = {{ trajectory_every = 0, observables_every = 1, checkpoint_every = 0 }}
{species}"""


def measured(*case):
    """Columns of the time series of a scene, and processor seconds."""
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / "scene.toml"
        path.write_text(scene(*case))
        timed = subprocess.run(
            ["bash", "-c", 'TIMEFORMAT=%U; time "$@"', "-", PROGRAM, "run", path, "--out", f"{place}/out", "--threads", "1"],
            capture_output=True, text=True)
        if timed.returncode:
            raise SystemExit(f"{case}: {timed.stderr}")
        with open(f"{place}/out/observables.csv") as file:
            rows = list(csv.DictReader(file))
    columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    return columns, float(timed.stderr.strip().splitlines()[-1])


def row(case):
    fraction, friction = case
    columns, seconds = measured(*case)
    late = columns["time"] >= SETTLED
    viscosity, error = mean_and_error(columns["relative_viscosity"][late], 8)
    contact = sum(values for name, values in columns.items() if name.startswith("stress_contact_xy"))
    mean = {name: values[late].mean() for name, values in columns.items()}
    normal = mean["second_normal_stress_difference"] / viscosity
    cells = [
        f"{fraction:.0%}", f"{friction:g}", f"{viscosity:.1f} ± {error:.1f}", PAIRS_ALONE.get(case, ""), f"{fit(*case):.1f}",
        f"{contact[late].mean() / viscosity:.2f}", f"{normal:+.2f}", f"{mean['particle_pressure'] / viscosity:.2f}",
        f"{mean['contacts_per_particle']:.2f}", f"{mean['sliding_contacts']:.2f}" if friction else "",
        f"{columns['largest_overlap'][late].max():.2f}", f"{columns['evaluations'][late].mean() / STEP:.0f}", f"{seconds / STRAIN:.1f}",
    ]
    print(*cells, flush=True)
    return cells, columns


def main():
    with ThreadPoolExecutor(2) as two:
        results = list(two.map(row, CASES))
    viscosities = {case: columns["relative_viscosity"][columns["time"] >= SETTLED].mean()
                   for case, (_, columns) in zip(CASES, results)}
    header = ["φ", "μ", "relative viscosity", "pairs alone", "fit", "of contacts", "N2 / stress", "pressure / stress", "contacts",
              "sliding", "largest overlap", "evaluations / strain", "CPU s / strain"]
    lines = [
        f"{SPHERES} spheres of radii 1 and {RATIO}, half the volume each, roughness {ROUGHNESS}, tolerance 1e-2, steps of {STEP} in strain,",
        f"averages from a strain of {SETTLED:g} to {STRAIN:g} in one run, one thread, two runs at a time. Beside the viscosity: that of pair",
        "lubrication and contacts without a far field, and (1 - φ/φ_m)^-2 with φ_m(μ) of Lobry et al. (2019), which has a prefactor of",
        "0.7 to 1. Stresses are over the whole shear stress; contacts are those of a sphere in the mean.",
        "",
        *table(header, [cells for cells, _ in results]),
    ]
    write_section("dense.md", "contacts", "Viscosity by volume fraction and friction", lines)
    failed = [f"at {fraction:.0%} friction makes it no more viscous" for fraction in FRACTIONS
              if not viscosities[fraction, 0.0] < viscosities[fraction, 0.5] < 1.1 * viscosities[fraction, 1.0]]
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
