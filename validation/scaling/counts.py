"""Messages and bytes that the program sends, counted on many ranks of this machine, more than it has cores."""

import dataclasses
import json
import math
import os
import pathlib
import shutil
import subprocess
import tempfile

from support.program import PROGRAM

HERE = pathlib.Path(__file__).resolve().parent
# Consecutive ranks that count as a node.
RANKS_PER_NODE = 8
EVALUATED, STEPPED = 20_000, 6_400
FRACTION, STEPPED_FRACTION = 0.12, 0.2
KINDS = ("sums", "halos", "groups")


@dataclasses.dataclass(frozen=True)
class Counts:
    """Largest and mean counts of a rank, by kind and name, as `counts.c` writes them."""

    of: dict

    def per(self, other, times):
        """A share of what was counted since another count."""
        pairs = {key: zip(value, other.of[key]) for key, value in self.of.items()}
        return Counts({key: [(now - before) / times for now, before in pair] for key, pair in pairs.items()})

    def largest(self, name):
        return sum(self.of[f"{kind}_{name}"][0] for kind in KINDS)

    def mean(self, kind, name):
        return self.of[f"{kind}_{name}"][1]


def edge(count, fraction):
    """Edge of the cubic box of unit spheres."""
    return (count * 4 / 3 * math.pi / fraction) ** (1 / 3)


def scene(count, fraction, lubricated):
    """Spheres in shear, or settling spheres without lubrication."""
    return f"""
title = "Scale"
seed = 1
box.edges = [{edge(count, fraction)}, {edge(count, fraction)}, {edge(count, fraction)}]
fluid.viscosity = 1.0
hydrodynamics = {{ tolerance = 1e-3, lubrication = {str(lubricated).lower()} }}
output = {{ trajectory_every = 0, checkpoint_every = 4 }}
time = {{ step = 0.005, steps = 4 }}
[[species]]
radius = 1.0
count = {count}
force = [0.0, 0.0, {"0.0" if lubricated else "-1.0"}]
""" + ("""
[flow]
kind = "shear"
rate = 1.0
lees_edwards = true
[repulsion]
strength = 60.0
[particles]
initial = "random"
minimum_gap = 0.01
""" if lubricated else "")


@dataclasses.dataclass
class Counter:
    """The compiled counter, and a folder for files."""

    folder: pathlib.Path

    def __post_init__(self):
        self.library = self.folder / "counts.so"
        subprocess.run(["mpicc", "-O1", "-shared", "-fPIC", HERE / "counts.c", "-o", self.library], check=True)

    def run(self, ranks, words):
        """The counts of a command on ranks, and its output."""
        file = self.folder / "counts.json"
        settings = {"COUNTS_FILE": file, "COUNTS_RANKS_PER_NODE": RANKS_PER_NODE, "LD_PRELOAD": self.library}
        exported = [word for name, value in settings.items() for word in ("-x", f"{name}={value}")]
        command = ["mpirun", "--oversubscribe", "-n", str(ranks), *exported, PROGRAM, *map(str, words)]
        environment = {**os.environ, "OMPI_MCA_mpi_yield_when_idle": "1"}
        ended = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
        return Counts(json.loads(file.read_text())), ended.stdout

    def evaluation(self, ranks):
        """Counts of an evaluation, and its line of `bench`."""
        words = ["bench", "--particles", EVALUATED, "--volume-fraction", FRACTION, "--threads", 1, "--no-error", "--repeats"]
        (few, _), (many, line) = self.run(ranks, [*words, 1]), self.run(ranks, [*words, 3])
        return many.per(few, 2), json.loads(line)

    def begun(self):
        """A run of spheres with lubrication that has made its first steps."""
        folder, path = self.folder / "begun", self.folder / "scene.toml"
        path.write_text(scene(STEPPED, STEPPED_FRACTION, lubricated=True))
        subprocess.run([PROGRAM, "run", path, "--out", folder, "--threads", "1"], check=True, capture_output=True)
        return folder

    def step(self, ranks, begun):
        """Counts of a step with lubrication, and of a resumed run besides its steps."""
        counts = []
        for steps in (6, 8):
            folder = self.folder / "resumed"
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(begun, folder)
            counts.append(self.run(ranks, ["resume", folder, "--steps", steps, "--threads", 1])[0])
        a_step = counts[1].per(counts[0], 2)
        twice = Counts({key: [2 * value for value in pair] for key, pair in a_step.of.items()})
        return a_step, counts[0].per(twice, 1)
