"""The viscosity of dense suspensions of rough spheres, from families of runs: four seeds at two sizes of the box for each volume fraction and
friction, and for each stress of a shear-thickening paste. Errors are from the spread over the seeds.

    scripts/validate dense              the first points, of 40 and 45%
    scripts/validate dense --full       all points, up to 56%, with thickening: a night on four cores
    scripts/validate dense --part 1/8   the first of eight parts, for arrays of jobs; the page is written by the command without it
    scripts/validate dense --minutes 60   as many runs as fit in an hour; --page writes the page from existing runs

Runs are kept in results/dense, or in the folder FCM_SOLVE_RUNS; existing runs are continued and not repeated."""

import argparse
import csv
import os
import pathlib
import subprocess
import time
from dataclasses import dataclass

import numpy as np
from support.page import save, table, write_section
from support.program import PROGRAM, ROOT

RUNS = pathlib.Path(os.environ.get("FCM_SOLVE_RUNS", ROOT / "results")) / "dense"
SIZES = (200, 800)
SEEDS = 4
RATIO, STEP, ROUGHNESS, STRAIN = 1.4, 0.005, 0.005, 8.0
# Volume fractions and frictions, in the order of their cost; a short run computes the first ones.
POINTS = [(0.40, 0.0), (0.40, 0.5), (0.45, 0.0), (0.45, 0.5)]
FULL_POINTS = [*POINTS, (0.40, 1.0), (0.45, 1.0), (0.50, 0.0), (0.52, 0.0), (0.54, 0.0), (0.56, 0.0), (0.50, 0.3), (0.50, 0.5), (0.50, 1.0),
               (0.52, 0.5), (0.54, 0.3), (0.52, 1.0), (0.54, 0.5), (0.54, 1.0), (0.56, 0.5)]
# Relative viscosities by pair lubrication and contacts alone (LF_DEM), 100 spheres of radii 1 and 1.4, half the volume each, one run each.
PAIRS_ALONE = {
    (0.40, 0.0): 6.1, (0.40, 0.5): 8.8, (0.40, 1.0): 9.8, (0.45, 0.0): 9.1, (0.45, 0.3): 12.9, (0.45, 0.5): 16.1, (0.45, 1.0): 19.9,
    (0.50, 0.0): 14.1, (0.50, 0.5): 35.5, (0.50, 1.0): 72.0, (0.54, 0.0): 19.5,
}
# Shear thickening: volume fraction, friction and critical load.
THICKENING, FRICTION, CRITICAL_LOAD = 0.50, 1.0, 1.0
# Stresses over that of the critical load, with the viscosities of LF_DEM (to 25%).
STRESSES = {0.05: 14.3, 0.2: 14.2, 0.5: 13.3, 1.0: 18.1, 2.0: 25.0, 5.0: 45.0, 20.0: 58.0}
UNIT = CRITICAL_LOAD / (6 * np.pi)
# Strain from which means are taken.
SETTLED = 3.0
OVER_STRESS = ("second_normal_stress_difference", "particle_pressure")
QUANTITIES = ("relative_viscosity", *OVER_STRESS, "contacts_per_particle")
# Largest relative error of a value that is given.
LARGEST_ERROR = 0.1


def fit(fraction, friction):
    """Fit of Lobry et al., J. Fluid Mech. 860, 682 (2019), without its prefactor of 0.7 to 1."""
    decay = (np.exp(-2.5 * np.arctan(friction)) - np.exp(-1.25 * np.pi)) / (1 - np.exp(-1.25 * np.pi))
    return (1 - fraction / (0.546 + 0.094 * decay)) ** -2


def experiments(fraction):
    """The fit of Boyer, Guazzelli & Pouliquen, Phys. Rev. Lett. 107, 188301 (2011), to monodisperse frictional suspensions."""
    apart = (fraction / (0.585 - fraction)) ** 2
    return 1 + 2.5 * fraction / (1 - fraction / 0.585) + (0.32 + 0.38 / (1 + 0.005 * apart)) * apart


def counts(spheres):
    """Number of spheres of each radius, such that each radius makes up half of the volume."""
    small = spheres / (1 + RATIO**-3)
    return {1.0: round(small), RATIO: round(small / RATIO**3)}


def edge(fraction, spheres):
    return (sum(4 / 3 * np.pi * radius**3 * count for radius, count in counts(spheres).items()) / fraction) ** (1 / 3)


def head(spheres):
    species = "".join(f'[[species]]\nname = "{a:g}"\nradius = {a}\ncount = {n}\n' for a, n in counts(spheres).items())
    return f"""seed = 1
fluid.viscosity = 1.0
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
output = {{ trajectory_every = 0, observables_every = 1 }}
ensemble.seeds = {SEEDS}
{species}"""


def by_friction(spheres, points):
    """A family over volume fractions and frictions."""
    swept = "".join(f'[[sweep]]\n"box.edges" = [{e}, {e}, {e}]\n"contacts.friction" = {friction}\n'
                    for e, friction in ((round(edge(fraction, spheres), 6), friction) for fraction, friction in points))
    return f"""flow = {{ kind = "shear", rate = 1.0 }}
box.edges = [30.0, 30.0, 30.0]
contacts = {{ friction = 0.0, roughness = {ROUGHNESS} }}
time = {{ step = {STEP}, strain = {STRAIN} }}
{head(spheres)}{swept}"""


def by_stress(spheres):
    """A family over stresses, each to the same strain, in steps of about 0.01 in strain where the viscosity is 15."""
    e = round(edge(THICKENING, spheres), 6)
    member = '[[sweep]]\n"flow.stress" = {}\n"time.step" = {}\n"time.duration" = {}\n'
    stresses = [over * UNIT for over in STRESSES]
    swept = "".join(member.format(stress, 0.15 / stress, 20 * 15 * STRAIN / stress) for stress in stresses)
    return f"""flow = {{ kind = "shear", control = "stress", stress = 1.0 }}
box.edges = [{e}, {e}, {e}]
contacts = {{ friction = {FRICTION}, roughness = {ROUGHNESS}, critical_load = {CRITICAL_LOAD} }}
time = {{ step = 1.0, strain = {STRAIN}, duration = 1.0 }}
{head(spheres)}{swept}"""


@dataclass
class Found:
    """A quantity at a point: its mean over the seeds, and the error from their spread."""

    mean: float
    error: float

    def words(self):
        """Text with two digits of the error."""
        if not np.isfinite(self.error):
            return "jammed"
        digits = max(0, 1 - int(np.floor(np.log10(self.error)))) if self.error > 0 else 2
        return f"{self.mean:.{digits}f} ± {self.error:.{digits}f}"


def found_of(values):
    """Mean over the seeds with its error, including the factor of Student's distribution, as for families."""
    free = len(values) - 1
    series = 1 + 0.5 / free + 0.25 / free**2 + 0.0625 / free**3
    student = np.pi / 2 * 0.6826895 if free == 1 else series
    return Found(np.mean(values), student * np.std(values, ddof=1) / np.sqrt(len(values)))


def means(folder):
    """Means of a run from the strain at which it is steady, which a run that jams does not reach; stresses are relative to the shear
    stress. At a given rate of 1, strain and time are the same."""
    with open(folder / "observables.csv") as file:
        rows = [row for row in csv.DictReader(file) if float(row.get("strain", row["time"])) >= SETTLED]
    if not rows:
        return dict.fromkeys(QUANTITIES, np.nan)
    mean = {name: np.mean([float(row[name]) for row in rows]) for name in QUANTITIES}
    stress = mean["relative_viscosity"]
    if "shear_stress" in rows[0]:
        stress = np.mean([float(row["shear_stress"]) for row in rows])
        # Under a given stress the mean viscosity is the stress over the mean rate.
        strain, duration = (float(rows[-1][name]) - float(rows[0][name]) for name in ("strain", "time"))
        mean["relative_viscosity"] = stress * duration / strain
    return {name: value / stress if name in OVER_STRESS else value for name, value in mean.items()}


def table_of(name, count):
    """Quantities of each of `count` points of a family whose runs have all ended."""
    found = {}
    for point in range(count):
        folders = [done.parent for done in sorted((RUNS / name).glob(f"point-{point + 1:04}/seed-*/summary.csv"))]
        if len(folders) == SEEDS:
            runs = [means(folder) for folder in folders]
            found[point] = {quantity: found_of([run[quantity] for run in runs]) for quantity in QUANTITIES}
    return found


def run(name, text, options, end):
    """Runs the missing members of a family until a time; returns whether all are finished."""
    RUNS.mkdir(parents=True, exist_ok=True)
    scene = RUNS / f"{name}.toml"
    scene.write_text(text)
    left = end - time.monotonic()
    if left <= 0:
        return False
    options = [*options, "--walltime", f"0:{left:.0f}" if left < np.inf else "unlimited"]
    ended = subprocess.run([PROGRAM, "run", scene, "--out", RUNS / name, "--continue", *options])
    return ended.returncode == 0


def judged(sizes):
    """The viscosity of a suspension: the mean of both boxes, whose error includes half of their difference; or the reason for none."""
    found = [values["relative_viscosity"] for values in sizes if values]
    if len(found) < len(SIZES):
        return None, "one box only"
    small, large = found
    if not np.isfinite(small.error + large.error):
        return None, "jammed"
    mean = (small.mean + large.mean) / 2
    error = np.sqrt((small.error**2 + large.error**2) / 4 + ((small.mean - large.mean) / 2) ** 2)
    if error > LARGEST_ERROR * mean:
        return None, f"±{error / mean:.0%}"
    return Found(mean, error), ""


def cell(values, quantity):
    return values[quantity].words() if values else ""


def friction_rows(points, tables):
    rows = []
    for place, case in enumerate(points):
        sizes = [tables[spheres].get(place) for spheres in SIZES]
        if not any(sizes):
            continue
        number, why = judged(sizes)
        best = sizes[-1] or sizes[0]
        alone = PAIRS_ALONE.get(case)
        measured = f"{experiments(case[0]):.1f}" if case[1] == 0.5 and case[0] < 0.58 else ""
        rows.append([
            f"{case[0]:.0%}", f"{case[1]:g}", number.words() if number else f"none: {why}",
            *(cell(values, "relative_viscosity") for values in sizes), f"{alone:g}" if alone else "",
            f"{fit(*case):.1f}", measured, cell(best, "second_normal_stress_difference"),
            cell(best, "particle_pressure"),
            cell(best, "contacts_per_particle")])
    return rows


def write_friction(points):
    tables = {spheres: table_of(f"friction-{spheres}", len(points)) for spheres in SIZES}
    rows = friction_rows(points, tables)
    sizes = " and ".join(map(str, SIZES))
    header = ["φ", "μ", "relative viscosity", *(f"{spheres} spheres" for spheres in SIZES), "LF_DEM", "fit", "experiments", "N₂ / stress",
              "pressure / stress", "contacts"]
    lines = [
        f"Families of {SEEDS} seeds of {sizes} spheres of radii 1 and {RATIO}, with half the volume each, roughness {ROUGHNESS}, tolerance",
        f"1e-2, steps of {STEP} in strain, averaged over strains from {SETTLED:g} to {STRAIN:g}. Errors are from the spread over the seeds. The",
        "relative viscosity is the mean of both boxes; its error includes half of their difference, and no value is given if it",
        f"exceeds {LARGEST_ERROR:.0%}. Stresses are relative to the shear stress, contacts are per sphere, both in the larger box. For",
        "comparison: pair lubrication and contacts without a far field (LF_DEM, 100 spheres, one run);",
        "\\\\((1 - \\phi/\\phi_m(\\mu))^{-2}\\\\) of Lobry et al. (2019), with a prefactor of 0.7 to 1; and the fit of Boyer et al.",
        "(2011) to experiments with monodisperse spheres, in the rows with friction 0.5.",
        "",
        *table(header, rows),
        "",
        *differences(points, tables),
        "Near jamming single runs are not enough: at 54% and friction 1 single runs of 100 and 200 spheres gave means of about",
        "120 and 270 under nearly the same conditions, each with a reported error below 10%. The result depends on the start,",
        "the box and the length of the run. Above 50% a value is therefore given only if families of both sizes agree.",
    ]
    write_section("dense.md", "dense", "Viscosity by volume fraction and friction", lines, "scripts/validate dense")
    return rows


def differences(points, tables):
    """Sentences that compare with other programs, the fit and experiments."""
    alone, fitted, measured = [], [], []
    for place, case in enumerate(points):
        number, _ = judged([tables[spheres].get(place) for spheres in SIZES])
        if not number:
            continue
        name = f"{case[0]:.0%} and friction {case[1]:g}"
        if case in PAIRS_ALONE:
            alone.append(f"{100 * (PAIRS_ALONE[case] / number.mean - 1):+.0f}% at {name}")
        fitted.append(f"{number.mean / fit(*case):.2f} at {name}")
        if case[1] == 0.5:
            measured.append(f"{100 * (experiments(case[0]) / number.mean - 1):+.0f}% at {name}")
    lines = []
    if alone:
        differences = f"The viscosities of LF_DEM, without a far field, differ from these by {', '.join(alone)};"
        lines.append(f"{differences} they are from one run each, with unknown errors.")
    if fitted:
        lines.append(f"The prefactor of the fit that gives these values is {', '.join(fitted)}; the published range is 0.7 to 1.")
    if measured:
        lines.append(f"The fit to experiments, with monodisperse spheres of unknown friction, differs by {', '.join(measured)}.")
    return [*lines, ""] if lines else []


def write_thickening():
    tables = {spheres: table_of(f"stress-{spheres}", len(STRESSES)) for spheres in SIZES}
    rows = []
    for place, over in enumerate(STRESSES):
        sizes = [tables[spheres].get(place) for spheres in SIZES]
        if any(sizes):
            number, why = judged(sizes)
            rows.append([f"{over:g}", number.words() if number else f"none: {why}", *(cell(values, "relative_viscosity") for values in sizes),
                         f"{STRESSES[over]:g}"])
    lines = [
        f"The same at {THICKENING:.0%} with friction {FRICTION:g} in contacts above the critical load \\\\(F_c\\\\);",
        "stresses in units of \\\\(F_c / (6 \\pi a^2)\\\\).",
        "",
        *table(["stress", "relative viscosity", *(f"{spheres} spheres" for spheres in SIZES), "LF_DEM"], rows),
    ]
    if not rows:
        lines = ["No results yet: `scripts/validate dense --full` runs the families over the stress."]
    write_section("dense.md", "thickening", "Shear thickening", lines, "scripts/validate dense --full")
    if len(rows) > 1:
        draw(tables)


def draw(tables):
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    for spheres in SIZES:
        points = [(list(STRESSES)[place], values["relative_viscosity"]) for place, values in tables[spheres].items()]
        if points:
            x, found = zip(*points)
            axes.errorbar(x, [one.mean for one in found], [one.error for one in found], fmt="o-", capsize=2, label=f"{spheres} spheres")
    axes.set(xscale="log", yscale="log", xlabel="stress / (critical load / 6 pi a^2)", ylabel="relative viscosity")
    axes.legend()
    save(figure, "thickening.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--page", action="store_true")
    parser.add_argument("--part")
    parser.add_argument("--minutes", type=float, default=np.inf)
    args = parser.parse_args()
    options, end = ["--part", args.part] if args.part else [], time.monotonic() + 60 * args.minutes
    points = FULL_POINTS if args.full else POINTS
    # Point by point, so that both sizes of the first points exist when the time is up.
    families = [(f"friction-{spheres}", by_friction(spheres, points[:count])) for count in range(1, len(points) + 1) for spheres in SIZES]
    if args.full:
        families += [(f"stress-{spheres}", by_stress(spheres)) for spheres in SIZES]
    whole = args.page or all(run(name, text, options, end) for name, text in families)
    if not args.part:
        write_friction(FULL_POINTS)
        write_thickening()
    if not whole:
        raise SystemExit("not all runs are finished: the same command continues them")


if __name__ == "__main__":
    main()
