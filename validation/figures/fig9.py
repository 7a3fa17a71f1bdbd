"""Fig. 9: mean square displacement along the gradient."""

import math

import shear
from report import Report, main
from runs import make


def draw(mode):
    """From quadratic to linear growth."""
    cases = {fraction: runs[0] for fraction, runs in shear.by_fraction(mode).items()}
    make(cases.values())
    report = Report("fig9", mode, "Fig. 9: mean square displacement in shear")
    slopes = {}
    for fraction, run in cases.items():
        times, squares = run.columns("lags", "time", "displacement_y", species="sphere")
        report.curve(f"$\\phi$ = {fraction:.0%}", times[1:], squares[1:])
        long = [(t, s) for t, s in zip(times, squares) if shear.DIFFUSIVE <= t <= times[-1] / 2]
        slopes[fraction] = [
            math.log(squares[2] / squares[1]) / math.log(times[2] / times[1]),
            math.log(long[-1][1] / long[0][1]) / math.log(long[-1][0] / long[0][0]),
        ]
    report.label(r"$\dot\gamma t$", r"$\langle (x_2(t) - x_2(0))^2\rangle / a^2$", xscale="log", yscale="log")
    short = ", ".join(f"{early:.2f} at {fraction:.0%}" for fraction, (early, _) in slopes.items())
    report.state("exponent at short times", "2 (paper)", short, all(abs(early - 2) < 0.1 for early, _ in slopes.values()))
    late = ", ".join(f"{late:.2f} at {fraction:.0%}" for fraction, (_, late) in slopes.items())
    fine = all(abs(slopes[fraction][1] - 1) < 0.3 for fraction in (0.10, 0.15, 0.20))
    report.state("exponent after 8/rate, from 10% on", "1 (paper)", late, fine)
    return report


if __name__ == "__main__":
    main(draw)
