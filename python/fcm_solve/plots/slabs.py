"""Averages over slabs of the box between parallel planes."""

import numpy as np


def volume_fractions(heights, radii, edges, area):
    """Volume fraction of spheres in each slab, (slabs,).

    heights, radii  heights of the centres and radii of the spheres, (N,)
    edges           heights of the planes between slabs, ascending, (slabs + 1,)
    area            area of a slab
    """
    # The fraction of a sphere below a plane at t radii above its centre is (2 + 3 t - t^3) / 4.
    above = np.clip((edges[None, :] - heights[:, None]) / radii[:, None], -1, 1)
    below = 4 / 3 * np.pi * radii[:, None] ** 3 * (2 + 3 * above - above**3) / 4
    return np.diff(below.sum(axis=0)) / (area * np.diff(edges))


def slab_means(heights, values, edges):
    """Mean in each slab of the values whose heights are between its edges; NaN in empty slabs."""
    number, _ = np.histogram(heights, edges)
    total, _ = np.histogram(heights, edges, weights=values)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)
