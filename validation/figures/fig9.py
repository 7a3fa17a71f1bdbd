"""Fig. 9: mean square displacement along the gradient."""

import math

import numpy as np

import shear
from report import Report, main
from runs import make


def draw(mode):
    """From quadratic to linear growth. Encounters cause an offset c, c + 2 D t, because of which the exponent is less than 1
    until t is many times c / (2 D)."""
    report = Report("fig9", mode, "Fig. 9: mean square displacement in shear")
    cases = {kind: shear.by_fraction(mode, kind == "lubricated") for kind in ("barrier", "lubricated")}
    make([runs[0] for one in cases.values() for runs in one.values()])
    for (kind, runs), line, suffix in zip(cases.items(), ("-", "--"), ("", ", lubrication")):
        found = {}
        for place, (fraction, (run, *_)) in enumerate(runs.items()):
            times, squares = (np.array(column) for column in run.columns("lags", "time", "displacement_y", species="sphere"))
            order = np.argsort(times)
            found[fraction] = times[order][1:], squares[order][1:]
            report.curve(f"$\\phi$ = {fraction:.0%}{suffix}", *found[fraction], color=f"C{place}", linestyle=line)
        judge(report, suffix, {fraction: growth(*both) for fraction, both in found.items()})
    report.label(r"$\dot\gamma t$", r"$\langle (x_2(t) - x_2(0))^2\rangle / a^2$", xscale="log", yscale="log")
    return report


def growth(times, squares):
    """Exponents at short times and after 8/rate, slope of the later half of the long times over that of the earlier, and the lag
    at which the offset is half of the whole."""
    early = math.log(squares[1] / squares[0]) / math.log(times[1] / times[0])
    long = (times >= shear.DIFFUSIVE) & (times <= times[-1] / 2)
    t, s = times[long], squares[long]
    late = math.log(s[-1] / s[0]) / math.log(t[-1] / t[0])
    middle = t <= (t[0] + t[-1]) / 2
    slopes = [np.polyfit(t[half], s[half], 1)[0] for half in (middle, ~middle)]
    slope, offset = np.polyfit(t, s, 1)
    return {"early": early, "late": late, "bend": slopes[1] / slopes[0], "lag": offset / slope}


def judge(report, suffix, found):
    """The paper's statements."""

    def listed(key, form):
        return ", ".join(f"{one[key]:{form}} at {fraction:.0%}" for fraction, one in found.items())

    dense = [one for fraction, one in found.items() if fraction >= 0.10]
    fine = all(abs(one["early"] - 2) < 0.1 for one in found.values())
    report.state(f"exponent at short times{suffix}", "2 (paper)", listed("early", ".2f"), fine)
    fine = all(abs(one["late"] - 1) < 0.3 for one in dense)
    report.state(f"exponent after 8/rate{suffix}", "1 (paper)", listed("late", ".2f"), fine)
    fine = all(0.7 < one["bend"] < 1.4 for one in dense)
    report.state(f"ratio of the slopes of the later and the earlier half{suffix}", "linear: 1 (paper)", listed("bend", ".2f"), fine)
    fine = all(one["lag"] < 1.5 * shear.DIFFUSIVE for one in dense)
    report.state(f"lag at which the offset is half of the total{suffix}", "8/rate (paper)", listed("lag", ".0f"), fine)


if __name__ == "__main__":
    main(draw)
