"""Overhead of a call of a mobility over the evaluation itself: checks, conversions and new arrays.

    python python/benchmarks/overhead.py
"""

from statistics import median
from time import perf_counter

import fcm_solve as fcm
import numpy as np

REPEATS = 2000


def overhead(mobility, loads):
    """Overhead of a call and wall time of its evaluation, in seconds."""
    start = perf_counter()
    motion = mobility(**loads)
    return perf_counter() - start - motion.seconds, motion.seconds


def main():
    for count in (1, 10, 100, 1000):
        mobility = fcm.Mobility(box=[80.0] * 3, radii=np.ones(count), viscosity=1.0, rigid=False, tolerance=1e-1)
        mobility.positions = np.random.default_rng(1).random((count, 3)) * 80
        loads = {"forces": np.ones((count, 3)), "torques": np.ones((count, 3))}
        costs, works = zip(*(overhead(mobility, loads) for _ in range(REPEATS)))
        print(f"{count:5} spheres: {1e6 * median(costs):.0f} us besides the evaluation of {1e6 * median(works):.0f} us")


if __name__ == "__main__":
    import warnings

    warnings.simplefilter("ignore", fcm.Caution)
    main()
