"""Simulations: agreement with results of the program, callbacks, forces, and folders."""

import subprocess
import sys
import textwrap

import fcm_solve as fcm
import h5py
import numpy as np
import pytest

# Wall times differ from run to run.
TIMES = {"observables/seconds_per_step"}


def numbers_of(path):
    """All datasets of a file of results, by name."""
    found = {}

    def keep(name, item):
        is_kept = not name.startswith("parameters") and name.rpartition("/")[0] not in TIMES
        if isinstance(item, h5py.Dataset) and is_kept:
            found[name] = item[()]

    with h5py.File(path, "r") as file:
        file.visititems(keep)
    return found


def same_numbers(one, other):
    assert one.keys() == other.keys() and len(one) > 5
    for name, numbers in one.items():
        assert np.array_equal(numbers, other[name], equal_nan=numbers.dtype.kind == "f"), name


def test_results_are_the_program_s_to_the_bit(program, scenes, tmp_path):
    path = scenes / "pair-settling.toml"
    program("run", path, "--out", tmp_path / "program", "--set", "time.steps=12")
    with fcm.Simulation(fcm.Scene.load(path).set("time.steps", 12), out=tmp_path / "python") as simulation:
        simulation.run()
    for name in ("trajectory.h5", "observables.h5"):
        same_numbers(numbers_of(tmp_path / "program" / name), numbers_of(tmp_path / "python" / name))
    checkpoint = "checkpoint-0000000012.bin"
    names = sorted(file.name for file in (tmp_path / "python").iterdir() if not file.name.startswith("."))
    assert names == sorted(file.name for file in (tmp_path / "program").iterdir() if not file.name.startswith("."))
    assert (tmp_path / "python" / checkpoint).read_bytes() == (tmp_path / "program" / checkpoint).read_bytes()


GRAINS = {
    "granular-disks": {"box.edges": [30.0, 30.0], "time.strain": 0.05, "preparation.elastic_until": 21.0},
    "shear-cell": {"grains.solid_fraction": 0.05, "time.steps": 3, "time.transient": 1e-3, "output.trajectory_every": 1},
}


@pytest.mark.parametrize("kind", GRAINS)
def test_grains_are_the_program_s_too(program, tmp_path, kind):
    scene = fcm.Scene.new(kind).set(GRAINS[kind])
    (tmp_path / "scene.toml").write_text(scene.to_toml())
    program("run", tmp_path / "scene.toml", "--out", tmp_path / "program")
    with fcm.Simulation(scene, out=tmp_path / "python") as simulation:
        assert simulation.step == 0 and simulation.positions.shape == (len(simulation.radii), 3)
        simulation.step()
        assert simulation.observables and simulation.velocities.shape == simulation.positions.shape
        simulation.run()
        with pytest.raises(fcm.Error, match="supported for suspensions only"):
            simulation.force(lambda x, t: x)
        with pytest.raises(fcm.Error, match="scenes of this kind have no smallest_gap"):
            simulation.smallest_gap  # noqa: B018
    for name in ("trajectory.h5", "observables.h5", "averages.h5"):
        if (tmp_path / "program" / name).exists():
            same_numbers(numbers_of(tmp_path / "program" / name), numbers_of(tmp_path / "python" / name))


def test_whole_scenes_are_carried_out(tmp_path):
    scene = fcm.Scene.new("shear-cell-continuum").set({"cell.speeds": [1.0], "output.points": 11})
    with fcm.Simulation(scene, out=tmp_path) as simulation:
        for refused in (lambda: simulation.step(), lambda: simulation.run(steps=3), lambda: simulation.positions):
            with pytest.raises(fcm.Error, match="scenes of this kind have no steps"):
                refused()
        simulation.run()
    assert len(fcm.open(tmp_path).statistics["summary"]) >= 1


def test_steps_are_counted_and_called(pair, tmp_path):
    seen = []
    with fcm.Simulation(pair, out=tmp_path) as simulation:

        @simulation.every(3)
        def watch(s):
            seen.append(s.step)
            assert f"{s.step}" == str(int(s.step)) and s.smallest_gap > 0.9

        simulation.step()
        assert simulation.step == 1 and simulation.time == 0.1
        simulation.step(2)
        simulation.run(time=0.2)
        assert (simulation.step, simulation.time) == (5, 5 * 0.1)
        simulation.run()
        assert (simulation.step, simulation.end) == (8, 8)
        simulation.run(steps=3)
        assert (simulation.step, simulation.end) == (11, 11)
        with pytest.raises(ValueError, match="steps and time are given"):
            simulation.run(steps=1, time=1.0)
        with pytest.raises(ValueError, match="steps is 0.5"):
            simulation.run(steps=0.5)
    assert seen == [0, 3, 6, 9]
    assert list(fcm.open(tmp_path).trajectory.steps) == list(range(12))
    assert fcm.open(tmp_path).scene.to_toml().count("steps = 11") == 1
    with pytest.raises(fcm.Error, match="this simulation is closed"):
        simulation.run(steps=1)
    assert simulation.step == 11


def test_a_longer_run_has_the_bits_of_one_that_was_always_so_long(pair, tmp_path):
    with fcm.Simulation(pair, out=tmp_path / "extended") as simulation:
        simulation.run()
        for _ in range(4):
            simulation.step()
    with fcm.Simulation(fcm.Scene.from_dict(pair).set("time.steps", 12), out=tmp_path / "long") as simulation:
        simulation.run()
    for name in ("trajectory.h5", "observables.h5"):
        same_numbers(numbers_of(tmp_path / "extended" / name), numbers_of(tmp_path / "long" / name))


def test_the_state_is_that_of_the_trajectory(pair, tmp_path):
    with fcm.Simulation(pair, out=tmp_path) as simulation:
        simulation.run(steps=3)
        frame = fcm.open(tmp_path).trajectory[3]
        assert np.array_equal(simulation.positions, frame.positions)
        assert np.array_equal(simulation.velocities, frame.velocities)
        assert np.array_equal(simulation.angular_velocities, frame.angular_velocities)
        assert np.array_equal(simulation.stresslets, frame.stresslets)
        assert np.array_equal(simulation.unwrapped_positions, frame.unwrapped_positions)
        assert (simulation.radii.tolist(), simulation.species.tolist()) == ([1.0, 1.0], [0, 0])
        observables = simulation.observables
        assert observables["mean_velocity"].shape == (1, 3)
        assert np.allclose(observables["mean_velocity"][0], simulation.velocities.mean(axis=0))
        gap = np.linalg.norm(simulation.positions[0] - simulation.positions[1]) - 2
        assert simulation.smallest_gap == pytest.approx(gap, rel=1e-12)


def test_nothing_is_written_without_a_folder(pair, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with fcm.Simulation(pair) as simulation:
        simulation.run(steps=2)
    assert simulation.step == 2 and list(tmp_path.iterdir()) == []


def test_folders_are_held_and_runs_kept(pair, tmp_path):
    with fcm.Simulation(pair, out=tmp_path) as simulation:
        simulation.step()
        with pytest.raises(fcm.Error, match="another run is writing to"):
            fcm.Simulation(pair, out=tmp_path, force=True)
    with pytest.raises(fcm.Error, match="already holds the results of a run"):
        fcm.Simulation(pair, out=tmp_path)
    with fcm.Simulation(pair, out=tmp_path, force=True) as simulation:
        assert simulation.step == 0
    with pytest.raises(fcm.Error, match="holds no run to go on with"):
        fcm.Simulation.resume(tmp_path / "elsewhere")


def gravity(positions, time):
    return np.tile([0.0, 0.0, -18.85], (len(positions), 1))


def test_a_force_of_one_s_own_is_like_that_of_the_scene(pair):
    weightless = pair | {"species": [{"radius": 1.0, "count": 2}], "hydrodynamics": {"tolerance": 1e-6}}
    heavy = weightless | {"species": pair["species"]}
    with fcm.Simulation(heavy) as expected, fcm.Simulation(weightless) as found:
        found.force(gravity)
        for simulation in (expected, found):
            simulation.run(steps=3)
        assert np.allclose(found.positions, expected.positions, rtol=0, atol=1e-6)
        assert np.allclose(found.velocities, expected.velocities, rtol=1e-5)
        assert expected.positions[0, 2] < 11.8


def test_torques_turn(pair):
    still = pair | {"species": [{"radius": 1.0, "count": 2}]}
    with fcm.Simulation(still) as simulation:

        @simulation.torque
        def turned(positions, time):
            return [[0, 0, 8 * np.pi * (1 + time)]] * 2

        first = simulation.angular_velocities[:, 2]
        assert np.allclose(first, 1.0, atol=0.05)
        simulation.run(steps=2)
        assert np.allclose(simulation.angular_velocities[:, 2], 1.2 * first, rtol=0.02)


def test_what_a_function_raises_reaches_the_caller(pair, tmp_path):
    class Broken(RuntimeError):
        pass

    with fcm.Simulation(pair, out=tmp_path) as simulation:

        @simulation.force
        def spring(positions, time):
            if time > 0.15:
                raise Broken("the spring broke")
            return np.zeros((2, 3))

        with pytest.raises(Broken, match="the spring broke"):
            simulation.run()
        assert simulation.step == 1
        with pytest.raises(fcm.Error, match="it is in the midst of a computation"):
            simulation.force(lambda positions, time: simulation.positions)
        with pytest.raises(ValueError, match=r"the force of <lambda> has the shape \(3,\); it needs to be \(2, 3\)"):
            simulation.force(lambda positions, time: [1.0, 2.0, 3.0])
    with fcm.Simulation.resume(tmp_path) as simulation:
        assert simulation.step == 1


def test_resumed_runs_have_the_bits_of_whole_ones(pair, tmp_path):
    def springs(positions, time):
        return -3.0 * (1 + time) * (positions - [8.0, 8.0, 12.0])

    def started(folder):
        simulation = fcm.Simulation(pair, out=tmp_path / folder)
        simulation.force(springs)
        return simulation

    with started("whole") as simulation:
        simulation.run()
    with started("parts") as simulation:
        simulation.run(steps=5)
    with fcm.Simulation.resume(tmp_path / "parts") as simulation:
        simulation.force(springs)
        simulation.run()
    for name in ("trajectory.h5", "observables.h5"):
        same_numbers(numbers_of(tmp_path / "whole" / name), numbers_of(tmp_path / "parts" / name))


def test_ctrl_c_leaves_a_checkpoint(pair, tmp_path):
    script = """
        import fcm_solve as fcm, sys
        try:
            with fcm.Simulation(fcm.Scene.load("scene.toml"), out="out") as simulation:
                simulation.every(2)(lambda s: print(s.step, flush=True))
                simulation.run()
        except KeyboardInterrupt:
            print("stopped", simulation.step, flush=True)
    """
    (tmp_path / "scene.toml").write_text(fcm.Scene.from_dict(pair).set("time.steps", 1_000_000).to_toml())
    command = [sys.executable, "-c", textwrap.dedent(script)]
    child = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "0\n" and child.stdout.readline() == "2\n"
    child.send_signal(2)
    said = child.communicate(timeout=60)[0].splitlines()[-1]
    step = int(said.removeprefix("stopped "))
    assert child.returncode == 0 and 2 <= step < 1_000_000
    assert (tmp_path / "out" / f"checkpoint-{step:010}.bin").exists()
    with fcm.Simulation.resume(tmp_path / "out") as simulation:
        assert simulation.step == step
