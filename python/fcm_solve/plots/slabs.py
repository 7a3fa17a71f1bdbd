"""Averages over the slabs of a box between planes."""

import numpy as np


def volume_fractions(heights, radii, edges, area):
    """The volume of spheres between each two of the edges, over that of the slab, (slabs,).

    heights, radii  of the spheres, (N,)
    edges           the planes between slabs, ascending, (slabs + 1,)
    area            of a slab
    """
    # The part of a sphere below a plane at t radii above its centre is (2 + 3 t - t^3) / 4 of it.
    above = np.clip((edges[None, :] - heights[:, None]) / radii[:, None], -1, 1)
    below = 4 / 3 * np.pi * radii[:, None] ** 3 * (2 + 3 * above - above**3) / 4
    return np.diff(below.sum(axis=0)) / (area * np.diff(edges))


def slab_means(heights, values, edges):
    """The mean of the values whose heights are between each two of the edges; not a number where there are none."""
    number, _ = np.histogram(heights, edges)
    total, _ = np.histogram(heights, edges, weights=values)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)
