"""What the runs of the figures cost: seconds of a core that the quick ones took, and by the same rate for a sphere and a step what
the full ones would need."""

import json

import settling
import shear
from report import DATA, write_page
from runs import volume

COLUMNS = [
    "figures", "quick runs", "spheres", "minutes of a core", "µs for a sphere and a step", "full runs", "spheres", "core-hours",
]


def families(mode):
    """Runs that figures share, by the figures."""
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
    """How many a run has."""
    box = run.scene["box"]["edges"][0] ** 3
    counted = [one.get("count") or round(one["volume_fraction"] * box / volume(one["radius"])) for one in run.scene["species"]]
    return sum(counted)


def sphere_steps(run):
    """Spheres times steps of a run."""
    time = run.scene["time"]
    return spheres(run) * (time["steps"] if "steps" in time else round(time["duration"] / time["step"]))


def row(name, quick, full):
    """Of the table, by the seconds of those quick runs that have been made."""
    known = [run for run in quick if run.is_finished() and run.seconds() > 0]
    rate = sum(run.seconds() for run in known) / sum(map(sphere_steps, known)) if known else float("nan")
    minutes, hours = (rate * sum(map(sphere_steps, runs)) / unit for runs, unit in ((quick, 60), (full, 3600)))
    rates = [f"{minutes:.1f}", f"{1e6 * rate:.1f}"]
    return [name, str(len(quick)), size(quick), *rates, str(len(full)), size(full), f"{hours:.1f}"]


def size(runs):
    """From the fewest to the most spheres."""
    counts = [spheres(run) for run in runs]
    return str(counts[0]) if len(set(counts)) == 1 else f"{min(counts):,} to {max(counts):,}"


def main():
    """Writes the table."""
    quick, full = families("quick"), families("full")
    rows = [row(name, quick[name], full[name]) for name in quick]
    (DATA / "cost.json").write_text(json.dumps({"columns": COLUMNS, "rows": rows}, indent=1, ensure_ascii=False) + "\n")
    write_page("figures")
    for one in [COLUMNS, *rows]:
        print(" | ".join(one))


if __name__ == "__main__":
    main()
