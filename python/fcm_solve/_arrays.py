"""Arguments as arrays: any array-like of numbers, in the shape that is asked for."""

import numpy as np

from ._core import is_finite


def rows(name, value, count, width=3):
    """`value` as a C-contiguous float64 array of shape (count, width)."""
    array = np.ascontiguousarray(value, dtype=np.float64)
    if array.shape != (count, width):
        raise ValueError(f"{name} has the shape {array.shape}; it needs to be ({count}, {width})")
    return finite(name, array)


def row_each(name, value, count):
    """`value` as a float64 array of shape (count,), from one number for all or one for each."""
    array = np.asarray(value, dtype=np.float64)
    if array.shape not in ((), (count,)):
        raise ValueError(f"{name} has the shape {array.shape}; it needs to be a number or ({count},)")
    return finite(name, np.ascontiguousarray(np.broadcast_to(array, (count,))))


def exactly(name, value, shape):
    """`value` as a float64 array of this shape."""
    array = np.asarray(value, dtype=np.float64, order="C")
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}; it needs to be {shape}")
    return finite(name, array)


def finite(name, array):
    """The array itself, C-contiguous, if all its numbers are finite."""
    if not is_finite(array):
        wrong = array[~np.isfinite(array)][0]
        raise ValueError(f"{name} contains {wrong}; every number needs to be finite")
    return array
