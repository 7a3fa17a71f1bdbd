"""Nodes of a cluster, the network between them, and the time of an exchange among ranks.

All ranks of a node share its port and its memory bandwidth. In an exchange every rank sends the same number of bytes to each other rank
of its group; parts for ranks of other nodes go through the port, parts for ranks of the same node through memory. The fat tree above the
nodes has less bandwidth a node the more nodes take part: its bisection bandwidth grows as nodes^(1 - e) with an exponent e, 0 for a tree
whose links never thin out and whose routes never collide, 1/3 for a torus of three dimensions. The exponent is the only fitted number."""

import dataclasses
import functools
import math

import numpy as np

# Seconds that a rank takes to send and receive a message, whatever its size.
LATENCY = 1.5e-6


@dataclasses.dataclass(frozen=True)
class Node:
    """A node: cores, NUMA domains, and bytes per second through its port, each way, and of its memory."""

    name: str
    cores: int
    domains: int
    port: float
    memory: float


@dataclasses.dataclass(frozen=True)
class Layout:
    """Ranks in order on nodes."""

    ranks: int
    per_node: int

    @property
    def nodes(self):
        return math.ceil(self.ranks / self.per_node)


@dataclasses.dataclass(frozen=True)
class Group:
    """Ranks that exchange with each other: so many, so far apart in the order of all ranks."""

    size: int
    stride: int

    @functools.cache
    def shares(self, layout):
        """The share of a rank's bytes that leaves its node, on the node where that is most, and the share that stays on the node but
        leaves the rank, on average."""
        ranks = np.arange(layout.ranks)
        group = ranks // (self.size * self.stride) * self.stride + ranks % self.stride
        node = ranks // layout.per_node
        _, of_rank, members = np.unique(group * layout.nodes + node, return_inverse=True, return_counts=True)
        here = members[of_rank]
        away = np.bincount(node, 1 - here / self.size).max() / min(layout.per_node, layout.ranks)
        return away, np.mean(here - 1) / self.size


@dataclasses.dataclass(frozen=True)
class Network:
    """Nodes of one kind, and the exponent by which the bandwidth of a node falls with their number."""

    node: Node
    exponent: float

    def port_seconds(self, layout, sent):
        """Seconds in which each rank of a node sends so many bytes to other nodes."""
        return sent * min(layout.per_node, layout.ranks) * layout.nodes**self.exponent / self.node.port

    def memory_seconds(self, layout, moved):
        """Seconds in which each rank of a full node reads and writes so many bytes."""
        return moved * layout.per_node / self.node.memory

    def exchange_seconds(self, layout, group, values, copies):
        """Seconds of an exchange of so many bytes of each rank. On the node, each byte is read and written `copies` times; a message goes
        to each other rank of the group."""
        if group.size == 1:
            return 0.0
        away, here = group.shares(layout)
        return (self.port_seconds(layout, away * values) + self.memory_seconds(layout, 2 * copies * here * values)
                + (group.size - 1) * LATENCY)
