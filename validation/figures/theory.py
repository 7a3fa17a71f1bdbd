"""Predictions of theories and correlations, from their formulas."""

import concurrent.futures
import functools
import json
import subprocess

import numpy as np

from runs import PROGRAM, WORKERS, kept

# Gaps between two spheres, dense near contact, where the logarithm of the gap is the variable to integrate over.
GAPS = np.geomspace(1e-5, 30.0, 40)


def richardson_zaki(phi, exponent=4.7):
    """Richardson & Zaki, Trans. Inst. Chem. Eng. 32, 35 (1954)."""
    return (1 - phi) ** exponent


def brownian(phi):
    """Fit of the settling of Brownian spheres, distributed like hard spheres at equilibrium: Brzinski & Durian,
    arXiv:1710.09314 (2018). Their exponent for non-Brownian spheres is 4.48."""
    return richardson_zaki(phi, 5.6)


def batchelor(phi):
    """Batchelor, J. Fluid Mech. 52, 245 (1972): equal spheres at random, dilute."""
    return 1 - 6.55 * phi


def brady_durlofsky(phi):
    """Brady & Durlofsky, Phys. Fluids 31, 717 (1988), eq. (2.10): Rotne-Prager mobility and the Percus-Yevick hard-sphere
    fluid."""
    return (1 - phi) ** 3 / (1 + 2 * phi)


def chemical_potentials(densities, radii):
    """Chemical potentials of a mixture of hard spheres, over kT, by scaled particle theory, which is the compressibility route of
    Percus & Yevick (Lebowitz, Helfand & Praestgaard, J. Chem. Phys. 43, 774, 1965)."""
    d = 2 * np.asarray(radii)
    x0, x1, x2, x3 = (np.pi / 6 * np.sum(densities * d**n) for n in range(4))
    free = 1 - x3
    pressure = x0 / free + 3 * x1 * x2 / free**2 + 3 * x2**3 / free**3
    work = -np.log(free) + 3 * d * x2 / free + d**2 * (3 * x1 / free + 4.5 * x2**2 / free**2) + d**3 * pressure
    return np.log(densities) + work


def structure(densities, radii):
    """S_ij = delta_ij + rho_j times the integral of g_ij - 1, from the derivatives of the chemical potentials."""
    densities = np.asarray(densities, float)
    steps = 1e-6 * densities
    change = [
        (chemical_potentials(densities + e, radii) - chemical_potentials(densities - e, radii)) / (2 * e[j])
        for j, e in enumerate(np.diag(steps))
    ]
    return np.linalg.inv(np.transpose(change)) / densities[:, None]


def periodic_images(species, edge, rigid=True):
    """Reduction of the mean settling velocity of each species at random positions by the images of a cubic box, over its Stokes
    velocity: 2.8373 a_i / L sum_j S_ij F_j / F_i / eta (Mo & Sangani, Phys. Fluids 6, 1637, 1994, for one species), with the
    viscosity 1 + 5/2 phi + 5 phi^2 of rigid spheres, or 1. Species are (name, radius, density difference, volume fraction)."""
    radii, excess, fractions = (np.array(column, float) for column in list(zip(*species))[1:])
    forces, phi = excess * radii**3, sum(fractions)
    mixed = structure(fractions / (4 / 3 * np.pi * radii**3), radii) @ forces / forces
    viscosity = einstein(phi) + 5 * phi**2 if rigid else 1.0
    return 2.8373 * radii / edge * mixed / viscosity


def einstein(phi):
    """Einstein (1906); the viscosity of a dilute suspension."""
    return 1 + 2.5 * phi


# Davis & Gecol, AIChE J. 40, 570 (1994), eq. (6): fit of Batchelor & Wen's coefficients for equal densities and no Brownian
# motion, by the ratio of radii.
def sedimentation_coefficient(ratio):
    """S_ij for a_j / a_i = `ratio`."""
    return -(3.50 + 1.10 * ratio + 1.02 * ratio**2 + 0.002 * ratio**3)


def batchelor_wen(fractions, radii):
    """Batchelor & Wen, J. Fluid Mech. 124, 495 (1982): velocity of each species over its own Stokes velocity."""
    return [1 + sum(sedimentation_coefficient(b / a) * phi for phi, b in zip(fractions, radii)) for a in radii]


def davis_gecol(fractions, radii, coefficient=sedimentation_coefficient):
    """Davis & Gecol, AIChE J. 40, 570 (1994), eq. (5), with their coefficients or others."""
    own, total = coefficient(1.0), sum(fractions)
    extra = [sum((coefficient(b / a) - own) * phi for phi, b in zip(fractions, radii)) for a in radii]
    return [(1 - total) ** -own * (1 + more) for more in extra]


def resistance(gap, ratio=1.0):
    """The exact resistance functions of two spheres of radii 1 and `ratio` at a gap, by name."""

    def compute():
        command = [PROGRAM, "two-sphere", "--ratio", repr(ratio), "--gap", repr(gap), "--json"]
        return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)

    return kept(f"two-sphere-{ratio!r}-{gap!r}", compute)


def over_gaps(function):
    """A function of the gap at all `GAPS`."""
    with concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
        return list(pool.map(lambda gap: function(float(gap)), GAPS))


def pair_functions(gap):
    """A and B of Batchelor & Green, J. Fluid Mech. 56, 375 (1972), for equal spheres at a gap in radii, from the exact
    resistance functions: the motions of two force-free and torque-free spheres in a strain."""
    f, r = resistance(gap), 2 + gap
    a = 4 / 3 / r * (f["XG11"] + f["XG21"]) / (f["XA11"] - f["XA12"])
    coupling = [-4 * (f["YB11"] + f["YB21"]), -4 * (f["YB11"] - f["YB12"])]
    matrix = [[6 * (f["YA11"] - f["YA12"]), coupling[0]], [coupling[1], 8 * (f["YC11"] + f["YC12"])]]
    motion = np.linalg.solve(matrix, [8 * (f["YG11"] + f["YG21"]), 16 * (f["YH11"] + f["YH21"])])
    return a, 2 * motion[0] / r


def velocities_by_forces(gap, ratio=1.0):
    """Velocity of the first of two torque-free spheres of radii 1 and `ratio`, along and across the line of centres, relative to an
    isolated sphere under the same force, when the force acts on it and when it acts on the other."""
    f = resistance(gap, ratio)
    sums = np.add.outer([1.0, ratio], [1.0, ratio])

    def functions(name):
        return np.array([[f[f"{name}11"], f[f"{name}12"]], [f[f"{name}21"], f[f"{name}22"]]])

    along = np.linalg.inv(sums / 2 * functions("XA"))
    torques = -(sums**2) * functions("YB")
    across = 6 * np.linalg.inv(np.block([[3 * sums * functions("YA"), torques.T], [torques, sums**3 * functions("YC")]]))
    return along[0], across[0, :2]


def random_pairs(ratio=1.0):
    """Coefficients `(own, other)` of the velocity of spheres among others at random that are `ratio` times as large (Batchelor,
    J. Fluid Mech. 119, 379, 1982, for uniform pairs): `U_i / U_i0 = 1 + sum_j (own + other F_j / F_i) phi_j` with the weights F.
    For one species their sum is Batchelor's -6.55."""
    own, other = [], []
    for gap, (along, across) in zip(GAPS, over_gaps(lambda gap: velocities_by_forces(gap, ratio))):
        r = 1 + ratio + gap
        own.append((along[0] + 2 * across[0] - 3) * r * r * gap)
        other.append((along[1] + 2 * across[1] - 3 / r) * r * r * gap)
    steps = np.diff(np.log(GAPS))
    # Far away the first decreases as r^-4, so that the rest of the integral follows from the last value.
    far = own[-1] / GAPS[-1] * (1 + ratio + GAPS[-1])
    inner = [float(np.sum(0.5 * steps * (np.array(f)[1:] + np.array(f)[:-1]))) for f in (own, other)]
    return (inner[0] + far) / ratio**3, (inner[1] - (1 + 3 * ratio + ratio**2)) / ratio**3


@functools.cache
def random_coefficient(ratio):
    """S_ij for a_j / a_i = `ratio`, equal densities and pairs at random."""
    own, other = random_pairs(ratio)
    return own + other * ratio**3


class DilutePairs:
    """Velocity fluctuations of a dilute sheared suspension of equal spheres by the encounters of pairs (Drazer et al., J. Fluid
    Mech. 511, 237, 2004): a pair at r gives each sphere half of the relative velocity of eq. (11), so

        T_ij = phi 3/(4 pi) / 4 integral V_i V_j q(r) d^3r,

    with q = 1 for pairs at random, or for pairs on open trajectories the function of Batchelor & Green, J. Fluid Mech. 56,
    401 (1972), q(r) = exp(integral_r^inf 3 (B - A) / (1 - A) dr / r) / (1 - A)."""

    def __init__(self):
        # Beyond the last distance, A = 5/r^3 and B = 16/(3 r^5).
        self.r = 2 + GAPS
        self.a, self.b = np.transpose(over_gaps(pair_functions))
        integrand = 3 * (self.b - self.a) / (self.r * (1 - self.a)) * GAPS
        pieces = 0.5 * (integrand[1:] + integrand[:-1]) * np.diff(np.log(GAPS))
        beyond = -5 / self.r[-1] ** 3
        exponent = np.append(np.cumsum(pieces[::-1])[::-1], 0) + beyond
        self.q = np.exp(exponent) / (1 - self.a)

    def slopes(self, pairs):
        """T_11, T_22 and T_33 over phi, for `pairs` "random" or "sheared"."""
        q = self.q if pairs == "sheared" else np.ones_like(self.r)
        a, b = self.a, self.b
        # Averages over directions of the squares of (11), per r^2: <n1^2> = 1/3, <n1^4> = 1/5, <n1^2 n2^2> = 1/15,
        # <n1^4 n2^2> = 3/105, <n1^2 n2^2 n3^2> = 1/105.
        in_plane = b**2 / 4 / 3 + b * (a - b) / 15 + (a - b) ** 2 * 3 / 105
        across = (a - b) ** 2 / 105

        def integral(f):
            integrand = f * q * self.r**4 * GAPS
            inner = np.sum(0.5 * (integrand[1:] + integrand[:-1]) * np.diff(np.log(GAPS)))
            # The part below a gap of 1e-5 is negligible; far away f = c/r^6 with the last value.
            return 4 * np.pi * (inner + f[-1] * self.r[-1] ** 5)

        scale = 3 / (4 * np.pi) / 4
        return scale * integral(in_plane), scale * integral(in_plane), scale * integral(across)
