"""Hard spheres of radius 1 at equilibrium, by Metropolis sampling."""

import numpy as np

# Sites of a cell of a face-centred cubic lattice.
BASIS = np.array([[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]])


def box(count, fraction):
    """Edge of the cubic box of a number of spheres at a volume fraction."""
    return (count * 4 / 3 * np.pi / fraction) ** (1 / 3)


def equilibrium(count, fraction, seed, sweeps=1500):
    """Centres of spheres at equilibrium, from a melting lattice with vacancies. If the lattice does not fit into the box, it
    melts in a larger one, which shrinks after every sweep as far as the nearest spheres allow."""
    random = np.random.default_rng(seed)
    edge = box(count, fraction)
    reach = min(0.5, 1.5 * (0.65 - fraction))
    centres, larger = lattice(count, edge, random)
    while larger > edge:
        sweep(centres, larger, reach, random)
        shrunk = max(edge, larger * 2 / (2 + smallest_gap(centres, larger)))
        centres *= shrunk / larger
        larger = shrunk
    for _ in range(sweeps):
        sweep(centres, edge, reach, random)
    return centres, edge


def lattice(count, edge, random):
    """Centres on some sites of a face-centred cubic lattice, and the edge of its box: `edge`, or more if spheres would overlap."""
    cells = int(np.ceil((count / 4) ** (1 / 3)))
    edge = max(edge, 2 * np.sqrt(2) * cells * (1 + 1e-9))
    corners = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), -1).reshape(-1, 1, 3)
    sites = ((corners + BASIS) / cells * edge).reshape(-1, 3)
    return sites[random.permutation(len(sites))[:count]], edge


def sweep(centres, edge, reach, random):
    """Tries to move each sphere once."""
    others = candidates(centres, edge, 2 + 2 * np.sqrt(3) * reach)
    for i in random.permutation(len(centres)):
        trial = centres[i] + random.uniform(-reach, reach, 3)
        near = others[i]
        apart = centres[near] - trial
        apart -= edge * np.round(apart / edge)
        squares = np.einsum("ij,ij->i", apart, apart)
        squares[near == i] = np.inf
        if squares.min() > 4:
            centres[i] = trial % edge


def candidates(centres, edge, distance):
    """Indices of the spheres that may be within a distance of each sphere: those in its cell and the adjacent ones. Unused entries of
    a row hold the index of the sphere itself. All spheres, if the box is too small for cells."""
    count, cells = len(centres), int(edge / distance)
    if cells < 4:
        return np.broadcast_to(np.arange(count), (count, count))
    at = (centres / edge * cells).astype(int) % cells
    cell = np.ravel_multi_index(at.T, (cells,) * 3)
    order = np.argsort(cell)
    held = np.bincount(cell, minlength=cells**3)
    place = np.arange(count) - np.repeat(np.cumsum(held) - held, held)
    members = np.full((cells**3, held.max()), -1)
    members[cell[order], place] = order
    steps = np.stack(np.meshgrid(*[(-1, 0, 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
    around = np.ravel_multi_index(np.moveaxis((at[:, None] + steps) % cells, -1, 0), (cells,) * 3)
    near = members[around].reshape(count, -1)
    return np.where(near < 0, np.arange(count)[:, None], near)


def smallest_gap(centres, edge):
    """The smallest distance between two surfaces."""
    apart = centres[:, None] - centres[None]
    apart -= edge * np.round(apart / edge)
    distances = np.linalg.norm(apart, axis=-1)
    np.fill_diagonal(distances, np.inf)
    return distances.min() - 2
