"""Small runs of every kind of scene, and their start and continuation."""

import dataclasses
import os
import pathlib
import shutil
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = os.environ.get("FCM_SOLVE", str(TARGET / "release" / "fcm-solve"))

# A hundred times the duration of any of these runs on an idle machine.
PATIENCE = 120


def patience(seconds):
    """Time after which a run is taken to hang, from the measured duration of one: on a busy machine all take longer."""
    return max(PATIENCE, 100 * seconds)


SUSPENSION = {
    "box.edges": "[10.0, 10.0, 10.0]",
    "species[0].count": 8,
    "time.steps": 4,
    "hydrodynamics.tolerance": 1e-2,
    "output.checkpoint_every": 2,
    "output.trajectory_every": 2,
    "output.fields_every": 4,
    "statistics.every": 1,
}
DISKS = {
    "box.edges": "[40.0, 50.0]",
    "preparation.inelastic_until": 2.0,
    "preparation.elastic_until": 10.0,
    "time.steps": 60,
    "output.observables_every": 20,
    "output.checkpoint_every": 25,
    "output.trajectory_every": 30,
}
CELL = {
    "cell.length": 0.004,
    "cell.width": 0.004,
    "grains.solid_fraction": 0.3,
    "time.transient": 0.002,
    "time.steps": 6,
    "output.checkpoint_every": 2,
    "output.trajectory_every": 3,
    "measure.pixels": "[5, 4]",
}
SWEEP = {
    "box.edges": "[30.0, 30.0]",
    "time.strain": 0.03,
    "output.observables_every": 20,
    "output.checkpoint_every": 20,
    "output.trajectory_every": 20,
}


@dataclasses.dataclass(frozen=True)
class Run:
    """A scene with the settings that make it small, and its ranks; without a launcher if `ranks` is None. Faults of calls are
    skipped for runs that write the same files by the same calls as another. The members of a family are processes: a kill
    may hit one of them, and the family continues."""

    name: str
    scene: str
    sets: dict
    ranks: int | None = None
    writes_as_another: bool = False
    is_family: bool = False

    def start(self, arguments, environment=None):
        launcher = [] if self.ranks is None else ["mpirun", "-n", str(self.ranks)]
        command = [*launcher, PROGRAM, *map(str, arguments)]
        environment = {**os.environ, **(environment or {})}
        pipe = subprocess.PIPE
        return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=environment, start_new_session=True)

    def call(self, arguments, environment=None, until=10 * PATIENCE):
        """Exit code and output; the code is None if the run hangs, that is, exceeds the time limit."""
        process = self.start(arguments, environment)
        try:
            said = "".join(process.communicate(timeout=until))
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            return None, "".join(process.communicate())
        return process.returncode, said

    def from_start(self, out):
        sets = [word for key, value in self.sets.items() for word in ("--set", f"{key}={value}")]
        return ["run", ROOT / "scenes" / f"{self.scene}.toml", "--out", out, *sets]

    def go_on(self, out):
        return [*self.from_start(out), "--continue"]

    def whole(self, out):
        """Runs without a fault, and returns the duration."""
        shutil.rmtree(out, ignore_errors=True)
        began = time.monotonic()
        code, said = self.call(self.from_start(out))
        if code != 0:
            raise RuntimeError(f"{self.name} ended with {code}:\n{said}")
        return time.monotonic() - began


TIMED = {"collisions": "time-stepped", "time.collision_step": 1e-6}
FREE = {"top": '{ kind = "free", pressure = 300.0, mass_per_area = 0.2 }'}
SHEARED = {"flow": '{ kind = "shear", rate = 1.0, lees_edwards = true }', "hydrodynamics.lubrication": "true"}

RUNS = {
    run.name: run
    for run in [
        Run("suspension", "settling", SUSPENSION),
        Run("suspension on 2 ranks", "settling", SUSPENSION, 2),
        Run("sheared suspension on 3 ranks", "settling", SUSPENSION | SHEARED, 3, writes_as_another=True),
        Run("disks", "granular-disks", DISKS),
        Run("event-driven cell", "shear-cell", CELL),
        Run("time-stepped cell", "shear-cell", CELL | TIMED, writes_as_another=True),
        Run("free cell", "shear-cell", CELL | FREE, writes_as_another=True),
        Run("sweep", "disk-sweep", SWEEP, is_family=True),
        Run("continuum", "shear-cell-continuum", {"cell.speeds": "[1.4, 2.0]", "output.points": 11}),
    ]
}
