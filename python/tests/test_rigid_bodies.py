"""Rigid bodies of a mobility: exact doublets, symmetry, and the answers of the program."""

import json

import fcm_solve as fcm
import numpy as np
import pytest

# Three spheres of a body, two of another, and a free one; the second body reaches beyond the box.
POSITIONS = [[2.0, 2.0, 2.0], [4.1, 2.0, 2.0], [2.0, 4.0, 2.5], [7.0, 11.5, 6.0], [7.0, 13.4, 6.0], [5.0, 8.0, 3.0]]
BODIES = [[0, 1, 2], [3, 4]]
NUMBERS = [0, 0, 0, 1, 1, -1]
RADII = [1.0, 1.0, 0.9, 1.0, 0.9, 1.0]
GRADIENT = [[0.0, 0.5, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


def mobility(bodies=BODIES, **more):
    made = fcm.Mobility((12.0, 12.0, 12.0), RADII, 1.0, lubrication=True, bodies=bodies, **more)
    made.positions = POSITIONS
    return made


def test_a_touching_doublet_has_the_exact_resistance():
    made = fcm.Mobility((5.0, 5.0, 5.0), 1.0, 1.0, 1e-4, True, count=2, boundaries=["open"] * 3, bodies=[[0, 1]])
    made.positions = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    found = np.diag(made.body_resistance())
    force, torque = 6 * np.pi, 8 * np.pi
    exact = [1.44932 * force] * 2 + [1.29028 * force] + [3.7401 * torque] * 2 + [1.80309 * torque]
    assert np.allclose(found, exact, rtol=1e-3)


def test_bodies_have_a_symmetric_positive_mobility_and_move_rigidly():
    made = mobility(tolerance=1e-4)
    matrix = made.body_mobility()
    assert np.abs(matrix - matrix.T).max() < 1e-4 * np.abs(matrix).max()
    assert np.linalg.eigvalsh(matrix + matrix.T).min() > 0
    motion = made(forces=np.ones((6, 3)), background=GRADIENT)
    flow = np.array(GRADIENT)
    for body, members in enumerate(BODIES):
        positions = np.array(POSITIONS)[members]
        arms = positions - positions.mean(axis=0)
        spin = motion.body_angular_velocities[body]
        assert np.allclose(motion.angular_velocities[members], spin, atol=1e-13)
        rigid = motion.body_velocities[body] + np.cross(spin, arms)
        strained = arms @ (flow + flow.T) / 2
        assert np.allclose(motion.velocities[members], rigid - strained, atol=1e-13)


def test_the_program_moves_the_same_bodies(program, tmp_path):
    forces = np.random.default_rng(2).normal(size=(6, 3))
    case = {"box": [12, 12, 12], "viscosity": 1, "positions": POSITIONS, "radii": RADII, "lubrication": True}
    path = tmp_path / "case.json"
    path.write_text(json.dumps({**case, "forces": forces.tolist(), "bodies": NUMBERS}))
    answer = json.loads(program("mobility", path, "--tolerance", 1e-3))
    for bodies in (BODIES, NUMBERS, np.array(NUMBERS)):
        motion = mobility(bodies)(forces)
        assert np.array_equal(motion.body_velocities, answer["body_velocities"])
        assert np.array_equal(motion.velocities, answer["velocities"])
    wrong = tmp_path / "wrong.json"
    wrong.write_text(json.dumps({**case, "bodies": [0, 0, 2, 2, -1, -1]}))
    with pytest.raises(AssertionError, match="number bodies from 0"):
        program("mobility", wrong)


def test_given_motions_take_the_loads_of_the_resistance():
    made = mobility(tolerance=1e-4)
    resistance = np.linalg.inv(made.body_mobility())
    motion = np.random.default_rng(5).normal(size=(2, 2, 3))
    driven = made(body_velocities=motion[:, 0], body_angular_velocities=motion[:, 1])
    loads = np.stack([driven.driving_forces, driven.driving_torques], axis=1).ravel()
    expected = resistance @ motion.ravel()
    assert np.allclose(loads, expected, atol=1e-3 * np.abs(expected).max())
    assert np.allclose(driven.body_velocities, motion[:, 0], atol=1e-12)
    free = np.where([[True, False, False], [False, False, False]], np.nan, motion[:, 0])
    some = made(body_velocities=free, body_torques=np.ones((2, 3)))
    assert some.driving_forces[0, 0] == pytest.approx(0.0, abs=1e-6)
    assert np.allclose(some.driving_torques, 0.0, atol=1e-6)
    assert np.allclose(some.body_velocities[1], motion[1, 0], atol=1e-12)
    assert made(forces=np.ones((6, 3))).driving_forces.size == 0
    with pytest.raises(ValueError, match="body_velocities has the shape"):
        made(body_velocities=motion[:1, 0])


def test_loads_on_bodies_are_those_on_any_of_their_spheres():
    made, forces = mobility(tolerance=1e-6), np.zeros((6, 3))
    forces[3] = [1.0, 2.0, 3.0]
    arm = np.array(POSITIONS[3]) - np.mean(POSITIONS[3:5], axis=0)
    load = [[0.0] * 3, forces[3]], [[0.0] * 3, np.cross(arm, forces[3])]
    one, other = made(forces), made(body_forces=load[0], body_torques=load[1])
    assert np.allclose(one.velocities, other.velocities, atol=1e-6)


@pytest.mark.parametrize(
    ("bodies", "more", "message"),
    [
        ([[0, 6]], {}, "the last of 6 spheres is 5"),
        ([[0, 1], [1, 2]], {}, "has the sphere 1 twice"),
        ([0, 0], {}, "one for each of 6 spheres"),
        ([0, 0, 2, 2, -1, -1], {}, "no spheres of body 1"),
        (BODIES, {"lubrication": False, "rigid": False}, "bodies are made of rigid spheres"),
    ],
)
def test_bodies_that_cannot_be_are_refused(bodies, more, message):
    with pytest.raises(ValueError, match=message):
        fcm.Mobility((12.0, 12.0, 12.0), RADII, 1.0, bodies=bodies, **more)
    with pytest.raises(ValueError, match="leave out bodies"):
        mobility().drift(1, 1)


def test_random_motions_of_bodies_are_rigid_and_have_the_covariance_of_their_mobility():
    made = mobility()
    noise = made.noise(200, 3)
    velocities = np.stack([noise.velocities[:, members].mean(axis=1) for members in BODIES], axis=1)
    spins = np.stack([noise.angular_velocities[:, members[0]] for members in BODIES], axis=1)
    for body, members in enumerate(BODIES):
        arms = np.array(POSITIONS)[members] - np.mean(np.array(POSITIONS)[members], axis=0)
        rigid = velocities[:, None, body] + np.cross(spins[:, None, body], arms)
        assert np.allclose(noise.velocities[:, members], rigid, atol=1e-12)
    matrix = made.body_mobility()
    drawn = np.stack([velocities, spins], axis=2).reshape(200, -1)
    white = np.linalg.solve(np.linalg.cholesky(0.5 * (matrix + matrix.T)), drawn.T)
    # The mean of 2,400 squares deviates by 3%.
    assert abs(np.mean(white**2) - 1) < 0.1
