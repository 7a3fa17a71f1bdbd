"""Times DPStokes, doubly periodic Stokes flow in Python and C++ (Hashemi et al. 2023), on spheres between walls.

Needs a checkout of github.com/stochasticHydroTools/DoublyPeriodicStokes with its CPU part built, see docs/src/peers.md:

    DPSTOKES=CHECKOUT LD_LIBRARY_PATH=CHECKOUT/python_interface/lib python dpstokes_slit.py PLACES.json POINTS

PLACES.json has the edges of the box and positions of spheres of radius 1 in it; POINTS, 4 or 6, is the width of the kernel. Prints the CPU seconds of
one product of the mobility with forces, and its relative error, against a grid twice as fine."""

import contextlib
import json
import os
import pathlib
import sys
import time

import numpy as np

# Names that numpy had when DPStokes was written.
np.int, np.float, np.complex, np.bool = int, float, complex, bool
sys.path.insert(0, str(pathlib.Path(os.environ["DPSTOKES"]) / "source" / "cpu" / "python"))
import config

config.num_threads = 1
from FCM import FCM

# DPStokes' names of its kernels by their points.
KERNELS = {4: 2, 6: 0}
PRODUCTS = 10


def problem(edges, positions, points, is_reference):
    count = len(positions)
    made = FCM(np.ones(count), np.full(count, KERNELS[points]), "DPSC", False)
    made.SetUnitCell([0.0, edges[0]], [0.0, edges[1]], [0.0, edges[2]])
    made.Initialize(1.0, 0, ref=is_reference)
    made.SetPositions(positions.ravel().copy())
    return made


def main():
    with open(sys.argv[1]) as file:
        case = json.load(file)
    points, positions = int(sys.argv[2]), np.array(case["positions"])
    forces = np.random.default_rng(1).normal(size=positions.size)
    with contextlib.redirect_stdout(sys.stderr):
        plain, fine = (problem(case["edges"], positions, points, is_reference) for is_reference in (False, True))
        found, exact = (one.Mdot(forces)[0].copy() for one in (plain, fine))
        start = time.process_time()
        for _ in range(PRODUCTS):
            plain.Mdot(forces)
        seconds = (time.process_time() - start) / PRODUCTS
    print(seconds, np.linalg.norm(found - exact) / np.linalg.norm(exact))


if __name__ == "__main__":
    main()
