"""Fig. 13: velocity fluctuations along the gradient against the ratio of concentrations, radii 1 : 2."""

from bidisperse import both_species, lines, x_axis
from fig11 import quantity, ratio
from report import main, root, shown


def draw(mode):
    """All fluctuate more with more large spheres."""
    report, found = both_species("fig13", mode, "Fig. 13: fluctuations of mixtures in shear", quantity, "mixture")
    lines(report, mode, quantity)
    label, scale = x_axis("mixture")
    report.label(label, r"$T_{22} / (\dot\gamma a_i)^2$", **scale)
    for species, said in (("small", "almost 2 (paper)"), ("large", "above 1 (paper)")):
        values = list(found[species].values())
        growth = ratio(values[-1], values[0])
        name = f"T22 of {species} spheres, φ₂/φ₁ = 9 over 1/9"
        if species == "small":
            report.compare(name, said, 2.0, growth, 0.2)
            report.compare("its square root", said, 2.0, root(growth), 0.2)
        else:
            report.state(name, said, shown(growth), growth[0] > 1)
    return report


if __name__ == "__main__":
    main(draw)
