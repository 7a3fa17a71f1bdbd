"""Two spheres of unequal size settle: Fig. 2 of Abbas, Climent, Simonin & Maxey, Phys. Fluids 18, 121504 (2006).

Sphere 2 is twice as large as sphere 1. For four ratios of their excess densities and several separations, U12 and V12 are the
relative velocities with the line of centres along and across gravity. The program evaluates them in cubic periodic boxes of
two sizes, and extrapolates to an infinite box: the effect of images on a relative velocity decreases as the cube of the edge,
since the terms in 1/L are the same for both spheres."""

import concurrent.futures
import csv
import json
import os
import pathlib
import subprocess
import tempfile
from fractions import Fraction

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = os.environ.get("FCM_SOLVE", str(TARGET / "release" / "fcm-solve"))
TABLE = ROOT / "docs" / "src" / "pair-settling.md"
FIGURE = ROOT / "docs" / "src" / "figures" / "pair-settling.svg"

RADII = (1.0, 2.0)
# The smaller box is this long, or this many separations; the larger one twice that.
EDGE, SEPARATIONS = 60.0, 10.0
# The effect of the images on a relative velocity decreases as this power of the side of the box.
POWER = 3
TOLERANCE = 1e-7
# Allowed difference: the tolerance, magnified by the extrapolation, and higher-order effects of images.
LIMIT = 1e-5
MULTIPOLES = ("monopole", "dipole")
LINES = ("vertical", "horizontal")


def read_reference():
    """Velocities in unbounded fluid, exact and by the method, by (separation, density ratio, line of centres)."""
    with open(ROOT / "validation" / "data" / "pair-settling.csv") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {
            (float(row["separation"]), Fraction(row["density_ratio"]), row["line_of_centres"]): {
                kind: float(row[kind]) for kind in ("exact", *MULTIPOLES)
            }
            for row in rows
        }


def evaluate(multipoles, separation, edge, loaded):
    """Velocities of both spheres along x, their line of centres, and along z, across it, when the force 6 pi acts on one sphere
    in both directions, which are independent. Viscosity 1."""
    force = 6 * np.pi * np.array([1.0, 0.0, 1.0])
    case = {
        "box": [edge] * 3,
        "viscosity": 1.0,
        "positions": [[0.25, 0.25, 0.25], [0.25 + separation, 0.25, 0.25]],
        "radii": RADII,
        "forces": [(force if sphere == loaded else 0 * force).tolist() for sphere in (0, 1)],
        "multipoles": multipoles,
    }
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "case.json"
        path.write_text(json.dumps(case))
        command = [PROGRAM, "mobility", str(path), "--tolerance", str(TOLERANCE), "--threads", "1"]
        answer = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    velocities = np.array(json.loads(answer)["velocities"])
    return dict(zip(LINES, (velocities[:, 0], velocities[:, 2])))


def relative_velocity(velocities, density_ratio, line):
    """(V2 - V1) along gravity over the Stokes velocity of sphere 2, from the velocities due to each sphere's load.
    The weights are proportional to the excess densities times the volumes; that of sphere 1 is 6 pi, its Stokes velocity 1."""
    size_ratio = RADII[1] / RADII[0]
    weights = (1.0, float(density_ratio) * size_ratio**3)
    both = sum(weight * velocity[line] for weight, velocity in zip(weights, velocities))
    return (both[1] - both[0]) / (float(density_ratio) * size_ratio**2)


def boxes(distance):
    """Edges of the two boxes for a distance of the spheres."""
    small = max(EDGE, SEPARATIONS * distance)
    return small, 2 * small


def compute(keys):
    """The relative velocities in the limit of a large box, by (multipoles, separation, density ratio, line)."""
    distances = sorted({separation * RADII[1] for separation, _, _ in keys})
    jobs = [(m, distance, edge, n) for m in MULTIPOLES for distance in distances for edge in boxes(distance) for n in (0, 1)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(jobs, pool.map(lambda job: evaluate(*job), jobs)))
    scale = 2**POWER
    answers = {}
    for multipoles in MULTIPOLES:
        for separation, ratio, line in keys:
            distance = separation * RADII[1]
            small, large = (
                relative_velocity([found[multipoles, distance, edge, n] for n in (0, 1)], ratio, line)
                for edge in boxes(distance)
            )
            answers[multipoles, separation, ratio, line] = (scale * large - small) / (scale - 1)
    return answers


def draw(reference, answers):
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    ratios = sorted({ratio for _, ratio, _ in reference}, reverse=True)
    for axes, line, name in zip(panels, LINES, ("U", "V")):
        for number, ratio in enumerate(ratios):
            keys = [key for key in reference if key[1:] == (ratio, line)]
            separations = [key[0] for key in keys]
            colour = f"C{number}"
            axes.plot(separations, [reference[key]["exact"] for key in keys], color=colour, label=f"$\\gamma$ = {ratio}")
            for multipoles, mark in zip(MULTIPOLES, ("o", "*")):
                values = [answers[multipoles, *key] for key in keys]
                axes.plot(separations, values, mark, color=colour, fillstyle="none", markersize=6)
        axes.set_xlabel("separation $r/a_2$")
        axes.set_ylabel(f"${name}_{{12}} / V_{{o2}}$, line of centres {line}")
        axes.axvline(1.5, color="0.7", linewidth=0.8)
    panels[0].plot([], [], "ko", fillstyle="none", label="FCM monopole")
    panels[0].plot([], [], "k*", fillstyle="none", label="FCM monopole and dipole")
    panels[0].legend(fontsize=8)
    plt.rcParams["svg.hashsalt"] = "pair-settling"
    figure.savefig(FIGURE, metadata={"Date": None})


def differences(reference, answers):
    """The largest difference from the method in unbounded fluid, by multipoles."""
    return {m: max(abs(answers[m, *key] - reference[key][m]) for key in reference) for m in MULTIPOLES}


def write_table(reference, answers, worst):
    lines = [
        "# Two unequal spheres settling",
        "",
        "Written by `scripts/validate pair-settling`; do not edit.",
        "",
        "The case of Fig. 2 of Abbas, Climent, Simonin & Maxey (2006), after Wacholder & Sather (1974): two spheres, the",
        "second with twice the radius of the first, settle in unbounded fluid. U12 and V12 are the velocity of the large",
        "sphere minus that of the small one, along gravity, with the line of centres along and across gravity, in units of",
        "the large sphere's Stokes velocity; γ is the ratio of the excess densities, large over small; r/a₂ = 1.5 is contact.",
        "",
        f"Each entry is extrapolated from two cubic periodic boxes, evaluated to a relative {TOLERANCE:g}. The edge of one is {EDGE:g} a₁, or",
        f"{SEPARATIONS:g} r if that is larger; the other is twice as large. The effect of the images decays as 1 / L^{POWER}. The largest",
        f"difference from the method's answer in unbounded fluid is {worst['monopole']:.1e} (monopole) and {worst['dipole']:.1e} (monopole and",
        "dipole). The remaining difference between these columns and the exact solution is the truncation error of the method,",
        "not an error of the program.",
        "",
        "![Relative settling velocities](figures/pair-settling.svg)",
        "",
    ]
    for ratio in sorted({ratio for _, ratio, _ in reference}, reverse=True):
        lines += [
            f"## γ = {ratio}",
            "",
            "| r/a₂ | U12 exact | monopole | dipole | V12 exact | monopole | dipole |",
            "|---|---|---|---|---|---|---|",
        ]
        for separation in sorted({key[0] for key in reference}):
            cells = [f"{separation:g}"]
            for line in LINES:
                key = (separation, ratio, line)
                cells += [f"{value:.5f}" for value in (reference[key]["exact"], *(answers[m, *key] for m in MULTIPOLES))]
            lines.append("| " + " | ".join(cells) + " |")
        lines.append("")
    TABLE.write_text("\n".join(lines).rstrip() + "\n")


def main():
    reference = read_reference()
    answers = compute(list(reference))
    worst = differences(reference, answers)
    draw(reference, answers)
    write_table(reference, answers, worst)
    for multipoles, difference in worst.items():
        print(f"{multipoles:9s} differs from the method in unbounded fluid by at most {difference:.1e}")
    print(f"table      {TABLE}\nfigure     {FIGURE}")
    if max(worst.values()) > LIMIT:
        raise SystemExit(f"failed: the difference should be below {LIMIT:g}")


if __name__ == "__main__":
    main()
