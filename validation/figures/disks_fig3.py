"""Fig. 3 of Santra et al.: hardly any order at low viscosity."""

from disks import SHOWN, draw as draw_disks, near, numbers, snapshots
from report import Report, main
from runs import make
import numpy as np


def draw(mode):
    """Snapshots at a viscosity of 0.001, at the start and at a strain of 195."""
    run = snapshots("fig3", viscosity=0.001)
    make([run])
    report = Report("disks-fig3", mode, "Fig. 3: disks at a viscosity of 0.001", panels=2)
    report.figure.set_size_inches(3 * len(report.panels), 3.4)
    for axes, strain in zip(report.panels, (0, SHOWN)):
        draw_disks(axes, run, strain)
    series = numbers(run.folder / "observables.csv")
    strain, delta = (np.array([row[key] for row in series]) for key in ("strain", "segregation"))
    first, last = near(strain, delta, 0), near(strain, delta, SHOWN)
    found = f"{first:.3f}, then {last:.3f}"
    reference = "no significant increase (paper); independent program: 0.225 ± 0.04 at 195"
    report.state("segregation at strains of 0 and 195, one seed", reference, found, abs(last - 0.225) <= 0.04)
    return report


if __name__ == "__main__":
    main(draw)
