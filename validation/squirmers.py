"""Loads of two spheres by the slip of squirmers against solutions of their own: by the stream function in bispherical
coordinates along the line of centres, by multipoles across it, and by lubrication theory near contact."""

import numpy as np
from scipy.special import lpmv
from support.page import table, write_section
from support.program import two_sphere

RATIOS = (1.0, 2.0, 5.0)
# Gaps over the first radius for the stream function, and over the second for multipoles, which need many degrees nearer.
NEAR, APART = (1e-4, 1e-3, 0.01, 0.1, 1.0, 2.0), (0.3, 1.0, 2.0)
# Allowed differences, over the load of a sphere alone, and of the slope of the logarithm at contact.
LIMITS = {"stream function": 1e-7, "multipoles": 1e-7, "logarithm": 1e-3}
PLACES = ((0, 0), (0, 1), (1, 0), (1, 1))


def program(ratio, gap):
    return two_sphere(ratio, gap, "--slip")


# The stream function (1/(cosh xi - mu))^(3/2) sum U_n(xi) V_n(mu), V_n = P_(n-1) - P_(n+1) (Stimson & Jeffery 1926): it vanishes
# on both spheres, and its slope is the slip. Each degree has four unknowns of its own.


def surfaces(ratio, gap):
    """Focal distance, and the coordinates -beta and alpha of the spheres."""
    distance = 1 + ratio + gap
    focus = np.sqrt(gap * (distance + 1 + ratio) * (distance + ratio - 1) * (distance - ratio + 1)) / (2 * distance)
    return focus, np.arcsinh(focus), np.arcsinh(focus / ratio)


def slopes(alpha, count, slip):
    """Coefficients of V_n in sin(eta) u / sqrt(cosh alpha - mu), for n = 1 to count."""
    points = 1 << int(np.ceil(np.log2(max(512, 12 * count))))
    eta = (np.arange(points) + 0.5) * np.pi / points
    mu = np.cos(eta)
    weighted = slip(mu) / np.sqrt(np.cosh(alpha) - mu) * np.pi / points
    found, low, high = np.empty(count), np.ones_like(mu), mu
    for n in range(1, count + 1):
        after = ((2 * n + 1) * mu * high - n * low) / (n + 1)
        found[n - 1] = weighted @ (low - after) * n * (n + 1) / (2 * (2 * n + 1))
        low, high = high, after
    return found


def axial_forces(ratio, gap, mode):
    """Forces along the line of centres by the first or second mode, [bears][slips]."""
    focus, beta, alpha = surfaces(ratio, gap)
    n = np.arange(1, int(24 / min(alpha, beta)) + 21)
    low, high, one = n - 0.5, n + 1.5, np.ones(len(n))
    fall = lambda k: np.exp(-k * (alpha + beta))
    matrix = np.stack(
        [
            np.stack([one, fall(low), one, fall(high)], 1),
            np.stack([fall(low), one, fall(high), one], 1),
            np.stack([low, -low * fall(low), high, -high * fall(high)], 1),
            np.stack([low * fall(low), -low, high * fall(high), -high], 1),
        ],
        1,
    )
    forces = np.zeros((2, 2))
    for slips, (side, a) in enumerate([(-1, beta), (1, alpha)]):

        def slip(mu):
            across = np.sinh(a) * np.sqrt(1 - mu * mu) / (np.cosh(a) - mu)
            along = side * (np.sinh(a) ** 2 / (np.cosh(a) - mu) - np.cosh(a))
            return side * across * (1 if mode == 1 else along)

        right = np.zeros((len(n), 4))
        right[:, 3 - slips] = focus**2 * slopes(a, len(n), slip)
        found = np.linalg.solve(matrix, right[..., None])[..., 0]
        part = lambda first, second, a: found[:, first] * np.exp(-low * a) + found[:, second] * np.exp(-high * a)
        for bears, sources in enumerate([part(1, 3, beta), part(0, 2, alpha)]):
            forces[bears, slips] = 4 * np.sqrt(2) * np.pi / focus * np.sum((2 * n + 1) * sources)
    return forces


# Multipoles at both centres, u = grad(x.Phi + chi) - 2 Phi with harmonic Phi and chi (Papkovich & Neuber), fitted to the slip.


def harmonic(l, k, x):
    """r^(-l-1) P_l^k(cos th) exp(i k phi), without the phase of Condon & Shortley."""
    if k < 0:
        factor = (-1.0) ** k / np.prod([float(j) for j in range(l + k + 1, l - k + 1)])
        return factor * np.conj(harmonic(l, -k, x))
    r = np.linalg.norm(x, axis=-1)
    return r ** (-l - 1) * (-1) ** k * lpmv(k, l, x[:, 2] / r) * np.exp(1j * k * np.arctan2(x[:, 1], x[:, 0]))


def gradient(l, k, x):
    plus, minus = -harmonic(l + 1, k + 1, x), (l - k + 1) * (l - k + 2) * harmonic(l + 1, k - 1, x)
    return np.stack([(plus + minus) / 2, (plus - minus) / 2j, -(l - k + 1) * harmonic(l + 1, k, x)], -1)


def fields(m, degrees, x):
    """Velocities (field, point, component) of the multipoles of an azimuthal order about a centre at the origin."""
    found = []
    for l in range(degrees):
        if l >= m:
            value, slope = harmonic(l, m, x).real, gradient(l, m, x).real
            found.append(slope)
            found.append(x[:, 2:] * slope - value[:, None] * np.array([0.0, 0.0, 1.0]))
        for k in [m + 1] if m == 0 else [m + 1, m - 1]:
            if l >= k:
                value, slope = harmonic(l, k, x), gradient(l, k, x)
                turn = 1.0 if k == m + 1 else -1.0
                moment = x[:, :1] * slope.real + turn * x[:, 1:2] * slope.imag
                found.append(moment - np.stack([value.real, turn * value.imag, 0 * value.real], -1))
    return np.array(found)


def slipping(m, mode, normal):
    """(n n - I).b or (n.Q.n) n - Q.n of the unit mode of an azimuthal order."""
    if mode == 1:
        axis = np.eye(3)[2 if m == 0 else 0]
        return normal * (normal @ axis)[:, None] - axis
    tensor = {0: np.diag([0, 0, 1.0]), 1: np.array([[0, 0, 1.0], [0, 0, 0], [1, 0, 0]]), 2: np.diag([1.0, -1, 0])}[m]
    pulled = normal @ tensor
    return normal * np.sum(pulled * normal, 1)[:, None] - pulled


def sphere(count, angles):
    """Gauss points of polar angles at some azimuths, and their weights."""
    z, weights = np.polynomial.legendre.leggauss(count)
    z, phi = (part.ravel() for part in np.meshgrid(z, angles, indexing="ij"))
    rho = np.sqrt(1 - z * z)
    return np.stack([rho * np.cos(phi), rho * np.sin(phi), z], 1), np.repeat(weights, len(angles)) / (2 * len(angles))


def moments(m, radius):
    """Means of u, of x times u and of the symmetric part of x u over a sphere, of the fields of low degrees."""
    normal, weights = sphere(16, (np.arange(16) + 0.5) * np.pi / 8)
    x = radius * normal
    u = fields(m, 5, x)
    tensor = np.einsum("p,pi,fpj->fij", weights, x, u)
    tensor = 0.5 * (tensor + tensor.transpose(0, 2, 1))
    return np.einsum("p,fpi->fi", weights, u), np.einsum("p,fpi->fi", weights, np.cross(x[None], u)), tensor


def loads(m, radius, coefficients):
    """Force, torque and first moment of the multipoles of one sphere."""
    (u, turned, first), (_, _, second) = moments(m, radius), moments(m, 1.5 * radius)
    c = coefficients[: len(u)]
    stresslet = (second * 1.5**3 - first) * -20 * np.pi * radius / (1.5**2 - 1)
    return 6 * np.pi * radius * c @ u, 12 * np.pi * radius * c @ turned, -np.tensordot(c, stresslet, 1)


def by_multipoles(ratio, gap, m, mode, degrees=36):
    """Loads of both spheres by the slip of each: [slips][bears]."""
    radii, centres = (1.0, ratio), (np.zeros(3), np.array([0.0, 0.0, 1 + ratio + gap]))
    normal, weights = sphere(3 * degrees, [np.pi / (4 * m) if m else 0.3])
    points = [centre + radius * normal for radius, centre in zip(radii, centres)]
    matrix = np.concatenate([fields(m, degrees, np.concatenate(points) - centre) for centre in centres])
    count = len(matrix) // 2
    scale = np.abs(matrix).max((1, 2))
    root = np.sqrt(np.tile(weights, 2))[:, None]
    system = (matrix / scale[:, None, None] * root).reshape(2 * count, -1).T
    answers = []
    for slips in (0, 1):
        wanted = np.zeros((2, len(normal), 3))
        wanted[slips] = slipping(m, mode, normal)
        found = np.linalg.lstsq(system, (wanted.reshape(-1, 3) * root).ravel(), rcond=1e-14)[0] / scale
        answers.append([loads(m, radius, part) for radius, part in zip(radii, (found[:count], found[count:]))])
    return answers


# Names of the values of each order and mode, with their components.
VALUES = {
    (0, 1): {"XF1": (0, 2), "XS1": (2, (2, 2))},
    (0, 2): {"XF2": (0, 2), "XS2": (2, (2, 2))},
    (1, 1): {"YF1": (0, 0), "YT1": (1, 1), "YS1": (2, (0, 2))},
    (1, 2): {"YF2": (0, 0), "YT2": (1, 1), "YS2": (2, (0, 2))},
    (2, 2): {"ZS2": (2, (0, 0))},
}


def differences(ratio, gap):
    """Largest difference of all values from those by multipoles, over the load of a sphere alone."""
    values, worst = program(ratio, gap), 0.0
    for (m, mode), names in VALUES.items():
        found = by_multipoles(ratio, gap, m, mode)
        for name, (kind, component) in names.items():
            for bears, slips in PLACES:
                value = found[slips][bears][kind][component]
                worst = max(worst, abs(values[f"{name}_{bears + 1}{slips + 1}"] - value) / (4 * np.pi))
    return worst


def axial_difference(ratio, gap):
    """Largest difference of the forces along the line of centres, over that of a sphere alone."""
    values = program(ratio, gap)
    found = {mode: axial_forces(ratio, gap, mode) for mode in (1, 2)}
    return max(abs(values[f"XF{mode}_{i + 1}{j + 1}"] - found[mode][i, j]) / (4 * np.pi) for mode in (1, 2) for i, j in PLACES)


def logarithms(ratio):
    """Largest relative difference of slopes in the logarithm of the gap near contact: along the line of centres from
    lubrication theory, across it from those of a sphere that rotates with the slip at contact."""
    gaps, radii = (1e-6, 2e-6), (1.0, ratio)
    slip, rigid = [program(ratio, gap) for gap in gaps], [two_sphere(ratio, gap) for gap in gaps]
    slope = lambda values, name: (values[1][name] - values[0][name]) / np.log(gaps[1] / gaps[0])
    reduced = ratio / (1 + ratio)
    worst = 0.0
    for bears, slips in PLACES:
        place, reverse = f"{bears + 1}{slips + 1}", f"{slips + 1}{bears + 1}"
        # The slip near contact: radially kappa rho, and as that of a rotation.
        for mode, kappa, turn in ((1, (1, -1)[slips], (-1, 1)[slips]), (2, 1, -1)):
            squeezed = 12 * np.pi * reduced**2 * kappa / radii[slips] * (1, -1)[bears]
            size = radii[bears] + radii[slips]
            pushed = -np.pi * size**2 * slope(rigid, f"YB{reverse}") * turn / radii[slips]
            twisted = np.pi * size**3 * slope(rigid, f"YC{place}") * turn / radii[slips]
            for name, exact in (("XF", squeezed), ("YF", pushed), ("YT", twisted)):
                worst = max(worst, abs(slope(slip, f"{name}{mode}_{place}") / exact - 1))
    return worst


def main():
    rows, failed = [], []
    for ratio in RATIOS:
        checks = {
            "stream function": max(axial_difference(ratio, gap) for gap in NEAR),
            "multipoles": max(differences(ratio, ratio * gap) for gap in APART),
            "logarithm": logarithms(ratio),
        }
        rows.append([f"{ratio:g}", *(f"{value:.1e}" for value in checks.values())])
        print(*rows[-1], flush=True)
        failed += [f"{name}, ratio {ratio:g}: {value:.1e}" for name, value in checks.items() if value > LIMITS[name]]
    lines = [
        "Loads of two spheres at rest by the slip of squirmers (`fcm-solve two-sphere --slip`). Forces along the line of",
        "centres are compared with a solution by the stream function at gaps of 0.0001 to 2 of the first radius, all loads with",
        "multipoles about both centres at gaps of 0.3 to 2 of the second: largest differences over the load of a sphere alone.",
        "Slopes in the logarithm of the gap near contact are compared with lubrication theory: largest relative differences.",
        "",
        *table(["a₂/a₁", "stream function", "multipoles", "logarithm at contact"], rows),
    ]
    write_section("squirmers.md", "squirmers", "Loads by slip", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
