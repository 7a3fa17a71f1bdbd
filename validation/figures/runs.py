"""Runs of the program for the figures: each in a separate folder, continued if interrupted, and made once."""

import concurrent.futures
import csv
import json
import math
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = os.environ.get("FCM_SOLVE", str(TARGET / "release" / "fcm-solve"))
FOLDER = pathlib.Path(os.environ.get("FCM_SOLVE_RUNS", ROOT / "results" / "reproduce"))
WORKERS = int(os.environ.get("JOBS", os.cpu_count() or 1))

# The weight of a sphere of radius 1 whose Stokes velocity is 1, at viscosity 1.
WEIGHT = 6 * math.pi


def volume(radius):
    return 4 / 3 * math.pi * radius**3


def toml(value):
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    return repr(value)


def key_of(name):
    """A key as TOML writes it: in quotes if it has dots, like a swept key."""
    return f'"{name}"' if "." in name else name


def scene_text(scene):
    """A scene as TOML: tables of keys, and a list of tables for the species."""
    lines = [f"{key} = {toml(value)}" for key, value in scene.items() if not isinstance(value, (dict, list))]
    for name, table in scene.items():
        for one in table if isinstance(table, list) else [table] if isinstance(table, dict) else []:
            lines += ["", f"[[{name}]]" if isinstance(table, list) else f"[{name}]"]
            lines += [f"{key_of(key)} = {toml(value)}" for key, value in one.items()]
    return "\n".join(lines) + "\n"


class Run:
    """A scene and the folder of its results."""

    def __init__(self, name, scene, threads=1):
        self.name, self.scene, self.text, self.threads = name, scene, scene_text(scene), threads
        self.folder = FOLDER / name
        self.finished = self.folder / "finished.toml"

    def is_finished(self):
        return self.finished.exists() and self.finished.read_text() == self.text

    def has_a_part(self):
        """Whether there are results that `resume` can continue."""
        return any(self.folder.glob("checkpoint-*.bin")) or any(self.folder.glob("point-*"))

    def make(self):
        """Runs the scene, or continues it; a changed scene starts afresh."""
        if self.is_finished():
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        self.finished.unlink(missing_ok=True)
        started = self.folder / "started.toml"
        goes_on = started.exists() and started.read_text() == self.text and self.has_a_part()
        if goes_on:
            command = [PROGRAM, "resume", self.folder]
        else:
            started.write_text(self.text)
            command = [PROGRAM, "run", started, "--out", self.folder, "--force"]
        self.carry_out([*map(str, command), "--threads", str(self.threads)], goes_on)
        self.finished.write_text(self.text)
        print(f"finished   {self.name}, {self.seconds():.0f} core-seconds in total", flush=True)

    def carry_out(self, command, goes_on):
        """Runs the program, and records its core-seconds, added to those of previous parts."""
        log, before = self.folder / "log.txt", self.seconds() if goes_on else 0.0
        with open(log, "w") as file:
            child = subprocess.Popen(command, stdout=file, stderr=file)
            _, status, used = os.wait4(child.pid, 0)
        (self.folder / "seconds.txt").write_text(f"{before + used.ru_utime + used.ru_stime:.1f}\n")
        if status:
            raise SystemExit(f"{self.name}: {log.read_text().strip().splitlines()[-1]}\nfolder: {self.folder}")

    def seconds(self):
        """Core-seconds used so far, zero if unknown."""
        noted = self.folder / "seconds.txt"
        return float(noted.read_text()) if noted.exists() else 0.0

    def summary(self):
        """Value and error by (quantity, species)."""
        rows = self.table("summary")
        return {(row["quantity"], row["species"]): (float(row["value"]), float(row["error"])) for row in rows}

    def table(self, name):
        """The rows of a table of statistics."""
        with open(self.folder / "statistics" / f"{name}.csv") as file:
            return list(csv.DictReader(file))

    def columns(self, name, *wanted, **where):
        """Columns of numbers of a table, for the rows with the given values in `where`."""
        rows = [row for row in self.table(name) if all(row[key] == word for key, word in where.items())]
        return [[float(row[column]) for row in rows] for column in wanted]

    def series(self, name):
        """A column of the time series, with its times."""
        with open(self.folder / "observables.csv") as file:
            rows = list(csv.DictReader(file))
        return [float(row["time"]) for row in rows], [float(row[name]) for row in rows]


def kept(name, compute):
    """Result of a function (numbers, lists or words), cached in a file."""
    file = FOLDER / "kept" / f"{name}.json"
    if not file.exists():
        answer = json.dumps(compute())
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(answer)
    return json.loads(file.read_text())


def make(runs):
    """Makes all runs, as many at a time as there are cores."""
    unique = {run.name: run for run in runs}
    with concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
        for _ in pool.map(Run.make, unique.values()):
            pass


def over_seeds(runs, quantity):
    """Mean of a quantity over runs that differ only in their seeds, with its error: from the scatter of the runs or from their own
    errors, whichever is larger, since few runs may agree by chance. `quantity` returns value and error of one run."""
    values, errors = zip(*(quantity(run) for run in runs))
    count = len(values)
    mean = sum(values) / count
    own = math.sqrt(sum(error**2 for error in errors)) / count
    if count == 1:
        return mean, own
    scatter = math.sqrt(sum((value - mean) ** 2 for value in values) / count / (count - 1))
    return mean, max(scatter, own) if math.isfinite(own) else scatter
