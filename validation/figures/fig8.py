"""Fig. 8: autocorrelation of the velocity along the gradient, and the diffusivity that is its integral."""

import shear
from report import Report, main
from runs import make

LINES = {0.01: "-", 0.05: "--", 0.10: ":", 0.20: "-."}
# Colours of the lines and suffixes of their labels.
KINDS = {False: ("k", ""), True: ("C3", ", lubrication")}


def first_zero(times, values):
    """Time at which a function first changes its sign."""
    for (s, a), (t, b) in zip(zip(times, values), zip(times[1:], values[1:])):
        if a > 0 >= b:
            return s + (t - s) * a / (a - b)
    return float("inf")


def draw(mode):
    """Correlations, which change sign after about the time of an encounter, with lubrication and without."""
    cases = {(kind, phi): shear.monodisperse(phi, mode, kind)[0] for kind in KINDS for phi in LINES}
    make(cases.values())
    report = Report("fig8", mode, "Fig. 8: autocorrelation of velocities in shear", panels=2)
    zeros = {}
    for (kind, fraction), run in cases.items():
        wanted = ("time", "correlation_y", "integral_y")
        times, correlation, integral = run.columns("lags", *wanted, species="sphere")
        normal = [value / correlation[0] for value in correlation]
        zeros[kind, fraction] = first_zero(times, normal)
        colour, suffix = KINDS[kind]
        style = {"linestyle": LINES[fraction], "color": colour}
        report.curve(f"$\\phi$ = {fraction:.0%}{suffix}", times, normal, 0, **style)
        report.curve(f"$\\phi$ = {fraction:.0%}{suffix}", times, integral, 1, **style)
    report.label(r"$\dot\gamma t$", "$R_{22}$", 0, xlim=(0, 15))
    report.label(r"$\dot\gamma t$", r"$\int_0^t R\, dt\; T_{22} / \dot\gamma a^2$", 1, xlim=(0, 25))
    for kind, (_, suffix) in KINDS.items():
        listed = ", ".join(f"{zeros[kind, fraction]:.1f} at {fraction:.0%}" for fraction in LINES)
        fine = all(0.5 < zeros[kind, fraction] < 4 for fraction in LINES)
        report.state(f"first zero of R22{suffix}", "of the order of 1/rate (paper)", listed, fine)
    return report


if __name__ == "__main__":
    main(draw)
