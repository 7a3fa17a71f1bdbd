"""Figures of grains: disks, the averages of a shear cell, and profiles of its kinetic theory."""

from . import cell, continuum, disks, sweep

KINDS = ("granular-disks", "shear-cell", "shear-cell-continuum")


def draw(folder, scene, by):
    """The figure of a folder of grains."""
    if scene.kind == "shear-cell":
        return cell.draw(folder, scene)
    if scene.kind == "shear-cell-continuum":
        return continuum.draw(folder, scene)
    return disks.draw(folder, scene, by)
