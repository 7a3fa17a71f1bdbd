"""Exact motions of two spheres with the line of centres along z, from the two-sphere resistance functions."""

import functools

import numpy as np

from . import program


@functools.lru_cache(maxsize=None)
def functions(ratio, gap):
    return program.two_sphere(ratio, gap)


def part(ratio, gap, name, power, factor):
    """Dimensional 2 x 2 part of the resistance, radii 1 and ratio, viscosity 1, in Jeffrey & Onishi's normalisation."""
    radii, values = (1.0, ratio), functions(ratio, gap)
    entry = lambda i, j: factor * np.pi * (radii[i] + radii[j]) ** power * values[f"{name}{i + 1}{j + 1}"]
    return np.array([[entry(i, j) for j in (0, 1)] for i in (0, 1)])


def along(ratio, gap):
    """Velocities along the line of centres per force, and in the strain E_zz = 1, E_xx = E_yy = -1/2."""
    mobility = np.linalg.inv(part(ratio, gap, "XA", 1, 3.0))
    # Relative to the flow at its centre a sphere has the rate of strain -1.
    forces = part(ratio, gap, "XG", 2, 1.0).T @ [1.0, 1.0]
    return mobility, mobility @ forces


def across(ratio, gap):
    """(U1, U2, a Omega1, a Omega2) per force and torque, x and y, and in the strain E_xz = 1."""
    a, b, c = part(ratio, gap, "YA", 1, 3.0), -part(ratio, gap, "YB", 2, 1.0), part(ratio, gap, "YC", 3, 1.0)
    g, h = part(ratio, gap, "YG", 2, 1.0), part(ratio, gap, "YH", 3, 1.0)
    mobility = np.linalg.inv(np.block([[a, b.T], [b, c]]))
    return mobility, mobility @ (np.hstack([2 * g, 2 * h]).T @ [1.0, 1.0])


def strain_functions(ratio, gap):
    """A, B, C of both spheres (Batchelor & Green 1972)."""
    distance = 1 + ratio + gap
    first, second = along(ratio, gap)[1]
    u, v, c1, c2 = across(ratio, gap)[1]
    return -(second - first) / distance, -(v - u) / distance, c1, c2
