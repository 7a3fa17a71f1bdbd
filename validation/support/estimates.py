"""Means of correlated samples with their errors, and their extrapolation to a time step of zero."""

import numpy as np


def mean_and_error(samples, count=12):
    """Mean of each column, with its error from `count` blocks."""
    blocks = np.array([block.mean(axis=0) for block in np.array_split(samples, count)])
    return samples.mean(axis=0), blocks.std(axis=0, ddof=1) / np.sqrt(len(blocks))


def without_step(points):
    """Linear extrapolation to step 0, with its error; each point is a step, a value and its error."""
    steps, values, errors = np.array(points).T
    weights = errors**-2
    design = np.stack([np.ones_like(steps), steps], axis=1)
    covariance = np.linalg.inv(design.T * weights @ design)
    return (covariance @ (design.T * weights @ values))[0], np.sqrt(covariance[0, 0])
