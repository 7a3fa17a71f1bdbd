"""Orientations of spheres: state, snapshots, trajectories."""

import fcm_solve as fcm
import numpy as np
import pytest

ORIENTED = {"orientation": "aligned", "orientation_axis": [0.0, 0.0, 1.0], "torque": [0.0, 3.0, 0.0]}


def scene_of(pair):
    (species,) = pair["species"]
    return pair | {"species": [species | ORIENTED]}


def test_spheres_without_orientations_have_none(pair):
    with fcm.Simulation(pair) as simulation:
        with pytest.raises(fcm.Error, match="no orientation"):
            _ = simulation.orientations
        with pytest.raises(fcm.Error, match="no orientations"):
            _ = simulation.get_snapshot().orientations
        simulation.set_snapshot(simulation.get_snapshot())


def test_orientations_rotate_and_can_be_set(pair):
    with fcm.Simulation(scene_of(pair)) as simulation:
        assert np.array_equal(simulation.orientations, [[1.0, 0.0, 0.0, 0.0]] * 2)
        assert np.array_equal(simulation.axes, [[0.0, 0.0, 1.0]] * 2)
        simulation.run(steps=2)
        assert np.allclose(np.linalg.norm(simulation.orientations, axis=1), 1.0, atol=1e-14)
        assert (simulation.axes[:, 0] > 1e-4).all()
        assert simulation.observables["orientation"].shape == (1, 5)
        snapshot, before = simulation.get_snapshot(), simulation.orientations
        snapshot.orientations[0] = [0.0, 2.0, 0.0, 0.0]
        simulation.set_snapshot(snapshot)
        assert np.allclose(simulation.orientations[0], [0.0, 1.0, 0.0, 0.0], atol=1e-15)
        assert np.array_equal(simulation.orientations[1], before[1])
        snapshot.orientations = np.zeros((2, 4))
        with pytest.raises(fcm.Error, match="needs a quaternion"):
            simulation.set_snapshot(snapshot)


def test_trajectories_have_orientations(pair, tmp_path):
    folder = tmp_path / "run"
    with fcm.Simulation(scene_of(pair), out=folder) as simulation:
        simulation.run(steps=2)
        expected = simulation.orientations, simulation.axes
    frame = fcm.Run(folder).trajectory[-1]
    assert np.array_equal(frame.orientations, expected[0])
    assert np.array_equal(frame.axes, expected[1])
