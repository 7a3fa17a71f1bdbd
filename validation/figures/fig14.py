"""Fig. 14: self-diffusion along the vorticity against the ratio of concentrations, radii 1 : 2. The data of Chang & Powell in
the paper's figure are not available as numbers and are omitted."""

import shear
from bidisperse import both_species, lines, x_axis
from report import main, shown


def quantity(species="sphere", radius=1.0):
    return shear.diffusivity("z", species, radius)


def draw(mode):
    """All diffuse more with more large spheres."""
    report, found = both_species("fig14", mode, "Fig. 14: self-diffusion of mixtures in shear", quantity, "mixture")
    lines(report, mode, quantity)
    label, scale = x_axis("mixture")
    report.label(label, r"$D_{33} / \dot\gamma a_i^2$", **scale)
    for species in ("small", "large"):
        first, *_, last = found[species].values()
        told = f"{shown(first)} to {shown(last)}"
        report.state(f"D33 of {species} spheres from φ₂/φ₁ = 1/9 to 9", "increases (paper)", told, last[0] > first[0])
    return report


if __name__ == "__main__":
    main(draw)
