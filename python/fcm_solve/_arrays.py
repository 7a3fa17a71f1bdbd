"""Conversion of arguments to arrays: any array-like of real numbers, of a required shape."""

from collections.abc import Iterable

import numpy as np

from ._core import is_finite
from ._errors import InputError

_FOUND = {
    "b": "true and false",
    "c": "complex numbers",
    "m": "time spans",
    "M": "dates",
    "O": "objects",
    "S": "text",
    "T": "text",
    "U": "text",
    "V": "records",
}
# Larger whole numbers are rounded as float64.
_EXACT = 2**53
# The host's memory in DLPack.
_HOST = (1, 0)


def axes_of(orientations):
    """The third axes (N, 3) of orientations given as quaternions w, x, y, z (N, 4)."""
    w, x, y, z = np.moveaxis(orientations, -1, 0)
    return np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), w * w + z * z - x * x - y * y], axis=-1)


def rows(name, value, count, width=3):
    """`value` as a C-contiguous float64 array of shape (count, width)."""
    array = np.ascontiguousarray(numbers(name, value))
    if array.shape != (count, width):
        raise InputError(f"{name} has the shape {array.shape}; it needs to be ({count}, {width})")
    return finite(name, array)


def rows_or_none(name, value, count, width=3):
    """`rows` of a value that is given."""
    return None if value is None else rows(name, value, count, width)


def rows_or_nan(name, value, count):
    """`rows` of a value that is given, NaN where it has NaN, or where it is None."""
    array = np.full((count, 3), np.nan) if value is None else np.array(numbers(name, value), order="C")
    is_free = np.isnan(array)
    rows(name, np.where(is_free, 0.0, array), count)
    return array


def row_each(name, value, count):
    """A new float64 array of shape (count,), from one number for all or one for each."""
    array = numbers(name, value)
    if array.shape not in ((), (count,)):
        raise InputError(f"{name} has the shape {array.shape}; it needs to be a number or ({count},)")
    return finite(name, np.array(np.broadcast_to(array, (count,)), order="C"))


def exactly(name, value, shape):
    """`value` as a float64 array of this shape."""
    array = np.asarray(numbers(name, value), order="C")
    if array.shape != shape:
        raise InputError(f"{name} has the shape {array.shape}; it needs to be {shape}")
    return finite(name, array)


def finite(name, array):
    """The array itself, C-contiguous, if all its numbers are finite."""
    if not is_finite(array):
        wrong = array[~np.isfinite(array)][0]
        raise InputError(f"{name} contains {wrong}; every number needs to be finite")
    return array


def numbers(name, value):
    """`value` as a float64 array. Values that would lose information, such as a mask or a unit, are refused."""
    if type(value) is np.ndarray and value.dtype == np.float64:
        return value
    _refuse_more_than_numbers(name, value)
    value = _on_host(name, value)
    try:
        array = np.asarray(value)
    except ValueError as cause:
        raise InputError(f"{name} is not an array of numbers: {cause}") from cause
    if array.dtype.kind not in "fiu":
        raise InputError(f"{name} has {_FOUND.get(array.dtype.kind, array.dtype)}; it needs to have real numbers")
    if array.dtype.kind in "iu" and array.size > 0 and not -_EXACT <= array.min() <= array.max() <= _EXACT:
        raise InputError(f"{name} has whole numbers beyond 2^53, which would be rounded; make them float64 first")
    return np.asarray(array, dtype=np.float64)


class _HostCopy:
    """An array of another library that exports a copy in the host's memory."""

    def __init__(self, array):
        self._array = array

    def __dlpack__(self, **_):
        return self._array.__dlpack__(dl_device=_HOST)

    def __dlpack_device__(self):
        return _HOST


def _on_host(name, value):
    """An array that another library exports by DLPack as a numpy array: the same memory if it is the host's, otherwise
    a copy by that library. Other values, and arrays of the host that numpy converts by itself, are unchanged."""
    if not hasattr(value, "__dlpack_device__"):
        return value
    is_here = value.__dlpack_device__()[0] == _HOST[0]
    if is_here and hasattr(value, "__array__"):
        return value
    try:
        return np.from_dlpack(value if is_here else _HostCopy(value))
    except (BufferError, RuntimeError, TypeError, ValueError) as cause:
        place = "cannot be exported" if is_here else "is in the memory of a device, and its library does not copy it"
        raise InputError(f"{name} {place} ({cause}); make it an array of numpy first") from cause


def number(name, value):
    """`value` as a float, if it is one real number."""
    array = numbers(name, value)
    if array.ndim != 0:
        raise InputError(f"{name} has the shape {array.shape}; it needs to be a number")
    return float(finite(name, array))


def whole(name, value, least):
    """`value` as an int, if it is a whole number of at least `least`."""
    is_whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not (is_whole and least <= value < 2**63):
        raise InputError(f"{name} is {_shown(value)}; it needs to be a whole number of at least {least}")
    return int(value)


def flag(name, value):
    """`value` as a bool, if it is one."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(f"{name} is {_shown(value)}; it needs to be True or False")
    return bool(value)


def words(name, value, count):
    """`value` as a list of `count` words."""
    is_list = isinstance(value, Iterable) and not isinstance(value, str)
    items = list(value) if is_list else [value]
    if len(items) != count or not all(isinstance(item, str) for item in items):
        raise InputError(f"{name} is {_shown(value)}; it needs to be {'a word' if count == 1 else f'{count} words'}")
    return [str(item) for item in items]


def _refuse_more_than_numbers(name, value):
    """Refuses masks, units and booleans among numbers, which numpy would drop silently."""
    if isinstance(value, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array; fill its masked values first")
    if isinstance(value, (list, tuple)):
        for item in value:
            _refuse_more_than_numbers(name, item)
    elif isinstance(value, bool):
        raise InputError(f"{name} has {_FOUND['b']}; it needs to have real numbers")
    elif hasattr(value, "unit") or hasattr(value, "units"):
        raise InputError(f"{name} has a unit; give its numbers alone, in the units of the others")


def _shown(value):
    """A value as shown in a message, cut to one line."""
    shown = repr(value)
    return shown if len(shown) <= 80 else shown[:80] + "..."
