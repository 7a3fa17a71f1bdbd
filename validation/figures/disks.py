"""Sheared disks: the system of Santra, Schwarzer & Herrmann, Phys. Rev. E 54, 5066 (1996), for their figures."""

import csv

import h5py
import numpy as np
from matplotlib.collections import EllipseCollection

from runs import WORKERS, Run

# Steps per unit of strain at the paper's rate.
UNIT = 667
STEP, RATE = 0.15, 0.01
# Strain at which the paper shows its systems, the strain of a quick run, and that of the paper's runs.
SHOWN, QUICK, FULL = 195, 200, 1000


def scene(viscosity=0.01, strain=SHOWN, output=None, **more):
    """The paper's mixture, with the keys of `more` replaced."""
    return {
        "kind": "granular-disks",
        "title": f"Disks at a viscosity of {viscosity:g}",
        "box": {"edges": [100.0, 100.0]},
        "fluid": {"viscosity": viscosity},
        "flow": {"kind": "shear", "rate": RATE},
        "species": [{"radius": 1.0, "number_fraction": 1.0}, {"radius": 4.0, "number_fraction": 0.05}],
        "particles": {"area_fraction": 0.6},
        "time": {"step": STEP, "strain": float(strain)},
        "output": {"observables_every": UNIT, "checkpoint_every": 20 * UNIT, **(output or {})},
        **more,
    }


def snapshots(name, every=5, **what):
    """A run with a frame of the trajectory every `every` units of strain."""
    return Run(f"disks/{name}", scene(output={"trajectory_every": every * UNIT}, **what))


class Sweep(Run):
    """A family of runs over seeds, viscosities or rates of shear, made by the program on all cores."""

    def __init__(self, name, strain, seeds, particles=None, viscosities=None, rates=None):
        what = scene(strain=strain, output={"observables_every": 5 * UNIT, "trajectory_every": 0, "checkpoint_every": 0})
        what["particles"] |= particles or {}
        what["ensemble"] = {"seeds": seeds}
        points = [{"fluid.viscosity": viscosity} for viscosity in viscosities or []]
        # Records at the same strains.
        points += [{"flow.rate": rate, "output.observables_every": round(5 * UNIT * RATE / rate)} for rate in rates or []]
        what["sweep"] = points
        super().__init__(f"disks/{name}", what, threads=WORKERS)

    def branches(self):
        """The rows of the table of branches, as numbers."""
        return numbers(self.folder / "branches.csv")

    def averages(self, viscosity, rate=RATE):
        """Strain, mean segregation and its error."""
        rows = numbers(self.folder / "averages.csv")
        rows = [row for row in rows if (row["viscosity"], row["rate"]) == (viscosity, rate)]
        return tuple(np.array([row[key] for row in rows]) for key in ("strain", "segregation", "segregation_error"))


def numbers(path):
    """The rows of a table without the columns that name a point."""
    with open(path) as file:
        rows = [{key: value for key, value in row.items() if key not in ("point", "values")} for row in csv.DictReader(file)]
    return [{key: float(value) for key, value in row.items()} for row in rows]


def near(strain, values, centre, width=5.0):
    """Mean of the values at strains within `width` of `centre`."""
    return float(np.mean(values[np.abs(strain - centre) <= width]))


def frame(run, strain):
    """Positions, velocities and radii of the frame nearest to a strain, and that strain."""
    with h5py.File(run.folder / "trajectory.h5") as file:
        particles = file["particles/all"]
        strains = RATE * particles["position/time"][:]
        index = int(np.argmin(np.abs(strains - strain)))
        return (
            particles["position/value"][index],
            particles["velocity/value"][index],
            particles["radius"][:],
            strains[index],
        )


def draw(axes, run, strain, by="speed"):
    """A snapshot with the gray levels of the paper: the modulus of the velocity along x, or that of the excess velocity."""
    positions, velocities, radii, found = frame(run, strain)
    height = length = 100.0
    value = np.abs(velocities[:, 0])
    if by == "excess":
        value = np.hypot(velocities[:, 0] - RATE * (positions[:, 1] - height / 2), velocities[:, 1])
    shade = np.clip(value / np.percentile(value, 99), 0, 1)
    x, y = positions[:, 0] % length, positions[:, 1]
    # Disks that cross a vertical edge are shown on both sides.
    positions = np.concatenate([np.stack([x + shift, y], axis=1) for shift in (-length, 0, length)])
    size = np.tile(2 * radii, 3)
    gray = np.tile(0.85 - 0.75 * shade, 3)
    disks = EllipseCollection(size, size, np.zeros(len(size)), units="xy", offsets=positions, transOffset=axes.transData)
    disks.set_facecolor([(g, g, g) for g in gray])
    disks.set_edgecolor("0.2")
    disks.set_linewidth(0.2)
    axes.add_collection(disks)
    axes.set(xlim=(0, length), ylim=(0, height), aspect="equal", xticks=[], yticks=[])
    axes.set_title(rf"$\dot\gamma t = {found:.0f}$", fontsize=9)
