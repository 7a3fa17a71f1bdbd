"""Short runs of every kind that writes frames, made once."""

import functools
import pathlib
import tempfile

from program import ROOT, run

PLACE = tempfile.TemporaryDirectory()

# Edges differ, so that exchanged axes are detected. The sheared box passes the strain at which its lattice is remapped.
SCENES = {
    "straight": (
        "settling",
        {
            "box.edges": "[16.0, 12.0, 10.0]",
            "species[0].count": 25,
            "time.steps": 6,
            "output.trajectory_every": 1,
            "output.fields_every": 3,
            "statistics.every": 1,
        },
    ),
    "sheared": (
        "shear",
        {
            "box.edges": "[16.0, 12.0, 14.0]",
            "species[0].volume_fraction": 0.03,
            "species[1].volume_fraction": 0.03,
            "repulsion.strength": 1200.0,
            "flow.rate": 10.0,
            "time.step": 0.01,
            "time.duration": 0.1,
            "output.trajectory_every": 1,
            "output.fields_every": 2,
        },
    ),
    "disks": ("poiseuille-disks", {"box.edges": "[20.0, 25.0]", "time.strain": 0.3}),
    "cell": (
        "shear-cell",
        {"cell.length": 0.004, "cell.width": 0.005, "time.transient": 0.0, "time.steps": 10, "output.trajectory_every": 2},
    ),
}
# Boxes that are not periodic along all axes: walls across y, and one that grows with the spheres.
BOUNDED = {
    "channel": (
        "couette",
        {
            "box.edges": "[16.0, 9.0, 10.0]",
            "box.boundaries": '["periodic", "walls", "periodic"]',
            "species[0].volume_fraction": 0.05,
            "time.steps": 6,
            "output.fields_every": 3,
        },
    ),
    "cloud": (
        "cloud",
        {
            "species[0].count": 6,
            "particles.radius": 7.0,
            "time.step": 2.0,
            "time.steps": 6,
            "output.fields_every": 2,
        },
    ),
}
WITH_FIELDS = ["straight", "sheared", *BOUNDED]


@functools.cache
def folder(name):
    """The folder of a run."""
    scene, sets = (SCENES | BOUNDED)[name]
    out = pathlib.Path(PLACE.name) / name
    words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
    run(["run", ROOT / "scenes" / f"{scene}.toml", "--out", out, *words])
    return out
