"""A run in a batch job that is repeatedly stopped and requeued, and an uninterrupted one."""

import os
import pathlib
import subprocess

import h5py

from support.checkpoint import state_of
from support.program import PROGRAM, ROOT

SETS = {
    "box.edges": "[14.0, 14.0, 14.0]",
    "species[0].count": 30,
    "time.steps": 1500,
    "output.checkpoint_every": 100,
    "output.trajectory_every": 50,
    "hydrodynamics.tolerance": 1e-2,
}
ARGUMENTS = [str(ROOT / "scenes" / "settling.toml"), *(word for item in SETS.items() for word in ("--set", "=".join(map(str, item))))]
JOB = ROOT / "scripts" / "batch" / "slurm.sh"
# Commands by which srun and mpirun start two ranks in a job.
LAUNCHERS = {"srun": "srun --mpi=pmix", "mpirun": "mpirun -n 2"}


def uninterrupted(out):
    """Runs to the end on two ranks, without a queue."""
    command = ["mpirun", "-n", "2", PROGRAM, "run", *ARGUMENTS, "--out", str(out)]
    subprocess.run(command, check=True, capture_output=True, timeout=600)


def requeued(slurm, launcher, out, times):
    """Runs to the end in a job that receives SIGUSR1 `times` times; returns the log."""
    out, log = pathlib.Path(out), pathlib.Path(f"{out}.log")
    slurm.environment |= {"LAUNCH": LAUNCHERS[launcher], "FCM_SOLVE": PROGRAM}
    job = slurm.submit("--time=30", JOB, *ARGUMENTS, "--out", out, log=log)
    del slurm.environment["LAUNCH"]
    complaint = lambda what: lambda: f"{what}, in state {slurm.state(job)}:\n{text(log)}"
    for number in range(times):
        stopped = last_step(out)
        slurm.wait(lambda stopped=stopped: has_got_on(out, stopped, log), complaint("the run does not go on"), patience=300)
        slurm.call("scancel", "--batch", "--signal=USR1", job)
        slurm.wait(lambda: text(log).count("requeued, restart") > number, complaint("the job does not stop"))
    slurm.wait(lambda: slurm.state(job) in ("COMPLETED", "FAILED", "TIMEOUT"), complaint("the job does not end"), patience=600)
    if slurm.state(job) != "COMPLETED":
        raise AssertionError(f"the job ended as {slurm.state(job)}:\n{text(log)}")
    return text(log)


def has_got_on(out, stopped, log):
    """Whether there is a later checkpoint; a job that has given up writes none."""
    if "given up after" in text(log):
        raise AssertionError(f"the job has given up:\n{text(log)}")
    return last_step(out) > stopped


def last_step(out):
    """The step of the last checkpoint; -1 without one."""
    return max((int(path.stem.split("-")[1]) for path in out.glob("checkpoint-*.bin")), default=-1)


def end_state(out):
    """Data that must be the same to the last bit: the last checkpoint, and the frames of the trajectory."""
    checkpoint = out / f"checkpoint-{SETS['time.steps']:010}.bin"
    with h5py.File(out / "trajectory.h5") as file:
        particles = file["particles/all"]
        return state_of(checkpoint), particles["position/step"][:].tobytes(), particles["position/value"][:].tobytes()


def text(path):
    return path.read_text() if os.path.exists(path) else ""
