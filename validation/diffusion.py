"""Short-time self-diffusion of hard spheres: from random motions, against the trace of the program's own mobility on the same
configurations, and exact virial expansions."""

import sys

import numpy as np
from support import hard_spheres
from support.page import table, write_section
from support.program import mobility

FULL = "--full" in sys.argv[1:]
FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.45) if FULL else (0.1, 0.3)
SPHERES, CONFIGURATIONS, DRAWS = (108, 4, 1000) if FULL else (32, 2, 100)
# Vectors of random signs, whose products with the mobility of torques estimate its trace with small variance (Hutchinson).
PROBES = 32 if FULL else 4
TOLERANCE = 1e-3
# Allowed difference of diffusivities: standard errors, and a relative part for the tolerance.
ERRORS, TOLERATED = 3.0, 3e-3
# Finite-size correction in a cubic box: D = D_N + FINITE (phi/N)^(1/3) mu/eta, from 2.8373 a/L.
FINITE = 2.8373 * (4 * np.pi / 3) ** (-1 / 3)
# Mobilities relative to those of an isolated sphere: translation and rotation, over 1/(6 pi mu a) and 1/(8 pi mu a^3).
ALONE = {"velocities": 6 * np.pi, "angular_velocities": 8 * np.pi}


def diffusivities(case, random):
    """Diffusivities from draws and from the trace, for translation and rotation, with their variances, and the viscosity."""
    drawn = mobility(case | {"noise": {"draws": DRAWS, "seed": int(random.integers(2**31))}}, TOLERANCE)

    def product(motion, load, loads):
        """The mean over all components of loads times the motions that they cause."""
        return ALONE[motion] * np.mean(loads * mobility(case | {load: loads}, TOLERANCE)[motion])

    units = np.eye(3 * SPHERES).reshape(-1, SPHERES, 3)
    trace = sum(product("velocities", "forces", unit) for unit in units)
    signs = random.choice([-1.0, 1.0], size=(PROBES, SPHERES, 3))
    probed = [product("angular_velocities", "torques", vector) for vector in signs]
    traces = {"velocities": (trace, 0.0), "angular_velocities": (np.mean(probed), np.var(probed, ddof=1) / PROBES)}
    found = {}
    for motion in ALONE:
        squares = ALONE[motion] * np.mean(np.square(drawn[f"noise_{motion}"]), axis=(1, 2))
        found[motion] = [np.mean(squares), np.var(squares, ddof=1) / DRAWS, *traces[motion]]
    gradient = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    stresslets = np.array(mobility(case | {"background": {"velocity_gradient": gradient}}, TOLERANCE)["stresslets"])
    volume = np.prod(case["box"])
    return found, 1 + stresslets[:, 1].sum() / (2 * volume)


def row(fraction, lubrication):
    random, results, viscosities = np.random.default_rng(3), [], []
    for seed in range(CONFIGURATIONS):
        places, edge = hard_spheres.equilibrium(SPHERES, fraction, seed=seed + 1)
        case = {"box": [edge] * 3, "viscosity": 1.0, "radii": 1.0, "positions": places, "lubrication": lubrication}
        found, viscosity = diffusivities(case, random)
        results.append(found)
        viscosities.append(viscosity)
    cells, good, viscosity = [f"{fraction:.0%}", "yes" if lubrication else "no"], True, np.mean(viscosities)
    for motion in ALONE:
        noise, noise_variance, trace, trace_variance = np.mean([found[motion] for found in results], axis=0)
        error = np.sqrt((noise_variance + trace_variance) / CONFIGURATIONS)
        good &= abs(noise - trace) <= ERRORS * error + TOLERATED * trace
        cells += [f"{noise:.4f}", f"{trace:.4f} ± {error:.4f}"]
        if motion == "velocities":
            cells += [f"{trace + FINITE * (fraction / SPHERES) ** (1 / 3) / viscosity:.3f}"]
    exact = 1 - 1.8315 * fraction - 0.219 * fraction**2, 1 - 0.631 * fraction - 0.726 * fraction**2
    cells += [f"{viscosity:.3f}", *(f"{value:.3f}" if fraction <= 0.2 else "" for value in exact)]
    print(*cells, flush=True)
    return cells, good


def main():
    found = [row(fraction, lubrication) for fraction in FRACTIONS for lubrication in (False, True)]
    columns = ["φ", "lubrication", "\\\\(D\\\\), draws", "trace", "in a large box", "\\\\(D_r\\\\), draws", "trace"]
    columns += ["\\\\(\\eta_\\infty/\\mu\\\\)", "\\\\(D\\\\), expansion", "\\\\(D_r\\\\), expansion"]
    lines = [
        f"{SPHERES} hard spheres, {CONFIGURATIONS} configurations at equilibrium, {DRAWS} draws for each. All values are relative to an isolated",
        f"sphere. The trace for translation is computed column by column, that for rotation from {PROBES} vectors of random signs; the",
        "error is that of the difference between draws and trace. In a large box the diffusivity is larger by",
        f"\\\\({FINITE:.4f} (\\phi/N)^{{1/3}} \\mu/\\eta_\\infty\\\\). The virial expansions are \\\\(1 - 1.8315 \\phi - 0.219 \\phi^2\\\\) and",
        "\\\\(1 - 0.631 \\phi - 0.726 \\phi^2\\\\) (Cichocki, Ekiel-Jeżewska & Wajnryb 1999).",
        "",
        *table(columns, [cells for cells, _ in found]),
    ]
    write_section("brownian.md", "diffusion", "Short-time diffusion", lines)
    if not all(good for _, good in found):
        raise SystemExit("failed: the diffusivity of random motions is not the trace of the mobility")


if __name__ == "__main__":
    main()
