"""Snapshots: taking, changing and setting them."""

import fcm_solve as fcm
import h5py
import numpy as np
import pytest

SHEAR = {"flow": {"kind": "shear", "rate": 0.5}}
# Scenes of spheres whose steps depend on their history in different ways.
KINDS = {
    "two-steps": {},
    "four-steps": {"time": {"step": 0.1, "steps": 8, "order": 4}},
    "adaptive": {"time": {"step": 0.1, "steps": 8, "integrator": "adaptive"}, "hydrodynamics": {"lubrication": True}},
    "sheared": SHEAR,
    "oscillating": {"flow": {"kind": "shear", "oscillation": {"amplitude": 0.1, "frequency": 3.0}}},
    "stress": {"flow": {"kind": "shear", "control": "stress", "stress": 1.0}, "time": {"step": 0.1, "duration": 0.8}},
    "brownian": {"fluid": {"viscosity": 1.0, "thermal_energy": 0.5}, "seed": 3},
    "contacts": {"contacts": {"friction": 0.5, "roughness": 0.1}, "hydrodynamics": {"lubrication": True}, **SHEAR},
}


def state_of(simulation):
    arrays = {name: getattr(simulation, name) for name in ("positions", "unwrapped_positions", "velocities", "lattice")}
    return arrays | {"time": simulation.time, "step": simulation.step}


def assert_same(one, other):
    for name, value in one.items():
        assert np.array_equal(value, other[name]), name


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_goes_on_from_a_snapshot_as_it_did(pair, kind):
    with fcm.Simulation(pair | KINDS[kind]) as simulation:
        simulation.run(steps=3)
        snapshot, then = simulation.get_snapshot(), state_of(simulation)
        assert (snapshot.step, snapshot.time) == (3, simulation.time)
        simulation.run(steps=4)
        end = state_of(simulation)
        for _ in range(2):
            simulation.set_snapshot(snapshot)
            assert_same(then, state_of(simulation))
            simulation.run(steps=4)
            assert_same(end, state_of(simulation))
    with fcm.Simulation(pair | KINDS[kind]) as another:
        another.set_snapshot(snapshot)
        another.run(steps=4)
        assert_same(end, state_of(another))


@pytest.mark.parametrize("kind", KINDS)
def test_spheres_go_on_from_where_they_are_put_as_from_a_start_there(pair, kind):
    scene = pair | KINDS[kind]
    moved = np.array([[6.0, 8.5, 12.0], [9.2, 8.0, 12.5]])
    with fcm.Simulation(scene) as simulation:
        before = simulation.get_snapshot()
        simulation.run(steps=3)
        snapshot = simulation.get_snapshot()
        snapshot.positions = moved
        simulation.set_snapshot(snapshot)
        assert np.allclose(simulation.positions, moved, rtol=0, atol=1e-14) and simulation.step == 3
        put = simulation.velocities
        simulation.run(steps=3)
        assert np.isfinite(simulation.positions).all() and np.abs(simulation.positions - moved).max() > 1e-3
        # At the start there is no history that could differ.
        before.positions[:] = moved
        simulation.set_snapshot(before)
        first = simulation.velocities
        simulation.run(steps=2)
        end = state_of(simulation)
    scene = scene | {"particles": {"initial": "positions", "positions": moved.tolist()}}
    with fcm.Simulation(scene) as expected:
        # The search for the rate under a given stress starts from the previous rate, and ends within the tolerance.
        tolerance = 2e-3 if kind == "stress" else 0.0
        assert np.allclose(first, expected.velocities, rtol=tolerance, atol=0)
        if kind in ("two-steps", "four-steps"):
            assert np.allclose(put, expected.velocities, rtol=1e-3)
        expected.run(steps=2)
        for name, value in state_of(expected).items():
            assert np.allclose(end[name], value, rtol=tolerance, atol=tolerance), name


@pytest.mark.parametrize("order", [2, 3, 4])
def test_what_came_before_a_change_has_no_part_in_what_comes_after(pair, order):
    """A single sphere settles at a constant velocity, so any trace of a dropped or missing history would be visible."""
    alone = pair | {"species": [{"radius": 1.0, "count": 1, "force": [0.0, 0.0, -18.85]}]}
    alone |= {"particles": {"initial": "positions", "positions": [[8.0, 8.0, 8.0]]}, "hydrodynamics": {"tolerance": 1e-9}}
    scene = fcm.Scene.from_dict(alone).set("time.order", order)
    for steps in (1, 2, 5):
        with fcm.Simulation(scene) as simulation:
            simulation.run(steps=steps)
            snapshot = simulation.get_snapshot()
            snapshot.positions[0] = [3.0, 4.0, 15.0]
            simulation.set_snapshot(snapshot)
            speed = simulation.velocities[0, 2]
            heights = [15.0]
            for _ in range(5):
                simulation.step()
                heights.append(simulation.unwrapped_positions[0, 2])
        assert np.allclose(np.diff(heights), 0.1 * speed, rtol=1e-7, atol=0)


def test_radii_can_be_changed(pair):
    with fcm.Simulation(pair) as simulation:
        simulation.run(steps=2)
        snapshot = simulation.get_snapshot()
        snapshot.radii[1] = 0.5
        simulation.set_snapshot(snapshot)
        assert simulation.radii.tolist() == [1.0, 0.5]
        velocities = simulation.velocities[:, 2]
        assert velocities[1] < 1.5 * velocities[0] < 0
        simulation.run()
        assert simulation.radii.tolist() == [1.0, 0.5]
        for wrong, message in ((-1.0, "the radius of particle 1 would be -1; it needs to be above 0"), (np.nan, "nan")):
            snapshot.radii[1] = wrong
            with pytest.raises(fcm.InputError, match=message):
                simulation.set_snapshot(snapshot)
        assert simulation.radii.tolist() == [1.0, 0.5] and simulation.step == 8


def test_forces_of_one_s_own_go_on_after_a_snapshot(pair):
    def spring(positions, time):
        return -3.0 * (1 + time) * (positions - [8.0, 8.0, 12.0])

    with fcm.Simulation(pair) as simulation:
        simulation.force(spring)
        simulation.run(steps=3)
        snapshot, then = simulation.get_snapshot(), state_of(simulation)
        simulation.run(steps=3)
        end = state_of(simulation)
        simulation.set_snapshot(snapshot)
        assert_same(then, state_of(simulation))
        simulation.run(steps=3)
        assert_same(end, state_of(simulation))
        snapshot.positions[:] += 0.25
        simulation.set_snapshot(snapshot)
        pulled = simulation.velocities
    with fcm.Simulation(pair | {"particles": {"initial": "positions", "positions": snapshot.positions.tolist()}}) as free:
        assert np.abs(free.velocities - pulled).max() > 0.1


def test_what_was_recorded_after_the_step_is_dropped(pair, tmp_path):
    with fcm.Simulation(pair, out=tmp_path / "whole") as simulation:
        simulation.run()
    with fcm.Simulation(pair, out=tmp_path / "back") as simulation:
        log = simulation.add(fcm.Logger().add("smallest_gap"), every=1)
        simulation.run(steps=3)
        snapshot = simulation.get_snapshot()
        simulation.run()
        assert fcm.open(tmp_path / "back").trajectory.steps.tolist() == list(range(9))
        simulation.set_snapshot(snapshot)
        assert fcm.open(tmp_path / "back").trajectory.steps.tolist() == [0, 1, 2, 3]
        names = sorted(path.name for path in (tmp_path / "back").glob("checkpoint-*"))
        assert names[-1] == "checkpoint-0000000003.bin"
        simulation.run(steps=2)
    with fcm.Simulation.resume(tmp_path / "back") as simulation:
        assert simulation.step == 5
        simulation.run()
    assert log.steps.tolist() == [0, 1, 2, 3, 4, 5]
    for name in ("particles/all/position/value", "particles/all/velocity/value", "particles/all/position/step"):
        with h5py.File(tmp_path / "whole" / "trajectory.h5") as one, h5py.File(tmp_path / "back" / "trajectory.h5") as two:
            assert np.array_equal(one[name][()], two[name][()])
    checkpoint = "checkpoint-0000000008.bin"
    assert (tmp_path / "whole" / checkpoint).read_bytes() == (tmp_path / "back" / checkpoint).read_bytes()


def test_spheres_in_stokes_flow_have_no_velocities_to_set(pair):
    with fcm.Simulation(pair) as simulation:
        snapshot = simulation.get_snapshot()
        for name in ("velocities", "angular_velocities"):
            with pytest.raises(fcm.Error, match="they follow from the positions, which can be set"):
                getattr(snapshot, name)
            with pytest.raises(fcm.Error, match="they follow from the positions, which can be set"):
                setattr(snapshot, name, np.zeros((2, 3)))
        with pytest.raises(fcm.InputError, match=r"positions has the shape \(3,\); it needs to be \(2, 3\)"):
            snapshot.positions = [1.0, 2.0, 3.0]
        snapshot.positions[1, 1] = np.inf
        with pytest.raises(fcm.InputError, match="positions contains inf"):
            simulation.set_snapshot(snapshot)
        assert np.isfinite(simulation.positions).all()


def disks():
    return fcm.Scene.new("granular-disks").set(
        {"box.edges": [30.0, 30.0], "time.strain": 0.05, "preparation.elastic_until": 21.0}
    )


def cell():
    return fcm.Scene.new("shear-cell").set({"grains.solid_fraction": 0.05, "time.steps": 6, "time.transient": 1e-3})


@pytest.mark.parametrize("scene", [disks, cell])
def test_grains_have_velocities_to_set(scene):
    with fcm.Simulation(scene()) as simulation:
        simulation.run(steps=2)
        snapshot, then = simulation.get_snapshot(), state_of(simulation)
        simulation.run(steps=2)
        end = state_of(simulation)
        simulation.set_snapshot(snapshot)
        assert_same(then, state_of(simulation))
        simulation.run(steps=2)
        assert_same(end, state_of(simulation))

        changed = simulation.get_snapshot()
        changed.velocities[0] = [0.01, -0.02, 0.0]
        simulation.set_snapshot(changed)
        expected = end["velocities"].copy()
        expected[0] = [0.01, -0.02, 0.0]
        assert np.array_equal(simulation.velocities, expected) and simulation.step == 4
        assert np.allclose(simulation.positions, end["positions"], rtol=0, atol=1e-12)
        simulation.run(steps=1)
        assert np.isfinite(simulation.positions).all()
        changed.radii = 1.5 * changed.radii
        with pytest.raises(fcm.InputError, match="radii of grains are those of the scene"):
            simulation.set_snapshot(changed)
        assert simulation._core.warnings() == []


def test_disks_stay_in_their_plane_and_do_not_turn():
    with fcm.Simulation(disks()) as simulation:
        snapshot = simulation.get_snapshot()
        with pytest.raises(fcm.Error, match="grains of this kind have no angular velocities"):
            snapshot.angular_velocities  # noqa: B018
        snapshot.velocities[3, 2] = 1.0
        with pytest.raises(fcm.InputError, match="disk 3 would leave the plane z = 0"):
            simulation.set_snapshot(snapshot)
        snapshot = simulation.get_snapshot()
        snapshot.positions[3] = snapshot.positions[4]
        with pytest.raises(fcm.InputError, match="of two disks; it needs a place of its own for each"):
            simulation.set_snapshot(snapshot)


def test_snapshots_of_others_are_refused(pair):
    with fcm.Simulation(pair) as simulation, fcm.Simulation(cell()) as grains:
        with pytest.raises(fcm.InputError, match="the snapshot is of a scene of another kind"):
            simulation.set_snapshot(grains.get_snapshot())
        alone = pair | {"species": [{"radius": 1.0, "count": 1}], "particles": {"initial": "random"}}
        with fcm.Simulation(alone) as other, pytest.raises(fcm.InputError, match="the snapshot has 1 particles; this .* has 2"):
            simulation.set_snapshot(other.get_snapshot())
    with pytest.raises(fcm.Error, match="this simulation is closed"):
        simulation.set_snapshot(simulation.get_snapshot())
