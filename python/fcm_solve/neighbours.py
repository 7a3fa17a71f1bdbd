"""Pairs of particles near each other."""

from __future__ import annotations

from functools import cached_property

import numpy as np


class Neighbours:
    """The P pairs whose centres are nearer than a cutoff, each once over all images; a particle and its own image are a pair too.

    `pairs`, `separations` and `gaps` are read-only views of the list that the program has found: nothing is copied, and they
    stay valid and what they are, however the simulation goes on. With ranks the first has them.
    """

    def __init__(self, core, cutoff):
        self._core = core
        self.cutoff = cutoff
        """The distance of centres within which all pairs are; length"""

    def __len__(self) -> int:
        return len(self._core)

    @cached_property
    def pairs(self) -> np.ndarray:
        """(P, 2), places of both among the particles in the order of the ids, as in `positions`"""
        return self._core.pairs

    @cached_property
    def separations(self) -> np.ndarray:
        """(P, 3), from the centre of the first to that of the second, or of its image; length"""
        return self._core.separations

    @cached_property
    def gaps(self) -> np.ndarray:
        """(P,), between the surfaces, negative where they overlap; length"""
        return self._core.gaps

    @cached_property
    def distances(self) -> np.ndarray:
        """(P,), of the centres; length"""
        return np.linalg.norm(self.separations, axis=1)

    def __repr__(self):
        return f"<fcm_solve.Neighbours: {len(self)} pairs nearer than {self.cutoff:g}>"
