"""Fig. 20: autocorrelation of the velocity of a test sphere among others at 20%."""

import settling
from report import Report, main
from runs import make


def draw(mode):
    """Times are in radii of the others over their Stokes velocity."""
    cases = {ratio: settling.test_sphere(ratio, mode)[0] for ratio in (1.2, 2.8)}
    make(cases.values())
    report = Report("fig20", mode, "Fig. 20: autocorrelation of a test sphere's velocity", panels=2)
    least = {}
    for panel, (ratio, run) in enumerate(cases.items()):
        for axis, label, style in (("z", "vertical", "-"), ("x", "horizontal", "--")):
            times, values = run.columns("lags", "time", f"correlation_{axis}", species="test")
            early = [(t, value / values[0]) for t, value in zip(times, values) if t <= 25]
            report.curve(f"{label}, $R_S$ = {ratio:g}", *zip(*early), panel, color="k", linestyle=style)
            least[ratio, axis] = min(value for _, value in early)
        report.label("$V_{oS} t / a$", "$R$", panel)
        report.panels[panel].axhline(0, color="0.7", linewidth=0.8)
    told = f"{least[2.8, 'x']:.2f}; {least[1.2, 'x']:.2f} at R_S = 1.2"
    report.state("least horizontal correlation at R_S = 2.8", "negative (paper)", told, least[2.8, "x"] < -0.05)
    return report


if __name__ == "__main__":
    main(draw)
