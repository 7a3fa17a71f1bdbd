"""Prints the settling velocity of a run, and the result of Richardson & Zaki."""

import argparse
import importlib
import pathlib

import numpy as np

import plots

# Richardson & Zaki, Trans. Inst. Chem. Eng. 32, 35 (1954), at small Reynolds numbers: U / U_Stokes = (1 - phi)^n.
EXPONENT = 4.7


def results(folder):
    """The results in a folder."""
    package = plots.load().__name__
    scene, run = (importlib.import_module(f"{package}.{name}") for name in ("scene", "run"))
    return run.Run(folder, scene.read_scene(folder))


def settling(run):
    """Name of each species that settles, and its mean velocity over the Stokes velocity as a function of time."""
    for number, stokes in run.stokes_velocities():
        mean = run.vector("mean_velocity", number)
        if mean is not None:
            yield run.names[number], mean @ stokes / (stokes @ stokes)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path, help="the results of a run")
    run = results(parser.parse_args().folder)
    found = list(settling(run)) if run.series is not None and run.frames is not None else []
    if not found:
        return
    time, frames = run.get("time"), run.frames
    late = time >= 0.5 * time[-1]
    fraction = float(np.sum(4 / 3 * np.pi * frames.radii**3) / np.linalg.det(frames.lattice(0)))
    print(f"Mean settling velocity over Stokes velocity, at a volume fraction of {fraction:.3f}:")
    for name, mean in found:
        print(f"  {name:20s} {np.mean(mean[late]):6.3f}   (times {time[late][0]:g} to {time[-1]:g})")
    print(
        f"  Richardson & Zaki    {(1 - fraction) ** EXPONENT:6.3f}   ((1 - phi)^{EXPONENT}, experiments with equal spheres)"
    )
    print(
        "The experiments differ: here the positions are still nearly random, and periodic images reduce the velocity by a few hundredths."
    )
    if not run.scene.section("hydrodynamics").get("lubrication"):
        print("The spheres are resolved up to dipoles, without lubrication.")


if __name__ == "__main__":
    main()
