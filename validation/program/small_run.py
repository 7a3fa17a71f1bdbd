"""A run of a few spheres that is stopped or killed before its end, and the compared results of such runs."""

import pathlib
import sys
import time

import h5py

from program import PATIENCE, ROOT

sys.path.insert(0, str(ROOT / "validation"))
from support.checkpoint import state_of  # noqa: E402

SCENE = ROOT / "scenes" / "settling.toml"
SETS = {
    "box.edges": "[14.0, 14.0, 14.0]",
    "species[0].count": 30,
    "output.trajectory_every": 10,
    "hydrodynamics.tolerance": 1e-2,
}


def words(sets):
    return [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]


def wait_for(condition, process):
    """Waits for a condition while a process runs."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if process.poll() is not None or time.monotonic() > deadline:
            process.kill()
            raise AssertionError(f"it does not come: {process.communicate()}")
        time.sleep(0.001)


def has_checkpoint(out):
    return any(out.glob("checkpoint-*.bin"))


def end_state(out, step):
    """The checkpoint of a step, and the frames of the trajectory."""
    checkpoint = state_of(out / f"checkpoint-{step:010}.bin")
    with h5py.File(out / "trajectory.h5") as file:
        particles = file["particles/all"]
        return checkpoint, particles["position/step"][:].tolist(), particles["position/value"][:].tobytes()


def ranks_of(launcher):
    """The processes that mpirun started."""
    children = pathlib.Path(f"/proc/{launcher.pid}/task/{launcher.pid}/children")
    return [int(child) for child in children.read_text().split()] if children.exists() else []
