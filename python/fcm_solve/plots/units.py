"""Units on axes: named for scenes in SI units, omitted for other systems of units."""

import math
import textwrap

import numpy as np

# Units in terms of length, time and force, as in files of results: their SI names, and the power of the first unit, to
# which a prefix is raised.
NAMES = {
    "length": ("m", 1),
    "time": ("s", 1),
    "1/time": ("1/s", 0),
    "length/time": ("m/s", 1),
    "length^2": ("m\u00b2", 2),
    "length^2/time": ("m\u00b2/s", 2),
    "1/length^3": ("1/m\u00b3", 0),
    "force": ("N", 1),
    "force*length": ("J", 1),
    "force/length^2": ("Pa", 1),
    "force*time/length^2": ("Pa s", 1),
    "force/length^3": ("Pa/m", 1),
}
PREFIXES = {-12: "p", -9: "n", -6: "\u00b5", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# Largest number of letters of a label on one line.
LONGEST_LINE = 26


class Units:
    """Units of a scene."""

    def __init__(self, is_si):
        self.is_si = is_si

    def scale(self, dimension, *arrays):
        """The factor that converts values of a dimension, and the name of the resulting unit: `(1e6, "\u00b5m")`, or `(1, "")`."""
        if not self.is_si or dimension not in NAMES:
            return 1.0, ""
        name, power = NAMES[dimension]
        largest = _largest(arrays)
        if power == 0 or largest == 0:
            return 1.0, name
        exponent = 3 * math.floor(math.log10(largest) / power / 3)
        exponent = min(max(exponent, -12), 0 if name.startswith(("m", "s")) else 9)
        return 10.0 ** (-exponent * power), PREFIXES[exponent] + name

    def axis(self, dimension, *arrays):
        """Factor and unit of an axis, with a power of ten in the unit if numbers are large or small."""
        factor, unit = self.scale(dimension, *arrays)
        largest = factor * _largest(arrays)
        exponent = math.floor(math.log10(largest)) if largest > 0 else 0
        if -4 < exponent < 5:
            return factor, unit
        exponent = 3 * (exponent // 3)
        return factor / 10.0**exponent, f"10{_superscript(exponent)} {unit}".rstrip()


def _largest(arrays):
    return max((float(np.abs(a).max()) for a in map(_finite, arrays) if a.size), default=0.0)


def _finite(values):
    values = np.asarray(values, dtype=float)
    return values[np.isfinite(values)]


def labelled(label, unit):
    """The label of an axis with its unit, if the unit has a name."""
    return f"{label} ({unit})" if unit else label


def upright(label):
    """The label of a vertical axis, on two lines if it is long."""
    if len(label) <= LONGEST_LINE:
        return label
    first, slash, second = label.partition(" / ")
    return f"{first}\n/ {second}" if slash else "\n".join(textwrap.wrap(label, LONGEST_LINE)[:2])


def with_error(value, error):
    """A value with its error to two digits: `15.3 \u00b1 0.4`."""
    if not math.isfinite(value):
        return "\u2013"
    if not math.isfinite(error) or error <= 0:
        return f"{value:.4g}"
    exponent = math.floor(math.log10(max(abs(value), error)))
    shift = exponent if exponent < -3 or exponent > 5 else 0
    value, error = value / 10.0**shift, error / 10.0**shift
    decimals = max(0, 1 - math.floor(math.log10(error)))
    text = f"{value:.{decimals}f} \u00b1 {error:.{decimals}f}".replace("-", "\u2212")
    return f"({text})\u00b710{_superscript(shift)}" if shift else text


def _superscript(number):
    return str(number).translate(
        str.maketrans("-0123456789", "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079")
    )
