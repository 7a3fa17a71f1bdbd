"""Published times of pencil transforms, and those of the model."""

import csv
import dataclasses
import functools
import pathlib

import numpy as np

from scaling.network import Group, Layout, Network, Node

FILE = pathlib.Path(__file__).resolve().parents[1] / "data" / "pencil-transforms.csv"
CORES, PORT = 40, 12.5e9
# The model has to be within this factor of each published time, up to this number of ranks.
FACTOR, RANKS = 1.5, 8192
# Times that a value is read and written: by a transform along an axis, by packing and unpacking, and by MPI from one rank to another.
PASSES_OF_TRANSFORM, PASSES_OF_PACKING, COPIES = 1, 2, 2


@dataclasses.dataclass(frozen=True)
class Transform:
    """A forward and a backward transform, and their measured times in seconds."""

    program: str
    points: int
    ranks: int
    table: tuple
    total: float
    local: float
    exchange: float

    @property
    def values(self):
        """Bytes of a rank: those of half of the coefficients of a real field."""
        return 8 * self.points**3 / self.ranks


@functools.cache
def transforms():
    """The published transforms."""
    with open(FILE) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    found = []
    for row in rows:
        total, fft, pack, exchange = (1e-3 * float(row[name]) for name in ("total", "fft", "pack", "exchange"))
        table = tuple(sorted((int(row["rows"]), int(row["columns"]))))
        found.append(Transform(row["program"], int(row["points"]), int(row["ranks"]), table, total, fft + pack, exchange))
    return found


def passes():
    """Times that a value is read and written by the local work of a pair of transforms."""
    return 2 * (3 * PASSES_OF_TRANSFORM + 2 * PASSES_OF_PACKING)


def memory_bandwidth(found):
    """Bytes per second of a node's memory: the median of what the programs' timers of local work show."""
    return float(np.median([2 * passes() * t.values * CORES / t.local for t in found]))


def network(found, exponent):
    """The network of the published transforms."""
    return Network(Node("reference", CORES, 2, PORT, memory_bandwidth(found)), exponent)


def exchange_seconds(transform, network):
    """Seconds of the four exchanges by the model. Ranks of the smaller side of the table follow each other."""
    layout = Layout(transform.ranks, CORES)
    small, large = transform.table
    groups = Group(small, 1), Group(large, small)
    return sum(2 * network.exchange_seconds(layout, group, transform.values, COPIES) for group in groups)


def seconds(transform, network):
    """Seconds of a pair of transforms by the model."""
    return network.memory_seconds(Layout(transform.ranks, CORES), 2 * passes() * transform.values) + exchange_seconds(transform, network)


def ratios(found, exponent):
    """Seconds of the model over those measured."""
    of = network(tuple(transforms()), exponent)
    return np.array([seconds(transform, of) / transform.total for transform in found])


def fitted_exponent(found):
    """The exponent with the least squares of the logarithms of the ratios."""
    candidates = np.linspace(0.0, 0.5, 101)
    return float(min(candidates, key=lambda exponent: np.sum(np.log(ratios(found, exponent)) ** 2)))
