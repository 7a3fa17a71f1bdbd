"""Fig. 12: self-diffusion along the gradient against the ratio of radii."""

import shear
from bidisperse import both_species, lines, x_axis
from report import main, shown


def quantity(species="sphere", radius=1.0):
    return shear.diffusivity("y", species, radius)


def draw(mode):
    """The same trend as of fluctuations."""
    report, found = both_species("fig12", mode, "Fig. 12: self-diffusion of two sizes in shear", quantity, "ratio")
    alone = lines(report, mode, quantity)
    label, scale = x_axis("ratio")
    report.label(label, r"$D_{22} / \dot\gamma a_i^2$", **scale)
    small, large = found["small"][2.5], found["large"][2.5]
    one = alone[0.10]
    report.state("D22 of small at λ = 2.5", f"above one size at 10%, {shown(one)} (paper)", shown(small), small[0] > one[0])
    report.state("D22 of large at λ = 2.5", f"below one size at 10%, {shown(one)} (paper)", shown(large), large[0] < one[0])
    return report


if __name__ == "__main__":
    main(draw)
