"""Scenes of grains: sheared disks, the shear cell and its kinetic theory, as a user runs them."""

import csv
import os
import pathlib
import random
import signal
import tempfile
import time
import unittest

import h5py
import numpy as np

from program import ROOT, run, start
from small_run import has_checkpoint, wait_for
from support.checkpoint import state_of

# For run.py.
HEAVY = 50

# Settings of short runs: about a second each, with checkpoints.
DISKS = {"box.edges": "[40.0, 50.0]", "time.steps": 12000, "output.checkpoint_every": 700, "output.trajectory_every": 3000}
EVENTS = {"time.steps": 60, "time.transient": 0.02, "output.checkpoint_every": 7, "grains.solid_fraction": 0.45}
RUNS = {
    "disks": ("granular-disks", DISKS),
    "event-driven": ("shear-cell", EVENTS),
    "time-stepped": ("shear-cell", EVENTS | {"collisions": "time-stepped", "time.collision_step": 1e-6, "time.steps": 40}),
    "free": ("shear-cell", EVENTS | {"top": '{ kind = "free", pressure = 300.0, mass_per_area = 0.2 }'}),
}


def words(name, sets):
    return [ROOT / "scenes" / f"{name}.toml", *(word for item in sets.items() for word in ("--set", "=".join(map(str, item))))]


def table(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def rows(path):
    with open(path) as file:
        return [{key: float(value) for key, value in row.items() if key != "wall"} for row in csv.DictReader(file)]


def end_state(out):
    """All reproducible results of a run."""
    state = {path.name: path.read_bytes() for path in sorted(out.glob("*.csv"))}
    checkpoint = max(out.glob("checkpoint-*.bin"))
    state[checkpoint.name] = state_of(checkpoint)
    with h5py.File(out / "trajectory.h5") as file:
        for name in ("position/step", "position/value", "velocity/value", "image/value", "box/strain/value"):
            state[name] = file[f"particles/all/{name}"][:].tobytes()
    return state


CELL = """
kind = "shear-cell"
collisions = "{collisions}"
[cell]
length = {length}
height = {height}
width = {length}
speed = {speed}
gravity = {gravity}
[top]
kind = "free"
pressure = {pressure}
mass_per_area = {mass_per_area}
[grains]
diameter = {diameter}
density = {density}
solid_fraction = 0.3
restitution = 0.9
friction = 0.3
[walls]
restitution = 0.9
[time]
step = {step}
steps = 2
{more}
"""


def cell(collisions, length, time, mass):
    """A small cell in other units, given as powers of ten; times with defaults are omitted."""

    def of(digits, power):
        return f"{digits}e{power}"

    step = f"collision_step = {of(5, time - 7)}" if collisions == "time-stepped" else ""
    return CELL.format(
        collisions=collisions,
        length=of(3.5, length - 3),
        height=of(3, length - 3),
        diameter=of(7.87, length - 4),
        speed=of(1.4, length - time),
        gravity=of(9.81, length - 2 * time),
        pressure=of(3, mass - length - 2 * time + 2),
        mass_per_area=of(2, mass - 2 * length - 1),
        density=of(2.55, mass - 3 * length + 3),
        step=of(1, time - 4),
        more=step,
    )


class Units(unittest.TestCase):
    """A cell in other units: defaults and messages do not depend on them."""

    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.scene = pathlib.Path(self.place.name) / "cell.toml"

    def first_rows(self, collisions, powers):
        self.scene.write_text(cell(collisions, *powers))
        outline = run(["check", self.scene])
        self.assertTrue(all(len(word) < 14 for word in outline.split()), outline)
        out = pathlib.Path(self.place.name) / "-".join([collisions, *map(str, powers)])
        run(["run", self.scene, "--out", out])
        return rows(out / "observables.csv")

    def test_a_cell_is_the_same_in_any_units(self):
        for collisions in ("event-driven", "time-stepped"):
            expected = self.first_rows(collisions, (0, 0, 0))
            for powers in [(30, 0, 0), (-30, 0, 0), (0, 30, 0), (0, -30, 0), (0, 0, 30), (30, -30, 30), (-30, 30, -30), (3, 6, 3)]:
                length, time, mass = powers
                units = {"height": length, "temperature": 2 * (length - time), "wall_stress": mass - length - 2 * time, "time": time}
                for found, wanted in zip(self.first_rows(collisions, powers), expected, strict=True):
                    for key, value in wanted.items():
                        power = units.get(key.split("_normal")[0].split("_along")[0].split("_across")[0], 0)
                        if key.endswith("_imbalance") or not np.isfinite(value):
                            continue
                        # A few collisions of each grain, each of which multiplies round-off by about ten. Stresses of Pa are small.
                        least = 1.0 if key.startswith("wall_stress") else 1e-3
                        off = abs(found[key] / 10.0**power - value) / max(abs(value), least)
                        self.assertLess(off, 1e-8, (collisions, powers, key))


class Grains(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.out = pathlib.Path(self.place.name) / "out"

    def run_scene(self, name, sets, out=None, expect=0):
        return run(["run", *words(name, sets), "--out", out or self.out], expect=expect)

    def test_a_killed_run_goes_on_to_the_same_end(self):
        random.seed(2)
        for kind, (name, sets) in RUNS.items():
            whole = self.out.with_name(f"{kind}-whole")
            began = time.monotonic()
            self.run_scene(name, sets, whole)
            seconds = time.monotonic() - began
            for attempt in range(2):
                out = self.out.with_name(f"{kind}-{attempt}")
                process = start(["run", *words(name, sets), "--out", out])
                wait_for(lambda out=out: has_checkpoint(out), process)
                time.sleep(random.uniform(0, 0.7 * seconds))
                process.kill()
                process.communicate()
                run(["resume", out])
                with self.subTest(kind=kind, attempt=attempt):
                    self.assertEqual(end_state(out), end_state(whole))

    def test_a_signal_ends_a_run_anywhere_and_it_goes_on_to_the_same_end(self):
        for kind, (name, sets) in RUNS.items():
            whole, out = (self.out.with_name(f"{kind}-{part}") for part in ("whole", "parts"))
            if kind == "disks":
                sets = sets | {"time.steps": 60000}  # Disks would finish fewer steps before the signal arrives.
            self.run_scene(name, sets, whole)
            process = start(["run", *words(name, sets | {"output.checkpoint_every": 100000}), "--out", out])
            wait_for(lambda out=out: has_checkpoint(out), process)
            time.sleep(0.05)
            os.kill(process.pid, signal.SIGTERM)
            _, said = process.communicate()
            with self.subTest(kind=kind):
                self.assertEqual(process.returncode, 128 + 15, said)
                self.assertIn(f"go on with: fcm-solve resume {out}", said)
                run(["resume", out])
                self.assertEqual(end_state(out), end_state(whole))

    def test_a_signal_ends_a_run_within_a_long_step(self):
        """A step that would take minutes is abandoned."""
        long = {"time.step": 20.0, "time.transient": 20.0, "time.duration": 40.0, "grains.solid_fraction": 0.45}
        engines = ({}, {"collisions": "time-stepped", "time.collision_step": 5e-7})
        for name, engine in zip(("event-driven", "time-stepped"), engines):
            out = self.out.with_name(name)
            process = start(["run", *words("shear-cell", long | engine), "--out", out])
            while not process.stderr.readline().startswith("results"):
                self.assertIsNone(process.poll(), "it ended")
            os.kill(process.pid, signal.SIGTERM)
            _, said = process.communicate(timeout=30)
            with self.subTest(engine=name):
                self.assertEqual(process.returncode, 128 + 15, said)
                self.assertIn("stopped after step 0 of 2", said)
                self.assertTrue(list(out.glob("checkpoint-*.bin")))

    def test_grains_that_jam_end_a_run_with_what_to_change(self):
        said = self.run_scene("shear-cell", {"cell.length": 0.005, "cell.width": 0.005, "grains.solid_fraction": 0.57}, expect=1)
        self.assertRegex(said, r"the grains jam at time 0\.0\d+: .*; lower grains\.solid_fraction, let the top go with")

    def test_a_check_does_not_wait_for_a_long_step(self):
        """No time is predicted for a step that would take hours."""
        said = run(["check", *words("shear-cell", {"collisions": "time-stepped", "time.collision_step": 5e-15})])
        self.assertNotIn("\ntime ", said)

    def test_threads_do_not_change_a_run(self):
        ends = []
        for threads in (1, 2):
            out = self.out.with_name(f"threads-{threads}")
            wide = words("granular-disks", {"box.edges": "[260.0, 260.0]", "time.steps": 60})
            run(["run", *wide, "--out", out, "--threads", threads])
            ends.append(end_state(out))
        self.assertEqual(*ends)

    def test_a_run_of_disks_balances_and_says_where_it_comes_from(self):
        self.run_scene("granular-disks", DISKS)
        series = rows(self.out / "observables.csv")
        # 5e-4 at a time step of 0.15; measuring every fifth step adds to it.
        self.assertLess(max(abs(row["energy_imbalance"]) for row in series[2:]), 5e-3)
        self.assertTrue(all(row["stress_xy"] < 0 < row["segregation"] for row in series[2:]))
        info = run(["info", self.out / "trajectory.h5"])
        self.assertIn("viscous length 0.1911", info)
        profile = rows(self.out / "profile.csv")
        self.assertAlmostEqual(sum(row["disks"] for row in profile), 289, places=9)
        # The disks move with the liquid, whose velocity increases by 0.5 from bottom to top.
        filled = [row for row in profile if row["disks"] > 0]
        slope = np.polyfit([row["height"] for row in filled], [row["velocity"] for row in filled], 1)[0]
        self.assertAlmostEqual(slope, 0.01, delta=0.001)
        self.assertTrue(any(0 < row["velocity_error"] < 0.1 for row in filled))

    def test_a_run_of_the_shear_cell_balances_and_bears_the_weight(self):
        self.run_scene("shear-cell", EVENTS)
        totals = rows(self.out / "totals.csv")[0]
        self.assertLess(max(totals["energy_imbalance"], totals["momentum_imbalance"]), 1e-9)
        walls = rows(self.out / "walls.csv")
        grains = totals["solid_fraction"] * 0.004 * 2550.0 * 9.81
        error = np.hypot(walls[0]["normal_error"], walls[1]["normal_error"])
        self.assertAlmostEqual(walls[0]["normal"] - walls[1]["normal"], grains, delta=4 * error)
        # The rows of the time series add up to the averages.
        series = [row for row in rows(self.out / "observables.csv") if row["step"] > 20]
        mean = np.mean([row["wall_stress_normal[top]"] for row in series])
        self.assertAlmostEqual(mean / walls[1]["normal"], 1, delta=1e-12)
        pixels = rows(self.out / "map.csv")
        self.assertEqual(len(pixels), 95 * 20)
        with h5py.File(self.out / "averages.h5") as file:
            self.assertEqual([name.decode() for name in file["walls/wall"]], ["bottom", "top", "outer", "inner"])
            np.testing.assert_array_equal(file["profile/y"], [row["y"] for row in rows(self.out / "profile.csv")])

    def test_a_dense_cell_is_packed_or_refused_with_what_it_reached(self):
        self.run_scene("shear-cell", {"grains.solid_fraction": 0.6, "time.steps": 0})
        with h5py.File(self.out / "trajectory.h5") as file:
            self.assertEqual(file["particles/all/position/value"].shape, (1, 602, 3))
            self.assertEqual(list(file["particles/all/box"].attrs["boundary"]), [b"periodic", b"none", b"none"])
        said = self.run_scene("shear-cell", {"grains.solid_fraction": 0.63}, self.out.with_name("dense"), expect=1)
        self.assertIn("grains.solid_fraction is 0.63; it needs 0 < solid_fraction <= 0.62", said)

    def test_a_stopped_family_of_disks_makes_no_run_twice(self):
        sets = {"box.edges": "[30.0, 30.0]", "time.strain": 40.0, "ensemble.seeds": "[1, 2, 3]"}
        whole = self.out.with_name("whole")
        self.run_scene("disk-sweep", sets, whole)
        process = start(["run", *words("disk-sweep", sets), "--out", self.out])
        while not list(self.out.glob("*/*/summary.csv")):
            self.assertIsNone(process.poll())
            time.sleep(0.001)
        os.kill(process.pid, signal.SIGINT)
        _, said = process.communicate()
        self.assertEqual(process.returncode, 128 + 2, said)
        self.assertRegex(run(["resume", self.out]), "[1-5] finished before")
        for name in ("averages.csv", "branches.csv", "family.csv"):
            self.assertEqual((self.out / name).read_bytes(), (whole / name).read_bytes())
        averages, last = table(whole / "averages.csv"), table(whole / "branches.csv")
        self.assertEqual([row["values"] for row in last], ["fluid.viscosity = 0.001", "fluid.viscosity = 0.01"])
        runs = [table(path) for path in sorted(whole.glob("point-0001/*/observables.csv"))]
        final = [row for row in averages if row["point"] == "point-0001"][-1]
        ends = [float(run[-1]["segregation"]) for run in runs]
        self.assertAlmostEqual(float(final["segregation"]), np.mean(ends), delta=1e-14)
        # Student's factor for three seeds.
        error = 1.3212775 * np.std(ends, ddof=1) / 3**0.5
        self.assertAlmostEqual(float(final["segregation_error"]) / error, 1, delta=1e-6)
        late = [np.mean([float(row["segregation"]) for row in run[-(-(-len(run) // 10)) :]]) for run in runs]
        self.assertAlmostEqual(float(last[0]["last_segregation"]), np.mean(late), delta=1e-14)

    def test_former_lists_of_a_sweep_are_a_family_with_a_warning(self):
        lists = {"sweep.seeds": "[1, 2]", "sweep.viscosities": "[0.001, 0.01]"}
        sets = {"box.edges": "[30.0, 30.0]", "time.strain": 1.0}
        said = self.run_scene("granular-disks", sets | lists)
        self.assertIn("warning: sweep.seeds has another name now: [ensemble] seeds\n", said)
        self.assertIn('warning: sweep.viscosities has another name now: [sweep] "fluid.viscosity"\n', said)
        self.assertNotIn("warning", run(["resume", self.out]))
        self.assertEqual(len(table(self.out / "branches.csv")), 2)

    def test_keys_have_former_names_with_a_warning(self):
        sets = {"time.steps": 2, "time.settle": 0.0, "grains.solid_fraction": 0.05}
        said = self.run_scene("shear-cell", sets)
        self.assertIn("warning: time.settle has another name now: time.transient\n", said)
        self.assertIn("transient = 0.0", (self.out / "scene.toml").read_text())

    def test_disks_start_from_a_file_and_from_a_former_run(self):
        self.run_scene("granular-disks", DISKS | {"time.steps": 10})
        scene = pathlib.Path(self.place.name) / "again.toml"
        text = (self.out / "scene.toml").read_text().replace("area_fraction = 0.6", f'path = "{self.out}"')
        scene.write_text(text)
        run(["run", scene, "--out", self.out.with_name("again")])
        run(["resume", self.out.with_name("again"), "--steps", 20])
        with h5py.File(self.out / "trajectory.h5") as first, h5py.File(self.out.with_name("again") / "trajectory.h5") as then:
            np.testing.assert_array_equal(
                first["particles/all/position/value"][-1], then["particles/all/position/value"][0]
            )

    def test_kinetic_theory_gives_the_known_flow_or_says_where_it_failed(self):
        said = self.run_scene("shear-cell-continuum", {})
        self.assertIn("at a speed of 2 and a pressure of 5500: mean solid fraction 0.5803", said)
        summary = rows(self.out / "summary.csv")
        for row, (fraction, stress) in zip(summary, [(0.6123, 1588.5), (0.5803, 1578.6), (0.5326, 1562.2)]):
            self.assertAlmostEqual(row["mean_solid_fraction"], fraction, delta=1e-4)
            self.assertAlmostEqual(row["shear_stress"] / stress, 1, delta=1e-3)
            self.assertLess(row["residual"], 1e-8)
        self.assertEqual(len(rows(self.out / "profile.csv")), 3 * 101)
        again = run(["resume", self.out])
        self.assertIn("finished", again)
        sets = {"cell.speeds": "[2.0, 400.0]", "start": 0.64}
        out = self.out.with_name("failed")
        failed = self.run_scene("shear-cell-continuum", sets, out, expect=1)
        self.assertIn("did not converge from a uniform solid fraction of 0.6400", failed)
        self.assertIn("2 problems have no solution", failed)
        # A problem without a solution is tried again, and is reported.
        again = run(["run", *words("shear-cell-continuum", sets), "--out", out, "--continue"], expect=1)
        self.assertEqual(*([line for line in text.splitlines() if not line.endswith(" so far")] for text in (again, failed)))

    def test_grains_run_in_one_process(self):
        said = run(["run", *words("granular-disks", {}), "--out", self.out], ranks=2, expect=1)
        self.assertIn("start this one without mpirun", said)
        self.assertFalse((self.out / "scene.toml").exists())
