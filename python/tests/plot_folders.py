"""Synthetic folders of results for the tests of plots."""

import csv

import h5py
import numpy as np

SETTLING = """
title = "Settling"
[box]
edges = [10.0, 10.0, 10.0]
[fluid]
viscosity = 1.0
[[species]]
name = "heavy"
radius = 1.0
count = 3
force = [0.0, 0.0, -18.849555921538759]
"""
SHEAR = SETTLING.replace("force = [0.0, 0.0, -18.849555921538759]", '[flow]\nkind = "shear"\nrate = 2.0')
ANSWERS = "quantity,species,value,error,samples,transient,verdict,longer,unit".split(",")
FAMILY = "point,values,quantity,species,verdicts,unit,fluid.viscosity,mean,error,seeds,spread,claimed_error,calibration"


def write_csv(path, columns, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([columns, *rows])


def series(time, **columns):
    """Names and rows of a time series, with means and variances of a species that settles at half its Stokes velocity."""
    moving = {f"mean_velocity_{axis}[heavy]": 0 * time for axis in "xyz"} | {"mean_velocity_z[heavy]": 0 * time - 0.5}
    moving |= {f"velocity_variance_{axis}[heavy]": 0 * time + 0.04 for axis in "xyz"}
    all_columns = {"step": np.arange(len(time)), "time": time, **moving, "smallest_gap": 0 * time + 0.1, **columns}
    return list(all_columns), zip(*all_columns.values())


def write_trajectory(path, frames=2, count=3):
    """Spheres on a line."""
    positions = np.zeros((frames, count, 3)) + np.arange(1, count + 1)[:, None] * 2.5
    with h5py.File(path, "w") as file:
        particles = file.create_group("particles/all")
        for name, values in {"position": positions, "velocity": -0.5 * np.ones_like(positions)}.items():
            particles[f"{name}/value"] = values
            particles[f"{name}/step"], particles[f"{name}/time"] = np.arange(frames), 0.1 * np.arange(frames)
        particles["box/edges/value"] = np.tile(10.0 * np.eye(3), (frames, 1, 1))
        particles["radius"], particles["species"] = np.ones(count), np.zeros(count, dtype=int)


def run(folder, scene=SETTLING, rows=11, frames=2, **columns):
    """A folder of results; without rows or frames it lacks the file."""
    folder.mkdir(exist_ok=True)
    (folder / "scene.toml").write_text(scene, encoding="utf-8")
    if rows:
        write_csv(folder / "observables.csv", *series(np.linspace(0, 1, rows), **columns))
    if frames:
        write_trajectory(folder / "trajectory.h5", frames)
    return folder
