"""Neighbour lists: pairs of near particles."""

from __future__ import annotations

from functools import cached_property

import numpy as np


class Neighbours:
    """The P pairs whose centres are nearer than a cutoff, each once over all images; a particle and its own image are a pair too.

    `pairs`, `separations` and `gaps` are read-only views of the library's list: nothing is copied, and they stay valid and
    unchanged while the simulation continues. On several ranks, the first rank has them.
    """

    def __init__(self, core, cutoff):
        self._core = core
        self.cutoff = cutoff
        """Largest distance of centres; length"""

    def __len__(self) -> int:
        return len(self._core)

    @cached_property
    def pairs(self) -> np.ndarray:
        """(P, 2), indices of both particles in the order of the ids, as in `positions`"""
        return self._core.pairs

    @cached_property
    def separations(self) -> np.ndarray:
        """(P, 3), vectors from the centre of the first particle to that of the second, or of its image; length"""
        return self._core.separations

    @cached_property
    def gaps(self) -> np.ndarray:
        """(P,), gaps between the surfaces, negative for overlaps; length"""
        return self._core.gaps

    @cached_property
    def distances(self) -> np.ndarray:
        """(P,), distances of the centres; length"""
        return np.linalg.norm(self.separations, axis=1)

    def __repr__(self):
        return f"<fcm_solve.Neighbours: {len(self)} pairs nearer than {self.cutoff:g}>"
