"""Fig. 8: autocorrelation of the velocity along the gradient, and the diffusivity that is its integral."""

import shear
from report import Report, main
from runs import make

LINES = {0.01: "-", 0.05: "--", 0.10: ":", 0.20: "-."}


def first_zero(times, values):
    """Where a function first changes its sign."""
    for (s, a), (t, b) in zip(zip(times, values), zip(times[1:], values[1:])):
        if a > 0 >= b:
            return s + (t - s) * a / (a - b)
    return float("inf")


def draw(mode):
    """Correlations that change sign after about an encounter."""
    cases = {fraction: shear.monodisperse(fraction, mode)[0] for fraction in LINES}
    make(cases.values())
    report = Report("fig8", mode, "Fig. 8: autocorrelation of velocities in shear", panels=2)
    zeros = {}
    for fraction, run in cases.items():
        wanted = ("time", "correlation_y", "integral_y")
        times, correlation, integral = run.columns("lags", *wanted, species="sphere")
        normal = [value / correlation[0] for value in correlation]
        zeros[fraction] = first_zero(times, normal)
        style = {"linestyle": LINES[fraction], "color": "k"}
        report.curve(f"$\\phi$ = {fraction:.0%}", times, normal, 0, **style)
        report.curve(f"$\\phi$ = {fraction:.0%}", times, integral, 1, **style)
    report.label(r"$\dot\gamma t$", "$R_{22}$", 0, xlim=(0, 15))
    report.label(r"$\dot\gamma t$", r"$\int_0^t R\, dt\; T_{22} / \dot\gamma a^2$", 1, xlim=(0, 25))
    listed = ", ".join(f"{zero:.1f} at {fraction:.0%}" for fraction, zero in zeros.items())
    fine = all(0.5 < zero < 4 for zero in zeros.values())
    report.state("first zero of R22", "of the order of 1/rate (paper)", listed, fine)
    return report


if __name__ == "__main__":
    main(draw)
