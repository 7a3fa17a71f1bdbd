"""Fig. 11: velocity fluctuations along the gradient against the ratio of radii."""

import shear
from bidisperse import both_species, lines, x_axis
from report import main, root, shown


def quantity(species="sphere", radius=1.0):
    return shear.tensor("yy", species, radius)


def draw(mode):
    """Small spheres fluctuate more among large ones."""
    report, found = both_species("fig11", mode, "Fig. 11: fluctuations of two sizes in shear", quantity, "ratio")
    alone = lines(report, mode, quantity)
    label, scale = x_axis("ratio")
    report.label(label, r"$T_{22} / (\dot\gamma a_i)^2$", **scale)
    small, large = found["small"], found["large"]
    growth = ratio(small[2.5], alone[0.10])
    report.compare("T22 of small over one size at 10%, λ = 2.5", "almost 2 (paper)", 2.0, growth, 0.2)
    report.compare("its square root", "almost 2 (paper)", 2.0, root(growth), 0.2)
    report.state("T22 of large at λ = 2.5", f"below one size at 5%, {alone[0.05][0]:.3g} (paper)", shown(large[2.5]),
                 large[2.5][0] - 2 * large[2.5][1] < alone[0.05][0])
    return report


def ratio(above, below):
    """A quotient with its error."""
    value = above[0] / below[0]
    return value, value * ((above[1] / above[0]) ** 2 + (below[1] / below[0]) ** 2) ** 0.5


if __name__ == "__main__":
    main(draw)
