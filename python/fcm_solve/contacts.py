"""Forces of individual contacts and bonds, by step."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._hdf5 import opened

STATES = ("frictionless", "sticking", "sliding", "bond")
"""Kinds of contacts, in the order of their numbers in `state`."""


@dataclass(frozen=True)
class Contacts:
    """The C contacts and bonds at one time, ordered by their pairs of ids."""

    step: int
    """Steps taken."""
    time: float
    """The time."""
    lattice: np.ndarray
    """(3, 3), the vectors of the box as rows; length"""
    pairs: np.ndarray
    """(C, 2), ids of both spheres, the lower first"""
    positions: np.ndarray
    """(C, 3), centre of the first sphere; length"""
    separations: np.ndarray
    """(C, 3), from the centre of the first sphere to that of the nearest image of the second; length"""
    normal_forces: np.ndarray
    """(C,), force along the line of centres, positive if repulsive, negative if attractive; force"""
    tangential_forces: np.ndarray
    """(C, 3), on the first sphere, perpendicular to the line of centres; force"""
    state: np.ndarray
    """(C,), index in `STATES`"""

    def __len__(self):
        return len(self.pairs)

    @property
    def normals(self):
        """(C, 3), unit vectors from the first sphere to the second"""
        return self.separations / np.linalg.norm(self.separations, axis=1, keepdims=True)

    @property
    def forces(self):
        """(C, 3), total force on the first sphere; that on the second is opposite; force"""
        return self.tangential_forces - self.normal_forces[:, None] * self.normals

    @property
    def sliding(self):
        """(C,), whether the surfaces slide"""
        return self.state == STATES.index("sliding")


class ContactSteps(Mapping):
    """The contacts of a run by step: `contacts[100]`, `list(contacts)`."""

    def __init__(self, folder):
        self._folder = folder

    @cached_property
    def _paths(self):
        paths = {int(path.stem.removeprefix("contacts-")): path for path in self._folder.glob("contacts-*.h5")}
        return dict(sorted(paths.items()))

    def __getitem__(self, step):
        names = ("pair", "position", "separation", "normal_force", "tangential_force", "state")
        with opened(self._paths[step], "contacts") as file:
            columns, attributes = [file[name][:] for name in names], dict(file.attrs)
        lattice = np.reshape(attributes["lattice"], (3, 3))
        return Contacts(int(attributes["step"]), float(attributes["time"]), lattice, *columns)

    def __iter__(self):
        return iter(self._paths)

    def __len__(self):
        return len(self._paths)
