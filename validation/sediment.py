"""Spheres that settle on a bottom: the velocity of the front against hindered settling in a periodic box (Richardson & Zaki 1954), the
sediment, and the screening of velocity fluctuations by the bottom."""

import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from support.page import save, table, write_section
from support.program import results

FULL = "--full" in sys.argv[1:]
SIZE, HEIGHT = (20.0, 40.0) if FULL else (10.0, 24.0)
FRACTION = 0.1
SEEDS = range(1, 21 if FULL else 9)
STEP, TIME = 0.05, 160.0 if FULL else 100.0
# Quantile of the heights that defines the front, and the range of heights over which its velocity is fitted.
FRONT, WINDOW = 0.95, (0.75, 0.4)
# Relative scatter of the velocity of few spheres, and volume fractions between loose and random close packing.
SCATTER, PACKED = 0.25, (0.4, 0.66)
# Height of the region near the bottom.
NEAR = 3.0


def scene(boundary, seed, steps):
    return f"""seed = {seed}
box = {{ edges = [{SIZE}, {SIZE}, {HEIGHT}], boundaries = ["periodic", "periodic", "{boundary}"] }}
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.02 }}
repulsion = {{ strength = 60.0, range = 0.02 }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ integrator = "implicit", step = {STEP}, steps = {steps} }}
output = {{ trajectory_every = 20, observables_every = 0, checkpoint_every = 0 }}
[[species]]
name = "heavy"
radius = 1.0
volume_fraction = {FRACTION}
force = [0.0, 0.0, {-6 * np.pi}]
"""


def frames(boundary, seed, steps=0):
    """Times, heights and velocities of each frame."""
    with results(scene(boundary, seed, max(steps, 1))) as out:
        with h5py.File(out / "trajectory.h5") as file:
            particles = file["particles/all"]
            return particles["position/time"][:], particles["position/value"][:, :, 2], particles["velocity/value"][:]


def at_first(boundary):
    """Heights and velocities at the start of all seeds together."""
    found = [frames(boundary, seed) for seed in SEEDS]
    return np.concatenate([z[0] for _, z, _ in found]), np.concatenate([v[0] for _, _, v in found])


def main():
    _, free = at_first("periodic")
    heights, bounded = at_first("wall")
    times, z, _ = frames("wall", 1, round(TIME / STEP))
    hindered, zaki = -free[:, 2].mean(), (1 - FRACTION) ** 5
    front = np.quantile(z, FRONT, axis=1)
    falling = (front < WINDOW[0] * HEIGHT) & (front > WINDOW[1] * HEIGHT)
    velocity = -np.polyfit(times[falling], front[falling], 1)[0]
    sediment = 2 * z[-1].mean()
    packed = z.shape[1] * 4 / 3 * np.pi / (SIZE**2 * sediment)
    deviations = [free.std(axis=0), bounded[heights < NEAR].std(axis=0), bounded[heights > HEIGHT / 3].std(axis=0)]

    figure, (course, spread) = plt.subplots(1, 2, figsize=(8, 3.4))
    course.plot(times, front, label="front")
    course.plot(times, z.mean(axis=1), label="mean")
    course.set(xlabel="time V / a", ylabel="z / a")
    course.legend()
    edges = np.linspace(0, HEIGHT, 9)
    bins = [bounded[(heights >= low) & (heights < high)] for low, high in zip(edges, edges[1:])]
    for axis, name in ((0, "along"), (2, "vertical")):
        (line,) = spread.plot([found[:, axis].std() for found in bins], 0.5 * (edges[1:] + edges[:-1]), label=name)
        spread.axvline(deviations[0][axis], linestyle=":", color=line.get_color())
    spread.set(xlabel="standard deviation of the velocity / V (dotted: periodic box)", ylabel="z / a")
    spread.legend()
    figure.tight_layout()
    save(figure, "sediment.png")

    checks = {
        "front falls as in the periodic box": abs(velocity / hindered - 1) < SCATTER,
        "sediment is packed": PACKED[0] < packed < PACKED[1],
        "bottom screens vertical fluctuations": deviations[1][2] < 0.8 * deviations[0][2],
    }
    faults = [claim for claim, holds in checks.items() if not holds]
    names = ("periodic box", f"bottom, below z = {NEAR:g} a", f"bottom, above z = {HEIGHT / 3:g} a")
    lines = [
        f"The settling velocity of {z.shape[1]} spheres at {FRACTION:.0%} in a periodic box of {SIZE:g} x {SIZE:g} x {HEIGHT:g} radii is",
        f"{hindered:.3f} of the Stokes velocity V, averaged over {len(SEEDS)} starts ((1 - φ)⁵ is {zaki:.3f}); above a bottom the front falls",
        f"with {velocity:.3f} V. The final height of the sediment, twice the mean height of the spheres, is about {sediment:.1f} radii, and its",
        f"volume fraction is {packed:.2f}. Initial standard deviations of the velocities over V:",
        "",
        *table(["", "x", "y", "vertical"], [[name, *(f"{value:.3f}" for value in found)] for name, found in zip(names, deviations)]),
        "",
        "![Spheres settling on a bottom](figures/sediment.png)",
        "",
        "; ".join(f"{claim}: {'yes' if holds else 'no'}" for claim, holds in checks.items()).capitalize() + ".",
    ]
    write_section("walls.md", "sediment", "Settling on a bottom", lines)
    print("\n".join(lines))
    if faults:
        raise SystemExit("failed: not found: " + ", ".join(faults))


if __name__ == "__main__":
    main()
