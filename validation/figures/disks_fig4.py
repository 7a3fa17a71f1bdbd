"""Fig. 4 of Santra et al.: bands of large and small disks."""

from disks import draw as draw_disks, near, numbers, snapshots
from report import Report, main
from runs import make
import numpy as np

STRAINS = (0, 20, 70, 110, 220)


def draw(mode):
    """Snapshots at a viscosity of 0.01."""
    run = snapshots("fig4", strain=STRAINS[-1])
    make([run])
    report = Report("disks-fig4", mode, "Fig. 4: disks at a viscosity of 0.01", panels=len(STRAINS))
    report.figure.set_size_inches(2.1 * len(report.panels), 2.5)
    for axes, strain in zip(report.panels, STRAINS):
        draw_disks(axes, run, strain)
    series = numbers(run.folder / "observables.csv")
    strain, delta = (np.array([row[key] for row in series]) for key in ("strain", "segregation"))
    found = [near(strain, delta, at) for at in STRAINS]
    text = ", ".join(f"{value:.3f}" for value in found)
    report.state("segregation at these strains, one seed", "alternating bands form", text, found[-1] > 1.8 * found[0])
    return report


if __name__ == "__main__":
    main(draw)
