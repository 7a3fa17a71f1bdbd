"""Relative viscosities of sheared suspensions by JFSD, Fast Stokesian Dynamics in Python (Torre et al.), for comparison.

Run from a checkout of github.com/torrewk/Python-Jax-Fast-Stokesian-Dynamics, with jax==0.4.18 jaxlib==0.4.18 "numpy<2"
scipy==1.10.1 absl-py tqdm toml, and jraph==0.0.6.dev0 without its dependencies:

    JAX_PLATFORMS=cpu python FCM_SOLVE/scripts/peers/jfsd_viscosity.py COUNT FRACTION SEEDS > FCM_SOLVE/validation/data/NAME.csv
    JAX_PLATFORMS=cpu python FCM_SOLVE/scripts/peers/jfsd_viscosity.py COUNT FRACTION --time STEPS [THERMAL_ENERGY]

prints a row for each seed, of the spheres that validation/support/hard_spheres.py places at that seed; or the CPU seconds
that a step takes once everything is compiled, with a thermal energy in units of the drag 6 pi of a sphere if one is given."""

import contextlib
import pathlib
import sys
import time

import numpy as np

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[2] / "validation"), "."]
from support.hard_spheres import equilibrium, smallest_gap

from jfsd import main

TOLERANCE = 1e-3


def sheared(centres, edge, steps, thermal_energy=0.0):
    """Stresslets (xx, xy, xz, yz, yy) in the shear u = y of `steps` steps, over the drag 6 pi of a sphere."""
    count, none = len(centres), np.zeros(3)
    box, switches = (edge, edge, edge, count, 0.5), (1, 1, 0)
    with contextlib.redirect_stdout(sys.stderr):
        _, stresslets, _, _ = main.main(
            steps, 1, 1e-3, *box, thermal_energy, 1, 0.5, TOLERANCE, 0.0, 0, 0.0, np.array(centres) - edge / 2, 0, 0, 0, 0, 1.0, 0.0, None,
            *switches, none, none, 2, 0, 0, 0.0, 0.0,
        )
    return np.asarray(stresslets)[0]


def viscosity(centres, edge):
    return 1 + 6 * np.pi * sheared(centres, edge, 1)[:, 1].sum() / edge**3


def seconds_per_step(centres, edge, steps, thermal_energy):
    sheared(centres, edge, 1, thermal_energy)
    taken = []
    for many in (1, 1 + steps):
        began = time.process_time()
        sheared(centres, edge, many, thermal_energy)
        taken.append(time.process_time() - began)
    return (taken[1] - taken[0]) / steps


def report():
    count, fraction, seeds = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
    if seeds == "--time":
        centres, edge = equilibrium(count, fraction, 1)
        thermal_energy = float(sys.argv[5]) if len(sys.argv) > 5 else 0.0
        print(f"{seconds_per_step(centres, edge, int(sys.argv[4]), thermal_energy):.2f} CPU seconds per step")
        return
    print("count,fraction,seed,smallest_gap,relative_viscosity", flush=True)
    for seed in range(1, int(seeds) + 1):
        centres, edge = equilibrium(count, fraction, seed)
        row = f"{smallest_gap(centres, edge):.4e},{viscosity(centres, edge):.5f}"
        print(f"{count},{fraction},{seed},{row}", flush=True)


if __name__ == "__main__":
    report()
