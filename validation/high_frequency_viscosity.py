"""High-frequency viscosity and short-time self-mobility of hard spheres at equilibrium, with lubrication and without,
against Ladd, J. Chem. Phys. 93, 3484 (1990).

The published values are closed forms that represent that work's simulations and later ones to 1 or 2%. The viscosity is the
generalised expression of Saito, 1 + 5/2 x/(1 - x) with x = phi (1 + S) and S = phi + phi^2 - 2.3 phi^3, as Ladd's results
are quoted by Banchio & Naegele, J. Chem. Phys. 128, 104903 (2008), and Heinen, Banchio & Naegele, J. Chem. Phys. 135, 154504
(2011). Its series 1 + 2.5 phi + 5 phi^2 + 10 phi^3 is near the exact 5.00 and 9.09 of two and three spheres (Cichocki,
Ekiel-Jezewska, Szymczak & Wajnryb, J. Chem. Phys. 119, 606 (2003)). The self-mobility is
1 - 1.8315 phi (1 + 0.1195 phi - 0.70 phi^2) (Heinen et al. 2011). A box of N spheres has a self-mobility that is too small by
1.7601 (phi/N)^(1/3) over the viscosity, as Ladd found, and is corrected.

The self-mobility is estimated with random forces. The same estimate for spheres that are not rigid, whose exact value is
known, is the control variate that reduces its variance."""

import concurrent.futures
import math
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from support import hard_spheres
from support.page import save, table, write_section
from support.program import mobility

FRACTIONS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)
SPHERES, SAMPLES, PROBES = 108, 10, 8
TOLERANCE = 1e-3
# Largest relative difference with lubrication, up to a volume fraction.
LIMIT, DENSEST = 0.03, 0.45


def published_viscosity(phi):
    x = phi * (1 + phi + phi**2 - 2.3 * phi**3)
    return 1 + 2.5 * x / (1 - x)


def published_mobility(phi):
    return 1 - 1.8315 * phi * (1 + 0.1195 * phi - 0.70 * phi**2)


def viscosity(case, edge):
    """Relative viscosity, the mean over the three planes of shear: 1 + S_xy / (2 E_xy V), viscosity 1."""
    found = []
    for row, column, place in ((0, 1, 1), (0, 2, 2), (1, 2, 4)):
        gradient = np.zeros((3, 3))
        gradient[row, column] = 1.0
        answer = mobility(case | {"background": {"velocity_gradient": gradient.tolist()}}, TOLERANCE)
        found.append(1 + np.array(answer["stresslets"])[:, place].sum() / edge**3)
    return np.mean(found)


def probes(case, seed):
    """Estimates of the mean diagonal of the mobility over that of a single sphere, by random forces of either sign (Hutchinson)."""
    random = np.random.default_rng(seed)
    found = []
    for _ in range(PROBES):
        forces = random.choice([-1.0, 1.0], (SPHERES, 3))
        answer = mobility(case | {"forces": forces}, TOLERANCE)
        found.append(6 * np.pi * np.mean(forces * np.array(answer["velocities"])))
    return np.array(found)


def sample(job):
    """Viscosity and probes of the self-mobility of one configuration, [with, without lubrication], and the probes of spheres
    that are not rigid."""
    phi, seed = job
    centres, edge = hard_spheres.equilibrium(SPHERES, phi, 1000 * seed + round(100 * phi))
    case = {"box": [edge] * 3, "viscosity": 1.0, "positions": centres, "radii": 1.0}
    kinds = [case | {"lubrication": lubrication} for lubrication in (True, False)]
    etas = [viscosity(kind, edge) for kind in kinds]
    return etas, [probes(kind, seed) for kind in kinds], probes(case | {"rigid": False}, seed)


def steadied(found, known, phi):
    """Probes with reduced variance: the control variate is the estimate for spheres that are not rigid, whose self-mobility is that of
    an isolated sphere in its periodic box."""
    inverse = 1 / hard_spheres.box(SPHERES, phi)
    exact = 1 - 2.8372974795 * inverse + 4 * inverse**3
    slope = np.mean((found - found.mean()) * (known - known.mean())) / np.var(known)
    return found - slope * (known - exact)


def row(phi, samples):
    """Mean and standard error of [with, without lubrication][viscosity, self-mobility]."""
    etas, found, known = (np.array(values) for values in zip(*samples))
    both = []
    for k in (0, 1):
        own = steadied(found[:, k], known, phi).mean(1) + 1.7601 * (phi / SPHERES) ** (1 / 3) / etas[:, k]
        both.append(np.stack([etas[:, k], own], -1))
    both = np.stack(both, 1)
    return both.mean(0), both.std(0, ddof=1) / math.sqrt(SAMPLES)


def compute():
    """Means and standard errors by volume fraction."""
    jobs = [(phi, seed) for phi in FRACTIONS for seed in range(SAMPLES)]
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        samples = list(pool.map(sample, jobs))
    rows = [row(phi, samples[k * SAMPLES : (k + 1) * SAMPLES]) for k, phi in enumerate(FRACTIONS)]
    means, errors = zip(*rows)
    return np.array(means), np.array(errors)


def draw(means, errors):
    figure, panels = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    fine = np.linspace(0, 0.52, 200)
    for axes, quantity, published, name in (
        (panels[0], 0, published_viscosity, "viscosity $\\eta_\\infty / \\eta$"),
        (panels[1], 1, published_mobility, "short-time self-mobility $6\\pi\\eta a M_{self}$"),
    ):
        axes.plot(fine, published(fine), "k-", label="published")
        for k, (mark, label) in enumerate((("o", "with lubrication"), ("x", "without"))):
            axes.errorbar(FRACTIONS, means[:, k, quantity], errors[:, k, quantity], fmt=mark, label=label)
        axes.set_xlabel("volume fraction")
        axes.set_ylabel(name)
        axes.legend()
    panels[0].set_yscale("log")
    save(figure, "high-frequency-viscosity.png")


def cells(means, errors):
    for k, phi in enumerate(FRACTIONS):
        line = [f"{phi:.2f}"]
        for quantity, published in ((0, published_viscosity), (1, published_mobility)):
            right = published(phi)
            value, error = means[k, 0, quantity], errors[k, 0, quantity]
            line += [f"{right:.3f}", f"{value:.3f} ± {error:.3f}", f"{100 * (value / right - 1):+.1f}%"]
            line.append(f"{means[k, 1, quantity]:.3f}")
        yield line


def main():
    means, errors = compute()
    draw(means, errors)
    header = ["φ", "η published", "with lubrication", "difference", "without", "self-mobility published"]
    header += ["with lubrication", "difference", "without"]
    lines = table(header, list(cells(means, errors)))
    lines = [
        f"{SPHERES} spheres at equilibrium, {SAMPLES} configurations per row; errors are standard errors over them.",
        "",
        *lines,
        "",
        "![Viscosity and self-mobility](figures/high-frequency-viscosity.png)",
    ]
    write_section("lubrication.md", "high-frequency-viscosity", "Viscosity and self-mobility", lines)
    print("\n".join(lines))
    published = np.array([[published_viscosity(phi), published_mobility(phi)] for phi in FRACTIONS])
    worst = np.abs(means[:, 0] / published - 1)[np.array(FRACTIONS) <= DENSEST].max()
    if worst > LIMIT:
        raise SystemExit(f"failed: {worst:.1%} from the published values; it should be {LIMIT:.0%}")


if __name__ == "__main__":
    main()
