"""Times steps of JFSD, Fast Stokesian Dynamics in Python (Torre et al.), of spheres of radius 1 in shear on its device.

Run from a checkout of github.com/torrewk/Python-Jax-Fast-Stokesian-Dynamics, see jfsd_viscosity.py:

    python FCM_SOLVE/scripts/peers/jfsd_steps.py START.json STEPS

START.json has the edge of a cubic box and positions in it. Prints a JSON line: the device of JAX, and the wall seconds of a
step, the difference of two runs whose lengths differ by STEPS, after a run of the longer one has compiled all."""

import json
import sys
import time

import jax

from jfsd_viscosity import sheared

# Steps of the shorter run.
FIRST = 2


def main():
    with open(sys.argv[1]) as file:
        start = json.load(file)
    steps, taken = int(sys.argv[2]), []
    sheared(start["positions"], start["edge"], FIRST + steps)
    for many in (FIRST, FIRST + steps):
        began = time.perf_counter()
        sheared(start["positions"], start["edge"], many)
        taken.append(time.perf_counter() - began)
    print(json.dumps({"device": jax.default_backend(), "seconds": (taken[1] - taken[0]) / steps}))


if __name__ == "__main__":
    main()
