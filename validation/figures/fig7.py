"""Fig. 7: probability density of velocity fluctuations along the flow."""

import numpy as np

import shear
from report import Report, main
from runs import make

MARKS = {0.01: "^", 0.05: "o", 0.10: "s", 0.20: "*"}


def draw(mode):
    """Tails from exponential to Gaussian as the concentration grows."""
    cases = {fraction: shear.monodisperse(fraction, mode) for fraction in MARKS}
    make(sum(cases.values(), []))
    report = Report("fig7", mode, "Fig. 7: density of velocity fluctuations in shear", panels=2)
    x = np.linspace(-6, 6, 121)
    for panel, fractions in enumerate((MARKS, (0.05,))):
        for fraction in fractions:
            places, density = cases[fraction][0].columns("velocity_density", "deviations", "density", axis="x")
            mark = {"marker": MARKS[fraction], "linestyle": "none", "markersize": 3}
            report.curve(f"$\\phi$ = {fraction:.0%}", places, density, panel, **mark)
        report.curve("Gaussian", x, np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi), panel, color="0.4", linestyle="--")
    report.curve(r"$2/\sqrt{2\pi}\, e^{-1.5|v/s|}$", x, 2 / np.sqrt(2 * np.pi) * np.exp(-1.5 * abs(x)), 1, color="k")
    for panel in (0, 1):
        report.label("$v_1/s$", "density", panel, yscale="log", ylim=(1e-4, 2), xlim=(-6, 6))
    exponents = {f: runs[0].summary()["T_x_tail_exponent", "sphere"][0] for f, runs in cases.items()}
    listed = ", ".join(f"{n:.2f} at {fraction:.0%}" for fraction, n in exponents.items())
    report.state("exponent n of exp(-|x/l|^n)", "increases towards 2 (paper)", listed, exponents[0.01] < exponents[0.20] <= 2.2)
    report.state("n at 5%", "1 in the tails (paper)", f"{exponents[0.05]:.2f} for the whole density", exponents[0.05] < 1.5)
    return report


if __name__ == "__main__":
    main(draw)
