"""Time of the work within a rank: on one thread of this machine by stage, and on all cores of a node as measured on sixteen."""

import csv
import dataclasses
import functools
import json
import math
import pathlib
import resource
import subprocess
import tempfile

from support.program import PROGRAM

from scaling.counts import FRACTION, STEPPED_FRACTION, scene

FILE = pathlib.Path(__file__).resolve().parents[1] / "data" / "sixteen-cores.csv"
CORES = 16
SPHERES, STEPPED = 100_000, 10_000
# Grid points along an axis, relative to those that the program chooses.
COARSENESS = (1.0, 0.86, 0.76, 0.67)
# Evaluations and steps that are timed.
REPEATS, STEPS = 4, 10


@dataclasses.dataclass(frozen=True)
class Work:
    """Seconds of an evaluation on one thread: of the transform of a point, over the logarithm of the points of a line, and of all else
    of a sphere; and grid points along an axis."""

    points: int
    of_point: float
    of_sphere: float
    spheres: int = SPHERES

    def transform(self, points, line):
        """Seconds of the transform of so many points, in lines of so many."""
        return self.of_point * points * math.log2(line)

    @property
    def seconds(self):
        return self.of_sphere * self.spheres + self.transform(self.points**3, self.points)


def processor_seconds(command):
    """Seconds of processor time of a command, in which other programs of the machine do not count, and its output."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ended = subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, ended.stdout


def evaluation(grid=None):
    """Work of an evaluation on a given grid or on that of the plan: processor time of more evaluations less that of fewer, divided among
    the stages by their shares of the time of `bench`."""
    command = [PROGRAM, "bench", "--particles", SPHERES, "--volume-fraction", FRACTION, "--threads", 1, "--no-error",
               *([] if grid is None else ["--method", "split", "--grid", grid]), "--repeats"]
    (few, _), (many, line) = processor_seconds([*command, 1]), processor_seconds([*command, 1 + REPEATS])
    found = json.loads(line)
    stages = {stage: found["seconds"][stage] for stage in ("spread", "fft", "interpolate", "near", "exchange")}
    scale = (many - few) / REPEATS / sum(stages.values())
    points, of_transform = found["grid"][0], stages.pop("fft") * scale
    return Work(points, of_transform / points**3 / math.log2(points), sum(stages.values()) * scale / SPHERES)


def evaluations():
    """Work by the coarseness of the grid."""
    found = {1.0: evaluation()}
    for coarseness in COARSENESS[1:]:
        found[coarseness] = evaluation(8 * round(coarseness * found[1.0].points / 8))
    return found


def step():
    """Seconds of a step with lubrication of a sphere, on one thread, after the starting steps."""
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / "scene.toml"
        path.write_text(scene(STEPPED, STEPPED_FRACTION, lubricated=True))
        command = [PROGRAM, "run", path, "--out", pathlib.Path(place) / "out", "--force", "--threads", 1, "--set"]
        few, many = (processor_seconds([*command, f"time.steps={steps}"])[0] for steps in (5, 5 + STEPS))
    return (many - few) / STEPS / STEPPED


@dataclasses.dataclass(frozen=True)
class Sixteen:
    """Ratios measured on sixteen cores: the time of work on a core of a node whose cores are all busy over that on a core
    alone, and the share of the work of a rank that its threads do not divide."""

    busy: float
    serial: float


@functools.cache
def measured_rows():
    """Rows of the measurements on sixteen cores."""
    with open(FILE) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def sixteen_cores(case, spheres):
    """Ratios of the measured case with the nearest number of spheres on the machine."""
    rows = [row for row in measured_rows() if row["case"] == case]
    nearest = min({int(row["spheres"]) for row in rows}, key=lambda count: abs(math.log(count / spheres)))
    times = {(row["ways"], int(row["cores"])): float(row["milliseconds"]) for row in rows if int(row["spheres"]) == nearest}
    ranks, threads = times["ranks", CORES], times["threads", CORES]
    alone = times.get(("ranks", 1), times["threads", 1])
    return Sixteen(CORES * ranks / alone, (threads / ranks - 1) / (CORES - 1))
