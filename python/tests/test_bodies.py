"""Rigid bodies in scenes."""

import fcm_solve as fcm
import numpy as np


def test_bodies_stay_rigid_and_are_numbered(pair, tmp_path):
    bodies = [{"shape": "doublet", "radius": 0.5, "positions": [[1.5, 1.5, 1.5]], "force": [0.0, 0.0, -3.0]}]
    with fcm.Simulation(pair | {"bodies": bodies}) as simulation:
        assert simulation.bodies.tolist() == [-1, -1, 0, 0]
        simulation.run(steps=2)
        positions = simulation.unwrapped_positions
        assert abs(np.linalg.norm(positions[2] - positions[3]) - 1.0) < 1e-12
        assert (simulation.orientations[2] == simulation.orientations[3]).all()
