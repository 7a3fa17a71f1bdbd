"""Spheres in boxes: lattices, dense and dilute suspensions, in boxes of any boundaries and strain."""

import itertools

import numpy as np
from support import hard_spheres

CUBIC = {
    "sc": np.zeros((1, 3)),
    "bcc": np.array([[0, 0, 0], [0.5, 0.5, 0.5]]),
    "fcc": np.array([[0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]]),
}
# Right-handed lattice vectors of the primitive cell, in edges of the cubic one.
PRIMITIVE = {
    "sc": np.eye(3),
    "bcc": np.array([[-1, 1, 1], [1, -1, 1], [1, 1, -1]]) / 2,
    "fcc": np.array([[0, 1, 1], [1, 0, 1], [1, 1, 0]]) / 2,
}
CLOSE_PACKED = {"sc": np.pi / 6, "bcc": np.pi * np.sqrt(3) / 8, "fcc": np.pi * np.sqrt(2) / 6}


def volume(radii):
    return (4 / 3 * np.pi * np.asarray(radii) ** 3).sum()


def lattice(name, fraction, cells):
    """Centres of spheres of radius 1 in a number of cubic cells along each axis, and the edges of their box."""
    edge = (volume(np.ones(len(CUBIC[name]))) / fraction) ** (1 / 3)
    corners = np.array(list(itertools.product(range(cells), repeat=3)), float).reshape(-1, 1, 3)
    return ((corners + CUBIC[name]) * edge).reshape(-1, 3), [edge * cells] * 3


def primitive_cell(name, fraction):
    """Lattice vectors of the cell of one sphere of radius 1."""
    edge = (volume([1.0]) / fraction / np.linalg.det(PRIMITIVE[name])) ** (1 / 3)
    return PRIMITIVE[name] * edge


def dense(count, fraction, seed):
    """Centres of hard spheres of radius 1 near equilibrium, and the edges of their cubic box."""
    centres, edge = hard_spheres.equilibrium(count, fraction, seed, sweeps=60)
    return centres, [edge] * 3


def random(radii, edges, random, repeats=(True, True, True), strain=0.0, gap=0.01):
    """Centres of spheres at random, at least `gap` mean radii apart, in a sheared box that is periodic along some axes; `None` if they
    are not found."""
    edges, radii = np.asarray(edges, float), np.asarray(radii, float)
    centres = random.random((len(radii), 3)) * edges
    needed = (radii[:, None] + radii) * (1 + gap / 2)
    steps = itertools.product(*[(-1, 0, 1) if repeat else (0,) for repeat in repeats])
    images = np.array([[i * edges[0] + j * strain * edges[1], j * edges[1], k * edges[2]] for i, j, k in steps])
    for _ in range(800):
        centres = inside(centres, radii, edges, repeats, strain)
        apart = centres[:, None, None] - centres[None, :, None] + images
        distances = np.linalg.norm(apart, axis=-1)
        distances[distances < 1e-9] = np.inf
        overlap = np.maximum(needed[..., None] - distances, 0)
        if not overlap.any():
            return centres
        pushed = overlap * (0.51 + 0.15 * random.random()) / distances
        centres = centres + (apart * pushed[..., None]).sum((1, 2))
    return None


def inside(centres, radii, edges, repeats, strain):
    """The same centres, wrapped along periodic axes and clear of the faces along others."""
    centres = centres.copy()
    if repeats[1]:
        crossed = np.floor(centres[:, 1] / edges[1])
        centres[:, 1] -= crossed * edges[1]
        centres[:, 0] -= crossed * strain * edges[1]
    for axis in range(3):
        if not repeats[axis]:
            centres[:, axis] = np.clip(centres[:, axis], 1.02 * radii, edges[axis] - 1.02 * radii)
        elif axis != 1:
            centres[:, axis] %= edges[axis]
    return centres
