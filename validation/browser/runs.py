"""Short runs of every kind with a trajectory, and their reports, made once."""

import functools
import pathlib
import tempfile

from program import ROOT, run

PLACE = tempfile.TemporaryDirectory()

SCENES = {
    "settling": (
        "settling",
        {
            "box.edges": "[16.0, 16.0, 16.0]",
            "species[0].count": 100,
            "time.steps": 40,
            "output.trajectory_every": 10,
            "statistics.every": 2,
        },
    ),
    "sheared": (
        "shear",
        {
            "box.edges": "[14.0, 14.0, 14.0]",
            "species[0].volume_fraction": 0.05,
            "species[1].volume_fraction": 0.05,
            "flow.rate": 8.0,
            "repulsion.strength": 960.0,
            "time.duration": 0.05,
            "time.step": 0.000625,
        },
    ),
    "dense": (
        "dense",
        {
            "species[0].volume_fraction": 0.3,
            "time.duration": 0.02,
            "output.trajectory_every": 2,
            "output.contacts_every": 2,
        },
    ),
    "disks": ("granular-disks", {"box.edges": "[40.0, 40.0]", "time.strain": 0.4, "output.trajectory_every": 40}),
    "cell": (
        "shear-cell",
        {"cell.length": 0.004, "cell.width": 0.005, "time.transient": 0.0, "time.steps": 20, "output.trajectory_every": 2},
    ),
}


# Spheres with axes.
ORIENTED = {"swimming": ("squirmers", {"box.edges": "[14.0, 14.0, 14.0]", "time.duration": 0.2, "output.trajectory_every": 2})}

# A box much longer than wide, with few spheres.
LONG = {"chain": ("chain", {"time.duration": 0.2})}


@functools.cache
def report(name):
    """The page about a run."""
    scene, sets = (SCENES | ORIENTED | LONG)[name]
    out = pathlib.Path(PLACE.name) / name
    words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
    run(["run", ROOT / "scenes" / f"{scene}.toml", "--out", out, *words])
    run(["report", out])
    return out / "report.html"
