"""The viscosity of random suspensions against the volume fraction: 1 + 5/2 phi as phi -> 0 (Einstein), and the next coefficient.

Random positions without overlap, before any strain, give the high-frequency viscosity. Its coefficient of phi^2 is 5.0 for
spheres (Cichocki & Felderhof, J. Chem. Phys. 89, 3705, 1988; 5.2 by Batchelor & Green, 1972). The coefficient 7.6 of Batchelor &
Green is that of the steady pair distribution in the flow."""

import math
import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "validation" / "figures"))
from runs import Run, make, over_seeds, volume

PAGE = ROOT / "docs" / "src" / "viscosity.md"
FRACTIONS = (0.005, 0.01, 0.02, 0.05, 0.10, 0.15, 0.20)
SPHERES, SEEDS = 200, 16
# Coefficients of phi and, with lubrication, of phi^2.
EXPECTED, SECOND = 2.5, 5.0


def runs(phi, lubrication, seeds=SEEDS, spheres=SPHERES):
    """One evaluation for each seed."""
    edge = (spheres * volume(1) / phi) ** (1 / 3)

    def scene(seed):
        return {
            "seed": seed,
            "box": {"edges": [edge] * 3},
            "fluid": {"viscosity": 1.0},
            "species": [{"name": "sphere", "radius": 1.0, "volume_fraction": phi}],
            "particles": {"initial": "random"},
            "flow": {"kind": "shear", "rate": 1.0, "lees_edwards": True},
            "hydrodynamics": {"tolerance": 1e-3, "lubrication": lubrication},
            "time": {"step": 0.01, "steps": 0},
            "output": {"trajectory_every": 0},
        }

    kind = "lubrication" if lubrication else "far"
    return [Run(f"viscosity/{kind}-{phi:g}-{spheres}-{seed}", scene(seed)) for seed in range(1, seeds + 1)]


def relative_viscosity(run):
    """Relative viscosity of one evaluation."""
    return run.series("relative_viscosity")[1][0], math.nan


def compute(fractions, seeds=SEEDS, spheres=SPHERES):
    """Viscosity and its error by (volume fraction, lubrication)."""
    cases = {(phi, lub): runs(phi, lub, seeds, spheres) for phi in fractions for lub in (False, True)}
    make(sum(cases.values(), []))
    return {case: over_seeds(made, relative_viscosity) for case, made in cases.items()}


def coefficients(found, lubrication):
    """Coefficients of phi, phi^2 and phi^3 in the viscosity minus 1, with their errors, by weighted least squares."""
    points = [(phi, *value) for (phi, lub), value in found.items() if lub == lubrication]
    phi, value, error = map(np.array, zip(*points))
    matrix = np.transpose([phi, phi**2, phi**3]) / error[:, None]
    covariance = np.linalg.inv(matrix.T @ matrix)
    return list(zip(covariance @ matrix.T @ ((value - 1) / error), np.sqrt(np.diag(covariance))))


def write_table(found):
    lines = [
        "# Viscosity of dilute suspensions",
        "",
        "Written by `scripts/validate viscosity`; do not edit.",
        "",
        f"High-frequency relative viscosity of {SPHERES} equal spheres at random positions in a periodic box: the mean of",
        f"{SEEDS} random configurations with its standard error. The last columns have the intrinsic viscosity, (η - 1) / φ. For higher",
        "volume fractions see",
        "[viscosity and self-mobility](lubrication.md#viscosity-and-self-mobility-scriptsvalidate-high-frequency-viscosity), for lattices",
        "[limits of lubricated FCM](limits.md).",
        "",
        "| φ | 1 + 5/2 φ | 1 + 5/2 φ + 5.0 φ² | without lubrication | with lubrication | (η-1)/φ without | with |",
        "|---|---|---|---|---|---|---|",
    ]
    for phi in FRACTIONS:
        both = [found[phi, lub] for lub in (False, True)]
        cells = [f"{phi:.3f}", f"{1 + 2.5 * phi:.4f}", f"{1 + 2.5 * phi + SECOND * phi**2:.4f}"]
        cells += [f"{value:.4f} ± {error:.4f}" for value, error in both]
        cells += [f"{(value - 1) / phi:.3f}" for value, _ in both]
        lines.append("| " + " | ".join(cells) + " |")
    lines += ["", "Fitted with φ, φ² and φ³:", "", "| | coefficient of φ | coefficient of φ² |", "|---|---|---|"]
    for lub, name in ((False, "without lubrication"), (True, "with lubrication")):
        (first, de), (second, ds), _ = coefficients(found, lub)
        lines.append(f"| {name} | {first:.3f} ± {de:.3f} | {second:.2f} ± {ds:.2f} |")
    lines += [f"| theory | {EXPECTED} | {SECOND:.1f} |"]
    PAGE.write_text("\n".join(lines) + "\n")


def main():
    found = compute(FRACTIONS)
    write_table(found)
    for lub, name in ((False, "without"), (True, "with")):
        (first, de), (second, ds), _ = coefficients(found, lub)
        print(f"{name:8s} lubrication: 1 + ({first:.3f} +- {de:.3f}) phi + ({second:.2f} +- {ds:.2f}) phi^2")
        if abs(first - EXPECTED) > max(3 * de, 0.02):
            raise SystemExit(f"failed: the coefficient of phi should be {EXPECTED}")
    print(f"table      {PAGE}")


if __name__ == "__main__":
    main()
