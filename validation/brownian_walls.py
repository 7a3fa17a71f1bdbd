"""Brownian motion at walls: random motions and drift of one sphere above a wall against its exact mobility (Brenner, Chem. Eng. Sci.
16, 242, 1961), and colloids that settle on a bottom against Monte Carlo of the same potential."""

import sys
from concurrent.futures import ThreadPoolExecutor

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from support.estimates import mean_and_error, without_step
from support.page import save, table, write_section
from support.program import mobility, results

FULL = "--full" in sys.argv[1:]
GAPS = (0.05, 0.2, 0.5, 1.0, 2.0)
DRAWS, ROOM, TOLERANCE = 4000 if FULL else 1000, 24.0, 1e-3
# Allowed error of variances and drifts: standard errors, and a relative part for the tolerance and the periodic images.
ERRORS, TOLERATED = 3.0, 0.01
# Colloids of radius 1 and weight kT/a with kT = 1; the unit of time is a^2/D_0.
COUNT, SIDE, HEIGHT, WEIGHT = 24, 10.0, 12.0, 1.0
STRENGTH, RANGE = 60.0, 0.4
STEPS = (2e-3, 4e-3, 8e-3) if FULL else (4e-3, 8e-3)
LENGTH, SETTLED = (60.0, 6.0) if FULL else (16.0, 4.0)
SWEEPS = 60000 if FULL else 15000
SCHEMES = ("drifter-corrector", "random-finite-difference")
# Allowed relative error of heights extrapolated to step 0 beyond the statistical error, for nonlinear terms.
BENT = 0.01
BINS = np.linspace(0, HEIGHT, 37)


def resistance(gap):
    """Resistance of a sphere of radius 1 that moves towards a plane wall, over the Stokes drag."""
    a = np.arccosh(1 + gap)
    n = np.arange(1, 30 + int(30 / a))
    # Twice the hyperbolic functions, over exp((2 n + 1) a).
    decay = np.exp(-(2 * n + 1) * a)
    above = (1 - decay**2) + (2 * n + 1) * np.sinh(2 * a) * decay
    below = (1 - decay) ** 2 - (2 * n + 1) ** 2 * np.sinh(a) ** 2 * decay
    return 4 / 3 * np.sinh(a) * np.sum(n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (above / below - 1))


def one_sphere(gap):
    """Diffusivities across and along the wall from draws, and the drift, over those of an isolated sphere, with the exact values."""
    case = {"box": [ROOM, ROOM, ROOM], "boundaries": ["periodic", "periodic", "wall"], "viscosity": 1 / (6 * np.pi), "radii": 1.0,
            "lubrication": True, "positions": [[0.0, 0.0, 1 + gap]]}
    drawn = mobility(case | {"noise": {"draws": DRAWS, "seed": 3, "drift": True}}, TOLERANCE)
    moved, drift = np.array(drawn["noise_velocities"])[:, 0], np.array(drawn["drift_velocities"])[:, 0, 2]
    along = mobility(case | {"forces": [[1.0, 0.0, 0.0]]}, TOLERANCE)["velocities"][0][0]
    across, step = 1 / resistance(gap), 1e-3 * gap
    slope = (1 / resistance(gap + step) - 1 / resistance(gap - step)) / (2 * step)
    found = [(np.mean(moved[:, 2] ** 2), across * np.sqrt(2 / DRAWS), across),
             (np.mean(moved[:, :2] ** 2), along / np.sqrt(DRAWS), along),
             (np.mean(drift), np.std(drift, ddof=1) / np.sqrt(DRAWS), slope)]
    good = all(abs(value - exact) < ERRORS * error + TOLERATED * exact for value, error, exact in found)
    cells = [f"{gap:g}"]
    for value, error, exact in found:
        cells += [f"{value:.4f} ± {error:.4f}", f"{exact:.4f}"]
    print(*cells, flush=True)
    return cells, good


def pair_potential(r):
    contact, reach = 2.0, 2.0 * (1 + RANGE / 2)
    return STRENGTH * np.clip(reach**2 - r**2, 0, None) ** 3 / (6 * contact * (reach**2 - contact**2) ** 2)


def own_potential(z):
    """Potential of the weight and of both walls, whose force is STRENGTH at contact."""
    at_wall = sum(STRENGTH * RANGE / 3 * np.clip(1 - (distance - 1) / RANGE, 0, None) ** 3 for distance in (z, HEIGHT - z))
    return WEIGHT * z + at_wall


def measured(z):
    """Means of the height and of its square, and the fraction of the spheres in each bin."""
    return np.concatenate([[z.mean(), np.square(z).mean()], np.histogram(z, BINS)[0] / COUNT])


def monte_carlo():
    random = np.random.default_rng(1)
    lattice = np.stack(np.meshgrid(*[np.arange(4)] * 2, np.arange(3), indexing="ij"), -1).reshape(-1, 3)[:COUNT]
    places = (lattice + 0.5) * [SIDE / 4, SIDE / 4, 2.4] + [0, 0, 0.2]
    rows, samples = np.arange(COUNT), []

    def energy(place, others):
        apart = place - others
        apart[:, :2] -= SIDE * np.round(apart[:, :2] / SIDE)
        return pair_potential(np.sqrt((apart**2).sum(-1))).sum() + own_potential(place[2])

    for sweep in range(SWEEPS):
        moves, chances = random.uniform(-0.6, 0.6, (COUNT, 3)), random.random(COUNT)
        for k in range(COUNT):
            others, trial = places[rows != k], places[k] + moves[k]
            if 0 < trial[2] < HEIGHT and chances[k] < np.exp(energy(places[k], others) - energy(trial, others)):
                places[k] = trial
        if sweep > SWEEPS // 10 and sweep % 5 == 0:
            samples.append(measured(places[:, 2]))
    return np.array(samples)


def brownian(case):
    scheme, step = case
    scene = f"""seed = 4
box = {{ edges = [{SIDE}, {SIDE}, {HEIGHT}], boundaries = ["periodic", "periodic", "walls"] }}
fluid = {{ viscosity = {1 / (6 * np.pi)}, thermal_energy = 1.0 }}
particles = {{ initial = "random", minimum_gap = 0.1 }}
repulsion = {{ strength = {STRENGTH}, range = {RANGE} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = {step}, steps = {round(LENGTH / step)}, brownian = "{scheme}" }}
output = {{ trajectory_every = {round(0.02 / step)}, observables_every = 0, checkpoint_every = 0 }}
[[species]]
radius = 1.0
count = {COUNT}
force = [0.0, 0.0, {-WEIGHT}]
"""
    with results(scene) as out:
        with h5py.File(out / "trajectory.h5") as file:
            heights, time = file["particles/all/position/value"][:, :, 2], file["particles/all/position/time"][:]
    return np.array([measured(z) for z in heights[time > SETTLED]])


def main():
    single = [one_sphere(gap) for gap in GAPS]
    cases = [(scheme, step) for scheme in SCHEMES for step in STEPS]
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(cases, two.map(brownian, cases)))
    exact, exact_error = mean_and_error(monte_carlo())
    failed = [] if all(good for _, good in single) else ["one sphere"]
    rows = [["Monte Carlo", "", *(f"{exact[k]:.3f} ± {exact_error[k]:.3f}" for k in (0, 1)), ""]]
    for scheme in SCHEMES:
        own = [(step, *mean_and_error(found[scheme, step])) for step in STEPS]
        for step, mean, error in own:
            profile = np.abs(mean[2:] - exact[2:]).max() / exact[2:].max()
            rows.append([scheme, f"{step:g}", *(f"{mean[k]:.3f} ± {error[k]:.3f}" for k in (0, 1)), f"{profile:.3f}"])
        limits = [without_step([(step, mean[k], error[k]) for step, mean, error in own]) for k in (0, 1)]
        rows.append([scheme, "0", *(f"{value:.3f} ± {error:.3f}" for value, error in limits), ""])
        for k, (value, error) in enumerate(limits):
            if abs(value - exact[k]) > ERRORS * np.hypot(error, exact_error[k]) + BENT * exact[k]:
                failed.append(f"{scheme}: {value:.3f} is not {exact[k]:.3f}")
    for cells in rows:
        print(*cells, flush=True)

    figure, axes = plt.subplots(figsize=(5, 3.6))
    # Volume fraction per fraction of the spheres in a slice.
    scale = COUNT * 4 / 3 * np.pi / (SIDE**2 * (BINS[1] - BINS[0]))
    middle = 0.5 * (BINS[1:] + BINS[:-1])
    axes.plot(exact[2:] * scale, middle, "k-", label="Monte Carlo")
    for scheme, style in zip(SCHEMES, ("o", "x")):
        axes.plot(mean_and_error(found[scheme, STEPS[0]])[0][2:] * scale, middle, style, ms=4, label=scheme)
    axes.set(xlabel="volume fraction (from positions of centres)", ylabel="z / a", xlim=(0, None))
    axes.legend()
    figure.tight_layout()
    save(figure, "brownian-walls.png")

    columns = ["gap", "across", "exact", "along", "mobility", "drift", "exact"]
    lines = [
        f"One sphere above a wall, with lubrication, in a box of {ROOM:g} radii, {DRAWS} draws at a tolerance of {TOLERANCE:g}: the",
        "diffusivities across and along the wall over \\\\(D_0\\\\) and the drift over \\\\(D_0/a\\\\), with Brenner's exact mobility",
        "across the wall, its derivative, and the mobility along the wall as computed. All rows use the same random numbers, so",
        "their errors are correlated.",
        "",
        *table(columns, [cells for cells, _ in single]),
        "",
        f"{COUNT} colloids of weight kT/a between walls {HEIGHT:g} radii apart, in a box of {SIDE:g} radii along the walls, over a time of",
        f"{LENGTH:g} \\\\(a^2/D_0\\\\), the unit of the steps: the means of the height and of its square, and the largest deviation of the",
        "profile from that of Monte Carlo, relative to its peak. Rows at step 0 are linear extrapolations.",
        "",
        *table(["", "step", "height", "height squared", "profile"], rows),
        "",
        "![Sediment of colloids](figures/brownian-walls.png)",
    ]
    write_section("brownian.md", "brownian-walls", "At walls", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
