"""Says how fast the particles of a run settled, beside what Richardson & Zaki found."""

import argparse

import numpy as np

from results import Results

# Richardson & Zaki, Trans. Inst. Chem. Eng. 32, 35 (1954), at small Reynolds numbers: U / U_Stokes = (1 - phi)^n.
EXPONENT = 4.7


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", help="the results of a run")
    run = Results(parser.parse_args().folder)
    settling = list(run.settling())
    if not settling:
        return
    late = run.time >= 0.5 * run.time[-1]
    fraction = run.volume_fraction()
    print(f"Mean settling velocity over Stokes velocity, at a volume fraction of {fraction:.3f}:")
    for index, mean, _, _ in settling:
        print(f"  {run.names[index]:20s} {np.mean(mean[late]):6.3f}   (times {run.time[late][0]:g} to {run.time[-1]:g})")
    print(f"  Richardson & Zaki    {(1 - fraction) ** EXPONENT:6.3f}   ((1 - phi)^{EXPONENT}, experiments with equal spheres)")
    print("The experiments differ: here the places are still nearly random, and the periodic images take a few hundredths.")
    if not run.scene.get("hydrodynamics", {}).get("lubrication"):
        print("The spheres are resolved up to dipoles, without lubrication.")


if __name__ == "__main__":
    main()
