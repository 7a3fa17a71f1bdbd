"""Hard spheres of radius 1 at equilibrium, by Metropolis sampling."""

import numpy as np


def box(count, fraction):
    """Side of the cubic box of so many spheres at a volume fraction."""
    return (count * 4 / 3 * np.pi / fraction) ** (1 / 3)


def equilibrium(count, fraction, seed, sweeps=1500):
    """Centres of spheres at equilibrium, from a lattice with vacancies that melts."""
    random = np.random.default_rng(seed)
    edge = box(count, fraction)
    cells = int(np.ceil((count / 4) ** (1 / 3)))
    corners = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), -1).reshape(-1, 1, 3)
    basis = np.array([[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]])
    sites = ((corners + basis) / cells * edge).reshape(-1, 3)
    centres = sites[random.permutation(len(sites))[:count]]
    reach = min(0.5, 1.5 * (0.65 - fraction))
    for _ in range(sweeps):
        for i in random.permutation(count):
            trial = centres[i] + random.uniform(-reach, reach, 3)
            apart = centres - trial
            apart -= edge * np.round(apart / edge)
            squares = np.einsum("ij,ij->i", apart, apart)
            squares[i] = np.inf
            if squares.min() > 4:
                centres[i] = trial % edge
    return centres, edge


def smallest_gap(centres, edge):
    """The smallest distance between two surfaces."""
    apart = centres[:, None] - centres[None]
    apart -= edge * np.round(apart / edge)
    distances = np.linalg.norm(apart, axis=-1)
    np.fill_diagonal(distances, np.inf)
    return distances.min() - 2
