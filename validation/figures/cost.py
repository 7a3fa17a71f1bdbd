"""Cost of the runs of the figures: core time of the quick runs, and of the full runs, measured or estimated from the same
time per sphere and step."""

import json

import settling
import shear
from report import DATA, write_page
from runs import volume

COLUMNS = [
    "figures", "quick runs", "spheres", "core-minutes", "µs per sphere and step", "full runs", "spheres", "core-hours",
]


def families(mode):
    """Groups of runs by the figures that share them."""
    sized = [settling.two_sizes(ratio, phi) for ratio in (2.0, 3.0) for phi in settling.TOTALS[mode]]
    weighted = [settling.two_densities(ratio, phi) for ratio in (2.0, -1.0) for phi in settling.SECOND[mode]]
    equal = [settling.equal_spheres(phi) for phi in settling.MONODISPERSE]
    return {
        "5 to 10": joined(shear.by_fraction(mode).values()),
        "5, 8 to 10, lubrication": joined(shear.by_fraction(mode, lubrication=True).values()),
        "11, 12, 17": joined(shear.by_ratio(mode).values()),
        "13 to 16, 18": joined(runs for ratio in shear.MIXED[mode] for runs in shear.by_mixture(ratio, mode).values()),
        "1": joined(settling.dynamic(species, mode) for species in equal),
        "19, 20": joined(settling.test_sphere(ratio, mode) for ratio in settling.TEST_RATIOS[mode]),
        "22": joined(settling.dynamic(species, mode) for species in sized),
        "23": joined(settling.dynamic(settling.two_sizes(2.0, 0.06), mode, edge=edge) for edge in settling.WIDTHS[mode]),
        "24": joined(settling.dynamic(species, mode) for species in weighted),
        "25": joined(settling.segregation(*pair, mode) for pair in settling.PAIRS[mode]),
    }


def joined(lists):
    return [run for runs in lists for run in runs]


def spheres(run):
    """Number of spheres of a run."""
    box = run.scene["box"]["edges"][0] ** 3
    counted = [one.get("count") or round(one["volume_fraction"] * box / volume(one["radius"])) for one in run.scene["species"]]
    return sum(counted)


def sphere_steps(run):
    """Spheres times steps of a run."""
    time = run.scene["time"]
    return spheres(run) * (time["steps"] if "steps" in time else round(time["duration"] / time["step"]))


def volume_fraction(run):
    """Volume fraction of all spheres of a run."""
    box = run.scene["box"]["edges"][0] ** 3
    return sum(one.get("volume_fraction") or one["count"] * volume(one["radius"]) / box for one in run.scene["species"])


def estimate(run, known):
    """Core-seconds, estimated from the known run with the nearest volume fraction."""
    like = min(known, key=lambda one: abs(volume_fraction(one) - volume_fraction(run)))
    return like.seconds() * sphere_steps(run) / sphere_steps(like)


def taken(run, known):
    """Core-seconds of a run, estimated if it has not been made."""
    return run.seconds() if run.is_finished() and run.seconds() > 0 else estimate(run, known)


def row(name, quick, full):
    """A row of the table, based on the quick runs that have been made."""
    known = [run for run in quick if run.is_finished() and run.seconds() > 0]
    if not known:
        raise SystemExit(f"no quick run of figure {name} has been made: scripts/reproduce makes them")
    quick_seconds, full_seconds = (sum(taken(run, known) for run in runs) for runs in (quick, full))
    rate = f"{1e6 * quick_seconds / sum(map(sphere_steps, quick)):.1f}"
    counts = [str(len(quick)), size(quick), f"{quick_seconds / 60:.1f}", rate, str(len(full)), size(full)]
    return [name, *counts, f"{full_seconds / 3600:.1f}"]


def size(runs):
    """Range of the numbers of spheres."""
    counts = [spheres(run) for run in runs]
    return f"{counts[0]:,}" if len(set(counts)) == 1 else f"{min(counts):,} to {max(counts):,}"


def main():
    """Writes the table."""
    quick, full = families("quick"), families("full")
    rows = [row(name, quick[name], full[name]) for name in quick]
    quick_minutes, core_hours = (sum(float(one[column]) for one in rows) for column in (3, 7))
    rows.append(["all", "", "", f"{quick_minutes:.1f}", "", "", "", f"{core_hours:.1f}"])
    (DATA / "cost.json").write_text(json.dumps({"columns": COLUMNS, "rows": rows}, indent=1, ensure_ascii=False) + "\n")
    write_page("figures")
    for one in [COLUMNS, *rows]:
        print(" | ".join(one))


if __name__ == "__main__":
    main()
