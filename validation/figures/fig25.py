"""Fig. 25: stability of suspensions of heavy and buoyant equal spheres. The experimental points are not available as numbers and are
omitted; the limit in them and in the paper is about 15% in total."""

import settling
from report import Report, main, shown
from runs import make, over_seeds

# Danckwerts' intensity of segregation beyond which species count as separating.
SEPARATING = 0.2
# Interval between drawn rows of a time series.
THIN = 10
# Total concentration at the limit.
LIMIT = 0.15
# Strength of the barrier in a test of its effect, relative to the other runs.
STRONGER = 4.0


def draw(mode):
    """Mixtures that separate into streams."""
    cases = {pair: settling.segregation(*pair, mode) for pair in settling.PAIRS[mode]}
    barriers = [settling.segregation(0.10, 0.10, "quick", stronger) for stronger in (1.0, STRONGER)]
    make(sum([*cases.values(), *barriers], []))
    report = Report("fig25", mode, "Fig. 25: segregation of heavy and buoyant spheres", panels=2)
    axes = report.panels[0]
    for (first, second), runs in cases.items():
        intensity = over_seeds(runs, at_the_end)
        separates = intensity[0] > SEPARATING
        report.curve(f"{first:.0%} + {second:.0%}", *(column[::THIN] for column in runs[0].series("segregation")), 1)
        for pair in {(first, second), (second, first)}:
            axes.plot(*pair, "o", color="k" if separates else "0.7", markersize=10)
        expected = "separates" if first + second > LIMIT else "stays mixed"
        time = settling.segregation_time(first, second)
        quantity = f"intensity at {first:.0%} + {second:.0%} after {time:g} Stokes times"
        report.state(quantity, f"{expected} (paper)", shown(intensity), separates == (first + second > LIMIT))
    report.state("largest mean velocity of separated mixtures, in Stokes velocities", "increases suddenly (paper)", *speeds(cases))
    usual, stronger = (over_seeds(runs, at_the_end) for runs in barriers)
    quantity = f"intensity at 10% + 10% in a box of side 20, barrier {STRONGER:g} times as strong"
    report.compare(quantity, "usual barrier", usual[0], stronger)
    axes.plot([0, LIMIT], [LIMIT, 0], "--", color="0.5", label="15% in total")
    report.label(r"$\phi_1$", r"$\phi_2$", xlim=(0, 0.2), ylim=(0, 0.2))
    report.label("Stokes times", "intensity of segregation", 1)
    return report


def speeds(cases):
    """The largest mean velocity and overlap of each mixture that has separated; whether all are faster than a sphere alone."""
    separated = {pair: run for pair, (run, *_) in cases.items() if at_the_end(run)[0] > SEPARATING}
    fastest = {pair: max(map(abs, run.series("mean_velocity_z[first]")[1])) for pair, run in separated.items()}
    overlaps = {pair: max(0.0, -min(run.series("smallest_gap")[1])) for pair, run in separated.items()}
    told = ", ".join(f"{a:.0%} + {b:.0%}: {fastest[a, b]:.0f} (overlap {overlaps[a, b]:.2f} a)" for a, b in separated)
    return told or "none", bool(separated) and min(fastest.values()) > 1


def at_the_end(run):
    """The intensity of segregation in the last tenth of a run: its mean and standard deviation."""
    _, values = run.series("segregation")
    last = values[-(len(values) // 10) :]
    mean = sum(last) / len(last)
    return mean, (sum((value - mean) ** 2 for value in last) / len(last)) ** 0.5


if __name__ == "__main__":
    main(draw)
