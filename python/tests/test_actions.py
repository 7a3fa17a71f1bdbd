"""Actions and their triggers, loggers and writers."""

import csv

import fcm_solve as fcm
import h5py
import numpy as np
import pytest


class Counter(fcm.Action):
    """Counts the calls of each kind."""

    def __init__(self):
        self.steps, self.attached, self.detached = [], 0, 0

    def attach(self, simulation):
        self.attached += 1

    def act(self, simulation):
        self.steps.append(int(simulation.step))

    def detach(self, simulation):
        self.detached += 1


def distance(simulation):
    return np.linalg.norm(simulation.positions[0] - simulation.positions[1])


@pytest.mark.parametrize(
    ("trigger", "expected"),
    [
        ({"every": 3}, [0, 3, 6]),
        ({"every_time": 0.25}, [0, 3, 5, 8]),
        ({"every_time": 0.3}, [0, 3, 6]),
        ({"every_time": 0.01}, list(range(9))),
        ({"at": 4}, [4]),
        ({"at": [7, 2, 2, 99]}, [2, 7]),
        ({"at": np.arange(5, 7)}, [5, 6]),
        ({"when": lambda s: s.time > 0.55}, [6, 7, 8]),
    ],
)
def test_actions_are_carried_out_at_the_steps_of_their_trigger(pair, trigger, expected):
    with fcm.Simulation(pair) as simulation:
        counter = simulation.add(Counter(), **trigger)
        simulation.run(steps=3)
        simulation.run()
    assert counter.steps == expected


def test_times_are_met_without_round_off(pair):
    with fcm.Simulation(fcm.Scene.from_dict(pair).set({"time.step": 0.1, "time.steps": 40})) as simulation:
        counter = simulation.add(Counter(), every_time=0.7)
        trigger = simulation._actions._entries[0].trigger
        steps, step = [0], 0
        while (step := trigger.next_after(step, 0.1)) <= 7_000_000 and len(steps) < 50_000:
            steps.append(step)
        assert steps == list(range(0, 7 * len(steps), 7))
        simulation.run(steps=8)
    assert counter.steps == [0, 7]


def test_actions_come_and_go(pair):
    counter, other = Counter(), Counter()
    with fcm.Simulation(pair) as simulation:
        simulation.add(counter, every=2)
        simulation.add(counter, at=3)

        @simulation.every(4)
        def changes(s):
            if s.step == 4:
                s.add(other, every=1)
                s.remove(counter)
            if s.step == 8:
                s.remove(changes)

        assert simulation.actions == (counter, changes)
        simulation.run()
        assert simulation.actions == (other,)
        assert (counter.steps, counter.attached, counter.detached) == ([0, 2, 3, 4], 1, 1)
        assert (other.steps, other.attached, other.detached) == ([4, 5, 6, 7, 8], 1, 0)
        with pytest.raises(fcm.Error, match="is not an action of this simulation"):
            simulation.remove(counter)
        simulation.add(counter.act, at=9)
        simulation.remove(counter.act)
        simulation.run(steps=2)
    assert counter.steps == [0, 2, 3, 4] and other.detached == 1
    with pytest.raises(fcm.Error, match="this simulation is closed"):
        simulation.add(counter, every=1)


@pytest.mark.parametrize(
    ("trigger", "message"),
    [
        ({}, "an action has one trigger, of every, every_time, at, when; found none"),
        ({"every": 1, "at": 2}, "found every and at"),
        ({"every": 0}, "every is 0"),
        ({"every": 1.5}, "every is 1.5"),
        ({"every_time": -1.0}, "every_time is -1.0; it needs to be above 0"),
        ({"every_time": "1"}, "every_time has text"),
        ({"at": []}, "at has no steps"),
        ({"at": [1, -1]}, "a step of at is -1"),
        ({"when": True}, "when is True; it needs to be a function"),
    ],
)
def test_triggers_are_refused_by_name(pair, trigger, message):
    with fcm.Simulation(pair) as simulation:
        with pytest.raises(fcm.InputError, match=message):
            simulation.add(print, **trigger)
        with pytest.raises(fcm.InputError, match="3 is not an action"):
            simulation.add(3, every=1)
        assert simulation.actions == ()


def test_what_an_action_raises_ends_the_run_after_its_step(pair):
    with fcm.Simulation(pair) as simulation:

        @simulation.every(2)
        def broken(s):
            if s.step == 4:
                raise KeyError("no such thing")

        with pytest.raises(KeyError, match="no such thing"):
            simulation.run()
        assert simulation.step == 4
        simulation.run()
        assert simulation.step == 8


def test_a_run_that_ends_before_its_last_step_comes_back(pair, tmp_path):
    sheared = pair | {"flow": {"kind": "shear", "control": "stress", "stress": 1.0}}
    sheared["time"] = {"step": 0.05, "duration": 10.0, "strain": 0.3}
    with fcm.Simulation(sheared, out=tmp_path) as simulation:
        counter = simulation.add(Counter(), every=2)
        simulation.run()
        assert (simulation.step, simulation.end) == (7, 200)
        simulation.run()
        assert (simulation.step, counter.steps) == (7, [0, 2, 4, 6])
        assert fcm.open(tmp_path).answers["shear_rate"].verdict


def test_loggers_keep_quantities_as_arrays(pair):
    log = fcm.Logger().add("distance", distance, "length").add("smallest_gap").add("z", lambda s: s.positions[:, 2])
    with fcm.Simulation(pair) as simulation:
        simulation.add(log, every=4)
        simulation.run()
        assert log.steps.tolist() == [0, 4, 8] and len(log) == 3
        assert log.times.tolist() == [0.0, 0.4, 0.8]
        assert log.units == {"distance": "length", "smallest_gap": "length", "z": ""}
        assert log["z"].shape == (3, 2) and np.array_equal(log["z"][-1], simulation.positions[:, 2])
        assert np.allclose(log["distance"], log["smallest_gap"] + 2, rtol=1e-12)
        with pytest.raises(fcm.Error, match="mean can't be added: there are rows without it"):
            log.add("mean", distance)
        with pytest.raises(KeyError, match="there is no quantity mean; there are distance, smallest_gap, z"):
            log["mean"]
    table = log.to_pandas()
    assert list(table.columns) == ["step", "distance", "smallest_gap", "z[0]", "z[1]"]
    assert table.index.tolist() == [0.0, 0.4, 0.8] and table["z[1]"].tolist() == log["z"][:, 1].tolist()


def test_quantities_are_real_numbers_of_one_shape(pair):
    growing = fcm.Logger().add("growing", lambda s: np.zeros(int(s.step) + 1))
    with fcm.Simulation(pair) as simulation:
        simulation.add(growing, every=1)
        with pytest.raises(fcm.InputError, match=r"the quantity growing has the shape \(2,\); it was \(1,\)"):
            simulation.run()
        assert len(growing) == 1
        with pytest.raises(fcm.InputError, match="nowhere has no function, and the time series has none; it has mean_v"):
            simulation.add(fcm.Logger().add("nowhere"), every=1)
        simulation.remove(growing)
        simulation.add(fcm.Logger().add("words", lambda s: "many"), every=1)
        with pytest.raises(fcm.InputError, match="the quantity words is 'many'; it needs to be a number"):
            simulation.run()
    for wrong in ("step", "", "a/b", "a[0]", 3):
        with pytest.raises(fcm.InputError, match="the name of a quantity is"):
            fcm.Logger().add(wrong, distance)
    with pytest.raises(fcm.InputError, match="there is a quantity twice already"):
        fcm.Logger().add("twice", distance).add("twice", distance)
    with pytest.raises(fcm.InputError, match="the function of x is 3"):
        fcm.Logger().add("x", 3)


def writer(path, **more):
    return fcm.Writer(path, **more).add("distance", distance, "length").add("z", lambda s: s.positions[:, 2])


def rows_of(path):
    """Steps, times, distances and heights in a file written by `writer`."""
    if path.suffix == ".csv":
        with path.open(newline="") as file:
            header, *rows = csv.reader(file)
        assert header == ["step", "time", "distance", "z[0]", "z[1]"]
        table = np.array(rows, float)
        return table[:, 0].tolist(), table[:, 1].tolist(), table[:, 2].tolist(), table[:, 3:].tolist()
    with h5py.File(path, "r") as file:
        assert file["distance"].attrs["dimensions"] == "length" and file["time"].attrs["dimensions"] == "time"
        return tuple(file[name][:].tolist() for name in ("step", "time", "distance", "z"))


@pytest.mark.parametrize("suffix", [".csv", ".h5"])
def test_writers_write_what_loggers_keep(pair, tmp_path, suffix):
    path = tmp_path / f"own{suffix}"
    log = fcm.Logger().add("distance", distance).add("z", lambda s: s.positions[:, 2])
    with fcm.Simulation(pair) as simulation:
        simulation.add(log, every=3)
        simulation.add(writer(path), every=3)
        simulation.run(steps=4)
        assert rows_of(path)[0] == [0, 3]
        simulation.run()
    assert rows_of(path) == (log.steps.tolist(), log.times.tolist(), log["distance"].tolist(), log["z"].tolist())
    with fcm.Simulation(pair) as simulation:
        with pytest.raises(fcm.Error, match="exists already; take another file, or force=True to replace it"):
            simulation.add(writer(path), every=1)
        assert simulation.actions == ()
        simulation.add(writer(path, force=True), at=[1, 2])
        simulation.run()
    assert rows_of(path)[0] == [1, 2]


@pytest.mark.parametrize("suffix", [".csv", ".h5"])
def test_resumed_runs_go_on_with_their_file(pair, tmp_path, suffix):
    path, whole = tmp_path / f"own{suffix}", tmp_path / f"whole{suffix}"
    with fcm.Simulation(pair) as simulation:
        simulation.add(writer(whole), every=1)
        simulation.run()
    with fcm.Simulation(pair, out=tmp_path / "run") as simulation:
        simulation.add(out := writer(path), every=1)
        simulation.run(steps=5)
        simulation.remove(out)
        simulation.add(out, every=1)
        simulation.checkpoint()
        simulation.run(steps=2)
    # As if the run had been killed after the checkpoint of step 5, in the middle of a line.
    (tmp_path / "run" / "checkpoint-0000000007.bin").unlink()
    if suffix == ".csv":
        path.write_text(path.read_text() + "8,0.8,3")
    with fcm.Simulation.resume(tmp_path / "run") as simulation:
        assert simulation.step == 5
        with pytest.raises(fcm.Error, match="has the quantities distance, z, not distance; take another file"):
            simulation.add(fcm.Writer(path).add("distance", distance), every=1)
        simulation.add(writer(path), every=1)
        simulation.run()
    assert rows_of(path) == rows_of(whole)


def test_files_that_can_t_be_written_are_named(pair, tmp_path):
    with pytest.raises(fcm.InputError, match="own.txt has the suffix '.txt'; it needs to be one of .csv, .h5, .hdf5"):
        fcm.Writer("own.txt")
    with fcm.Simulation(pair) as simulation:
        for name in ("own.csv", "own.h5"):
            with pytest.raises(fcm.Error, match="can't write .*nowhere"):
                simulation.add(writer(tmp_path / "nowhere" / name), every=1)
        assert simulation.actions == ()


class Rank:
    """A communicator as the second rank sees it, to which the first one says this."""

    rank = 1

    def __init__(self, said):
        self._said = said

    def bcast(self, _):
        return self._said


def test_rows_and_errors_are_those_of_the_first_rank(pair, tmp_path):
    log = fcm.Logger().add("nothing", lambda s: np.zeros(0)[3])
    with fcm.Simulation(pair) as simulation:
        simulation._comm = Rank(None)
        simulation.add(log, every=1)
        simulation.add(writer(tmp_path / "own.csv"), every=1)
        simulation.run(steps=2)
        assert len(log) == 0 and not (tmp_path / "own.csv").exists()
        simulation._comm = Rank("the disk is full")
        with pytest.raises(fcm.Error, match="the disk is full"):
            simulation.run(steps=1)


def test_scenes_without_steps_take_no_actions(tmp_path):
    scene = fcm.Scene.new("shear-cell-continuum").set({"cell.speeds": [1.0], "output.points": 11})
    with fcm.Simulation(scene, out=tmp_path) as simulation:
        with pytest.raises(fcm.Error, match="scenes of this kind have no steps"):
            simulation.add(print, every=1)
