"""Fig. 2: relative velocity of two unequal settling spheres, as in `scripts/validate pair-settling`. It has no statistics:
quick and full are the same."""

import sys

from report import Report, main
from runs import ROOT

sys.path.insert(0, str(ROOT / "validation"))
import pair_settling


def draw(mode):
    """Comparison with the exact solution and with the method in unbounded fluid."""
    reference = pair_settling.read_reference()
    answers = pair_settling.compute(list(reference))
    report = Report("fig2", mode, "Fig. 2: two unequal spheres settling", panels=2)
    for panel, line in enumerate(pair_settling.LINES):
        for ratio in sorted({key[1] for key in reference}, reverse=True):
            keys = [key for key in reference if key[1:] == (ratio, line)]
            separations = [key[0] for key in keys]
            report.curve(f"exact, $\\gamma$ = {ratio}", separations, [reference[key]["exact"] for key in keys], panel)
            for multipoles, mark in zip(pair_settling.MULTIPOLES, "o*"):
                values = [answers[multipoles, *key] for key in keys]
                report.curve("", separations, values, panel, marker=mark, linestyle="none", color="0.3", fillstyle="none")
        report.label("$r/a_2$", f"relative velocity, line of centres {line}", panel)
    worst = pair_settling.differences(reference, answers)
    for multipoles, difference in worst.items():
        fine = difference < pair_settling.LIMIT
        report.state(f"{multipoles}, largest difference", "from the method in unbounded fluid: 0", f"{difference:.1e}", fine)
    far = [key for key in reference if key[0] >= 2.5]
    error = max(abs(answers["dipole", *key] - reference[key]["exact"]) for key in far)
    report.state("largest error of dipoles at r ≥ 2.5 a₂", "excellent agreement (paper)", f"{error:.1e}", error < 0.02)
    return report


if __name__ == "__main__":
    main(draw)
