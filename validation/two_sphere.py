"""The exact two-sphere resistance functions against independent values, their limits far away and near contact, and reciprocity."""

import csv

import numpy as np
from support.page import table, write_section
from support.program import ROOT
from support.two_sphere import functions

RATIOS = (1.0, 2.0, 2.5, 4.0, 10.0)
# Allowed differences: from the reference, from limits (whose errors are of the next order in the gap or in 1/r), in reciprocity.
LIMITS = {"reference": 1e-7, "contact": 1e-3, "far away": 1e-3, "reciprocity": 1e-8}


def against_reference(ratio):
    """The largest relative difference from the table of a ratio, if there is one."""
    path = ROOT / "validation" / "data" / f"two-sphere-ratio{ratio:g}.csv"
    if not path.exists():
        return None
    with open(path) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    worst = 0.0
    for row in rows:
        found = functions(ratio, float(row.pop("gap")))
        # Relative to the function's size, or to a thousandth of a sphere's own where it passes through zero.
        worst = max(worst, *(abs(found[name] - float(value)) / max(abs(float(value)), 1e-3) for name, value in row.items()))
    return worst


def at_contact(ratio):
    """The part of XA11 that grows like one over the gap, g1/xi with xi = 2 gap/(a1 + a2), of Jeffrey & Onishi (1984), and that of
    YA11 like a logarithm, from two gaps each."""
    near, nearer = (functions(ratio, gap) for gap in (2e-6, 1e-6))
    first, second = (2 * gap / (1 + ratio) for gap in (2e-6, 1e-6))
    squeeze = (nearer["XA11"] - near["XA11"]) / (1 / second - 1 / first)
    shear = (nearer["YA11"] - near["YA11"]) / np.log(first / second)
    exact = 2 * ratio**2 / (1 + ratio) ** 3, 4 * ratio * (2 + ratio + 2 * ratio**2) / (15 * (1 + ratio) ** 3)
    return max(abs(squeeze / exact[0] - 1), abs(shear / exact[1] - 1))


def far_away(ratio):
    """The leading terms in one over the distance: XA11 - 1, XA12 and YA12."""
    gap = 4000.0
    distance, found = 1 + ratio + gap, functions(ratio, gap)
    own = found["XA11"] - 1, 9 * ratio / (4 * distance**2)
    first = found["XA12"], -3 * ratio / (1 + ratio) / distance
    second = found["YA12"], -3 * ratio / (2 * (1 + ratio)) / distance
    return max(abs(value / limit - 1) for value, limit in (own, first, second))


def reciprocity(ratio):
    """Loads of 1 by motions of 2 against the reverse, and exchange of the spheres."""
    worst = 0.0
    for gap in (1e-6, 1e-3, 0.1, 1.0, 30.0):
        found, turned = functions(ratio, gap), functions(1 / ratio, gap / ratio)
        for name in ("XA", "YA", "XC", "YC", "XM", "YM", "ZM"):
            worst = max(worst, abs(found[f"{name}12"] - found[f"{name}21"]) / abs(found[f"{name}12"]))
        for name in ("XA", "YA", "XC", "YC", "XM", "YM", "ZM"):
            worst = max(worst, abs(found[f"{name}11"] / turned[f"{name}22"] - 1))
    return worst


def main():
    rows, failed = [], []
    for ratio in RATIOS:
        checks = {"reference": against_reference(ratio), "contact": at_contact(ratio)}
        checks |= {"far away": far_away(ratio), "reciprocity": reciprocity(ratio)}
        rows.append([f"{ratio:g}", *("" if value is None else f"{value:.1e}" for value in checks.values())])
        failed += [f"{name}, ratio {ratio:g}: {value:.1e}" for name, value in checks.items() if value is not None and value > LIMITS[name]]
    header = ["a₂/a₁", "multipole collocation", "singular terms at contact", "leading terms far away", "reciprocity"]
    lines = ["Largest relative differences.", "", *table(header, rows)]
    write_section("lubrication.md", "two-sphere", "Two-sphere functions", lines)
    print("\n".join(lines))
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
