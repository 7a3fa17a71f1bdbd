"""Fig. 13: velocity fluctuations along the gradient against the ratio of concentrations, radii 1 : 2."""

from bidisperse import both_species, lines, x_axis
from fig11 import quantity, ratio
from report import main


def draw(mode):
    """All fluctuate more with more large spheres."""
    report, found = both_species("fig13", mode, "Fig. 13: fluctuations of mixtures in shear", quantity, "mixture")
    lines(report, mode, quantity)
    label, scale = x_axis("mixture")
    report.label(label, r"$T_{22} / (\dot\gamma a_i)^2$", **scale)
    for species, said in (("small", "almost 2 (paper)"), ("large", "above 1 (paper)")):
        values = list(found[species].values())
        value, error = ratio(values[-1], values[0])
        fine = abs(value - 2) < max(2 * error, 0.4) if species == "small" else value > 1
        report.state(f"T22 of {species} spheres, φ₂/φ₁ = 9 over 1/9", said, f"{value:.2f} ± {error:.1g}", fine)
    return report


if __name__ == "__main__":
    main(draw)
