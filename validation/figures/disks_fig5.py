"""Fig. 5 of Santra et al.: lanes of equal disks."""

from disks import SHOWN, draw as draw_disks, numbers, snapshots
from report import Report, main
from runs import make


def draw(mode):
    """The final state of equal disks at a viscosity of 0.01, gray by the excess velocity."""
    run = snapshots("fig5", species=[{"radius": 1.0, "number_fraction": 1.0}])
    make([run])
    report = Report("disks-fig5", mode, "Fig. 5: equal disks at a viscosity of 0.01", panels=2)
    draw_disks(report.panels[0], run, SHOWN, by="excess")
    series = numbers(run.folder / "observables.csv")
    report.curve("height of the lanes' peak", [r["strain"] for r in series], [r["lane_peak"] for r in series], panel=1)
    report.label("strain", r"$|\sum_j e^{i k y_j}|^2 / N^2$", panel=1)
    peak, spacing = series[-1]["lane_peak"], series[-1]["lane_spacing"]
    report.state("height of the lanes' peak", "disjoint parallel lanes: 1", f"{peak:.3f}", peak >= 0.8)
    report.state("spacing of the lanes, radii", "about 2", f"{spacing:.2f}", 1.85 <= spacing <= 2.15)
    return report


if __name__ == "__main__":
    main(draw)
