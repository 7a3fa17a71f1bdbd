"""The adapter with libMobility's names."""

import fcm_solve as fcm
import numpy as np
import pytest
from fcm_solve.libmobility import FCM

PLACES = np.array([[2.0, 3.0, 4.0], [5.0, 3.5, 3.0], [3.0, 7.0, 6.5]])
# Boundaries, the parameters of the box, and the equivalent arguments of `Mobility`.
FLUIDS = {
    "periodic": (("periodic",) * 3, {"Lx": 20.0, "Ly": 22.0, "Lz": 24.0}, ((20.0, 22.0, 24.0), ("periodic",) * 3)),
    "open": (("open",) * 3, {}, ((40.0,) * 3, ("open",) * 3)),
    "layer": (
        ("periodic", "periodic", "open"),
        {"Lx": 20.0, "Ly": 22.0, "zmin": 0.0, "zmax": 12.0},
        ((20.0, 22.0, 12.0), ("periodic", "periodic", "open")),
    ),
    "wall": (
        ("periodic", "periodic", "single_wall"),
        {"Lx": 20.0, "Ly": 22.0, "zmin": 0.0, "zmax": 12.0},
        ((20.0, 22.0, 12.0), ("periodic", "periodic", "wall")),
    ),
    "walls": (
        ("periodic", "periodic", "two_walls"),
        {"Lx": 20.0, "Ly": 22.0, "zmin": 0.0, "zmax": 12.0},
        ((20.0, 22.0, 12.0), ("periodic", "periodic", "walls")),
    ),
}


def solver(fluid, angular=True, **more):
    axes, parameters, _ = FLUIDS[fluid]
    made = FCM(*axes)
    made.setParameters(**parameters)
    made.initialize(viscosity=1.5, hydrodynamicRadius=1.2, includeAngular=angular, tolerance=1e-5, seed=3, **more)
    return made


def loads():
    random = np.random.default_rng(1)
    forces = random.standard_normal((3, 3))
    return forces - forces.mean(axis=0), random.standard_normal((3, 3))


def matrix(made, kinds):
    """The mobility, column by column."""
    columns = []
    for unit in np.eye(9 * kinds):
        motion = made.Mdot(*(unit.reshape(kinds, 3, 3)))
        columns.append(np.concatenate([part.ravel() for part in motion[:kinds]]))
    return np.array(columns).T


@pytest.mark.parametrize("fluid", FLUIDS)
@pytest.mark.parametrize("angular", [False, True])
def test_it_is_the_mobility_of_spheres_that_are_not_rigid(fluid, angular):
    _, _, (box, boundaries) = FLUIDS[fluid]
    kind = "dipole" if angular else "monopole"
    expected = fcm.Mobility(box, 1.2, 1.5, 1e-5, rigid=False, multipoles=kind, boundaries=boundaries, count=3)
    expected.positions = PLACES
    made, (forces, torques) = solver(fluid, angular), loads()
    made.setPositions(PLACES)
    motion = expected(forces=forces, torques=torques if angular else None)
    linear, turning = made.Mdot(forces, torques if angular else None)
    assert np.allclose(linear, motion.velocities, rtol=0, atol=2e-5)
    assert turning is None if not angular else np.allclose(turning, motion.angular_velocities, rtol=0, atol=2e-5)
    made.setPositions(PLACES.ravel())
    assert made.Mdot(forces.ravel())[0].shape == (9,) and made.Mdot(forces)[0].shape == (3, 3)


def test_heights_are_from_zmin_on():
    high = FCM("periodic", "periodic", "two_walls")
    high.setParameters(Lx=20.0, Ly=22.0, zmin=-7.0, zmax=5.0)
    high.initialize(viscosity=1.5, hydrodynamicRadius=1.2, tolerance=1e-5)
    high.setPositions(PLACES - [0, 0, 7.0])
    low, (forces, _) = solver("walls", False), loads()
    low.setPositions(PLACES)
    assert np.allclose(high.Mdot(forces)[0], low.Mdot(forces)[0], rtol=0, atol=1e-12)


@pytest.mark.parametrize(("fluid", "count"), [("periodic", 4000), ("wall", 1000)])
def test_random_motions_have_the_mobility_as_their_covariance(fluid, count):
    made = solver(fluid)
    made.setPositions(PLACES)
    draws = np.array([np.concatenate([part.ravel() for part in made.sqrtMdotW(2.0)]) for _ in range(count)])
    expected = 4 * matrix(made, 2)
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # Standard errors of 18 x 18 covariances are at most sqrt(2 / count) of the size.
    assert np.abs(draws.T @ draws / count - expected).max() < 4.5 * np.sqrt(2 / count) * size.max()


def test_the_divergence_is_that_of_finite_differences():
    made, step = solver("wall", False), 1e-3
    expected = np.zeros((3, 3))
    for sphere in range(3):
        for axis in range(3):
            unit = np.zeros((3, 3))
            unit[sphere, axis] = 1.0
            sides = []
            for sign in (1, -1):
                made.setPositions(PLACES + sign * step / 2 * unit)
                sides.append(made.Mdot(unit)[0])
            expected += (sides[0] - sides[1]) / step
    made.setPositions(PLACES)
    draws = np.array([made.divM()[0] for _ in range(1000)])
    error = draws.std(axis=0) / np.sqrt(len(draws))
    assert np.all(np.abs(draws.mean(axis=0) - expected) < 4.5 * error + 1e-4) and expected[:, 2].max() > 1e-3
    forces, _ = loads()
    before = made.Mdot(forces)[0]
    made.divM()
    assert np.array_equal(made.Mdot(forces)[0], before)
    periodic = solver("periodic")
    periodic.setPositions(PLACES)
    assert not np.any(periodic.divM()[0]) and not np.any(periodic.divM()[1])


def test_langevin_velocities_are_the_sum():
    forces, torques = loads()
    one, two = solver("walls"), solver("walls")
    for made in (one, two):
        made.setPositions(PLACES)
    found = one.LangevinVelocities(0.1, 0.7, forces, torques)
    parts = [two.Mdot(forces, torques), two.sqrtMdotW(np.sqrt(2 * 0.7 / 0.1)), two.divM(0.7)]
    for kind in (0, 1):
        assert np.allclose(found[kind], sum(part[kind] for part in parts), rtol=1e-9, atol=1e-12)
    assert np.allclose(one.LangevinVelocities(0.1, 0.0, forces)[0], two.Mdot(forces)[0], rtol=0, atol=1e-12)


def test_what_is_wrong_is_a_runtime_error():
    with pytest.raises(RuntimeError, match="the fluid is .* it can be one of"):
        FCM("open", "open", "single_wall")
    made, (forces, torques) = solver("periodic", False), loads()
    for call in (lambda: made.Mdot(forces), made.sqrtMdotW, made.divM, lambda: made.LangevinVelocities(1.0, 1.0)):
        with pytest.raises(RuntimeError, match="there are no positions"):
            call()
    for wrong in (np.zeros((4, 6)), np.zeros((3, 1)), np.zeros(4)):
        with pytest.raises(RuntimeError, match=r"it needs to be \(N, 3\) or \(3 N,\)"):
            made.setPositions(wrong)
    made.setPositions(PLACES)
    with pytest.raises(RuntimeError, match="there are 3 spheres; a force, or a torque, is needed for each"):
        made.Mdot(forces[:2])
    with pytest.raises(RuntimeError, match="initialize with includeAngular=True"):
        made.Mdot(forces, torques)
    walled = solver("walls")
    with pytest.raises(RuntimeError, match="wall"):
        walled.setPositions(PLACES - [0.0, 0.0, 5.0])
