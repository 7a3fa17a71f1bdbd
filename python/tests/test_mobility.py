"""The mobility, compared with the answers of the program and with general properties of mobilities."""

import json

import fcm_solve as fcm
import numpy as np
import pytest

BOX = (12.0, 11.0, 13.0)
RADII = [1.0, 1.2, 0.8, 1.0, 0.9]
POSITIONS = [[2.0, 2.0, 2.0], [6.0, 2.5, 3.0], [3.0, 7.0, 4.0], [9.0, 8.0, 9.0], [5.0, 5.0, 10.0]]
rng = np.random.default_rng(5)
FORCES, TORQUES, STRESSLETS = rng.normal(size=(5, 3)), rng.normal(size=(5, 3)), rng.normal(size=(5, 5))
GRADIENT = [[0.0, 0.5, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]


def mobility(**more):
    made = fcm.Mobility(box=BOX, radii=RADII, viscosity=2.0, **more)
    made.positions = POSITIONS
    return made


def asked(program, tmp_path, tolerance, **more):
    case = {"box": BOX, "radii": RADII, "viscosity": 2.0, "positions": POSITIONS, **more}
    path = tmp_path / "case.json"
    path.write_text(json.dumps(case))
    return json.loads(program("mobility", path, "--tolerance", tolerance))


@pytest.mark.parametrize("more", [{}, {"lubrication": True}, {"strain": 0.2}])
def test_rigid_spheres_are_those_of_the_program(program, tmp_path, more):
    case = {"forces": FORCES.tolist(), "torques": TORQUES.tolist(), "background": {"velocity_gradient": GRADIENT}}
    answer = asked(program, tmp_path, 1e-4, **case, **more)
    motion = mobility(tolerance=1e-4, **more)(FORCES, TORQUES, background=GRADIENT)
    for name in ("velocities", "angular_velocities", "stresslets", "strain_rates"):
        assert np.array_equal(getattr(motion, name), answer[name]), name
    assert (motion.iterations, motion.residual) == (answer["iterations"], answer["residual"])


def test_lattice_vectors_are_a_box(program, tmp_path):
    x, y, z = np.diag(BOX)
    for vectors in ([y, z + y, x], [x, y + x, z - y]):
        check_lattice(program, tmp_path, vectors)


def check_lattice(program, tmp_path, vectors):
    answer = asked(program, tmp_path, 1e-4, box=np.array(vectors).tolist(), forces=FORCES.tolist())
    made = fcm.Mobility(box=vectors, radii=RADII, viscosity=2.0, tolerance=1e-4)
    made.positions = POSITIONS
    assert np.array_equal(made(FORCES).velocities, answer["velocities"])
    upright = mobility(tolerance=1e-4)(FORCES).velocities
    assert np.linalg.norm(answer["velocities"] - upright) < 1e-4 * np.linalg.norm(upright)


@pytest.mark.parametrize("boundaries", [("periodic", "walls", "periodic"), ("open", "open", "open")])
def test_walls_and_open_space_are_those_of_the_program(program, tmp_path, boundaries):
    answer = asked(program, tmp_path, 1e-3, forces=FORCES.tolist(), boundaries=boundaries)
    assert np.array_equal(mobility(boundaries=boundaries)(FORCES).velocities, answer["velocities"])


def test_a_pressure_gradient_drives_spheres_between_walls(program, tmp_path):
    boundaries, gradient = ("periodic", "periodic", "walls"), [-0.1, 0.02, 0.0]
    answer = asked(program, tmp_path, 1e-3, boundaries=boundaries, background={"pressure_gradient": gradient})
    between = mobility(boundaries=boundaries)
    driven = between(pressure_gradient=gradient)
    assert np.array_equal(driven.velocities, answer["velocities"])
    # The next call has no pressure gradient.
    assert not np.any(between().velocities)
    with pytest.raises(ValueError, match="between two walls"):
        mobility(boundaries=("periodic", "periodic", "wall"))(pressure_gradient=gradient)


def test_noise_is_that_of_the_program_and_has_the_covariance_of_the_mobility(program, tmp_path):
    answer = asked(program, tmp_path, 1e-3, noise={"draws": 3, "seed": 8}, lubrication=True)
    made = mobility(lubrication=True)
    noise = made.noise(3, 8)
    assert np.array_equal(noise.velocities, answer["noise_velocities"])
    assert np.array_equal(noise.angular_velocities, answer["noise_angular_velocities"])
    assert np.array_equal(made.noise(1, 8, first=2).velocities[0], noise.velocities[2])
    drawn = made.noise(400, 1).velocities.reshape(400, -1)
    matrix = made.linear_operator("forces", "velocities") @ np.eye(15)
    white = np.linalg.solve(np.linalg.cholesky(0.5 * (matrix + matrix.T)), drawn.T)
    assert abs(np.mean(white**2) - 1) < 4 * np.sqrt(2 / white.size)
    with pytest.raises(ValueError, match="draws is 0"):
        made.noise(0, 1)


@pytest.mark.parametrize(
    "more", [{"lubrication": True}, {"multipoles": "monopole"}, {"boundaries": ("periodic", "periodic", "walls")}]
)
def test_the_square_root_times_its_transpose_is_the_mobility(more):
    made = mobility(tolerance=1e-3 if "boundaries" in more else 1e-5, **more)
    root = made.square_root()
    found, transposed = matrix(root), matrix(root.T)
    kinds = [("forces", "velocities"), ("torques", "angular_velocities")][: len(found) // 15]
    dense = np.block([[matrix(made.linear_operator(loads, motions)) for loads, _ in kinds] for _, motions in kinds])
    assert np.abs(found @ found.T - dense).max() < 4 * made.plan.tolerance * np.abs(dense).max()
    assert np.abs(found.T - transposed).max() < 4 * made.plan.tolerance * np.abs(found).max()


def test_the_square_root_needs_numbers_and_places():
    with pytest.raises(ValueError, match="numbers contains nan"):
        mobility().square_root() @ np.full(30, np.nan)
    with pytest.raises(ValueError, match="no positions yet"):
        fcm.Mobility(box=BOX, radii=1.0, count=2, viscosity=1.0).square_root() @ np.zeros(12)


def test_the_drift_is_that_of_the_program(program, tmp_path):
    answer = asked(program, tmp_path, 1e-3, noise={"draws": 2, "seed": 8, "drift": True}, lubrication=True)
    drift = mobility(lubrication=True).drift(2, 8)
    for name in ("velocities", "angular_velocities", "stresslets"):
        assert np.array_equal(getattr(drift, name), answer[f"drift_{name}"]), name
    with pytest.raises(fcm.Error, match="fewer draws at a time"):
        mobility().noise(2**50, 8)
    with pytest.raises(ValueError, match="only rigid spheres drift"):
        mobility(rigid=False).drift(1, 8)


def test_spheres_that_are_not_rigid_and_points_are_those_of_the_program(program, tmp_path):
    answer = asked(program, tmp_path, 1e-3, rigid=False, stresslets=STRESSLETS.tolist())
    assert np.array_equal(mobility(rigid=False)(stresslets=STRESSLETS).strain_rates, answer["strain_rates"])
    answer = asked(program, tmp_path, 1e-3, multipoles="monopole", forces=FORCES.tolist())
    assert np.array_equal(mobility(multipoles="monopole")(FORCES).velocities, answer["velocities"])


def test_arguments_are_any_arrays_of_numbers():
    expected = mobility()(FORCES).velocities
    transposed = np.asfortranarray(FORCES)
    for forces in (FORCES.tolist(), transposed, np.repeat(FORCES, 2, axis=0)[::2]):
        assert np.array_equal(mobility()(forces).velocities, expected)
    single = mobility()(FORCES.astype(np.float32)).velocities
    assert np.allclose(single, expected, rtol=1e-5) and not np.array_equal(single, expected)


def test_positions_are_a_copy():
    places = np.array(POSITIONS)
    made = mobility()
    made.positions = places
    places[0, 0] = 5.0
    assert np.array_equal(made.positions, POSITIONS)
    with pytest.raises(ValueError, match="read-only"):
        made.positions[0, 0] = 5.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"forces": FORCES[:4]}, r"forces has the shape \(4, 3\); it needs to be \(5, 3\)"),
        ({"torques": FORCES[:, :2]}, r"torques has the shape \(5, 2\); it needs to be \(5, 3\)"),
        ({"forces": FORCES * np.nan}, "forces contains nan; every number needs to be finite"),
        ({"background": np.eye(3)}, "trace"),
        ({"stresslets": STRESSLETS}, "rigid particles have their own; set rigid to false"),
    ],
)
def test_bad_loads_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        mobility()(**arguments)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"viscosity": -1.0}, "viscosity"),
        ({"tolerance": 2.0}, "tolerance"),
        ({"box": (1.0, 2.0)}, r"box has the shape \(2,\); it needs to be \(3,\)"),
        ({"box": (1.0, 2.0, -3.0)}, "box edge z is -3"),
        ({"box": np.eye(3), "strain": 0.1}, "strain is for a box of three edges"),
        ({"box": [[9, 0, 0], [1, 9, 0], [1, 1, -9]]}, "right-handed"),
        ({"radii": 1.0}, "a number with count=N"),
        ({"radii": [1.0, -1.0]}, "radius|radii"),
        ({"multipoles": "quadrupole"}, "monopole"),
        ({"lubrication": True, "rigid": False}, "lubrication is for rigid particles"),
        ({"threads": 0}, "threads is 0"),
    ],
)
def test_bad_parameters_are_refused(more, message):
    with pytest.raises(ValueError, match=message):
        fcm.Mobility(**{"box": BOX, "radii": RADII, "viscosity": 1.0, **more})


def test_what_lacks_positions_or_overlaps_is_said():
    made = fcm.Mobility(box=BOX, radii=1.0, count=2, viscosity=1.0)
    with pytest.raises(ValueError, match="no positions yet"):
        made()
    with pytest.raises(ValueError, match=r"positions has the shape \(3,\); it needs to be \(2, 3\)"):
        made.positions = [1.0, 2.0, 3.0]
    close = [[2.0, 2.0, 2.0], [3.0, 2.0, 2.0]]
    with pytest.warns(fcm.Caution, match="overlap"):
        made.positions = close
    with pytest.raises(fcm.Error, match="move these apart, or leave out lubrication"):
        fcm.Mobility(box=BOX, radii=[1.0, 1.0], viscosity=1.0, lubrication=True).positions = close


def test_the_plan_is_that_of_the_program(program, tmp_path):
    answer = asked(program, tmp_path, 1e-4)
    plan = mobility(tolerance=1e-4).plan
    assert plan.text == answer["plan"] and str(plan).startswith(plan.text)
    assert plan.method in ("direct", "split") and len(plan.grid) == 3
    assert plan.tolerance == 1e-4 and 0 < plan.expected_error <= 1e-4 and plan.expected_seconds > 0
    for method in ("direct", "split"):
        assert mobility(method=method).plan.method == method
    with pytest.raises(fcm.InputError, match='"auto", "direct", "split" or "dense"'):
        mobility(method="spectral")


def test_the_far_field_is_on_a_card_or_there_is_none():
    try:
        assert "\ndevice     gpu\n" in mobility(device="gpu").plan.text
    except fcm.InputError as error:
        assert 'hydrodynamics.device is "gpu", but' in str(error)


def test_the_number_of_threads_stays():
    mobility()
    with pytest.raises(fcm.InputError, match="compute already; their number is that of the first use"):
        mobility(threads=1000)


def matrix(operator):
    return operator @ np.eye(operator.shape[1])


@pytest.mark.parametrize(
    ("rigid", "loads", "motions"),
    [
        (True, "forces", "velocities"),
        (True, "torques", "angular_velocities"),
        (True, "forces", "angular_velocities"),
        (True, "torques", "velocities"),
        (False, "forces", "strain_rates"),
        (False, "stresslets", "velocities"),
        (False, "stresslets", "strain_rates"),
    ],
)
def test_operators_have_their_transposes(rigid, loads, motions):
    operator = mobility(tolerance=1e-6, rigid=rigid).linear_operator(loads, motions)
    found, transposed = matrix(operator), matrix(operator.T)
    assert np.abs(found).max() > 1e-4
    assert np.allclose(transposed, found.T, atol=1e-6 * np.abs(found).max())


def test_operators_apply_the_mobility():
    made = mobility()
    motion = made(forces=FORCES)
    for motions in ("velocities", "angular_velocities", "stresslets"):
        operator = made.linear_operator("forces", motions)
        assert np.array_equal(operator @ FORCES.ravel(), getattr(motion, motions).ravel())
    with pytest.raises(NotImplementedError, match="no transpose"):
        made.linear_operator("forces", "stresslets").T @ np.zeros(25)
    with pytest.raises(ValueError, match="loads is 'force'; it needs to be one of forces, torques, stresslets"):
        made.linear_operator("force", "velocities")


def swimmer(axis, **more):
    """The motion of one swimmer along an axis in a cubic box, with velocity 0.9 and a stresslet."""
    made = fcm.Mobility(box=(8.0, 8.0, 8.0), radii=[1.2], viscosity=0.7, tolerance=1e-5, swimming=True, **more)
    made.positions = [[1.0, 7.0, 3.0]]
    x, y, z = axis
    nematic = np.array([[x * x - 1 / 3, x * y, x * z, y * y - 1 / 3, y * z]])
    return made, made(swimming_velocities=0.9 * np.array([axis]), active_stresslets=5.0 * nematic)


def test_a_swimmer_in_a_cubic_box_loses_the_volume_fraction():
    axis = np.array([0.48, -0.6, 0.64])
    made, motion = swimmer(axis)
    exact = 0.9 * (1 - 4 / 3 * np.pi * 1.2**3 / 512) * axis
    assert np.linalg.norm(motion.velocities[0] - exact) < 1e-4
    # Without the arguments it does not swim any more.
    assert not made().velocities.any()


def test_swimmers_move_as_those_of_a_run():
    scene = {
        "seed": 3,
        "box": {"edges": [9.0, 9.0, 9.0]},
        "fluid": {"viscosity": 0.7},
        "repulsion": {"strength": 0.0},
        "hydrodynamics": {"tolerance": 1e-3, "iteration_tolerance": 1e-8, "lubrication": True},
        "time": {"step": 0.1, "steps": 1},
        "species": [{"radius": 1.0, "count": 12, "swimming": {"speed": 0.9, "beta": -2.0}}],
    }
    with fcm.Simulation(scene) as sim:
        positions, axes, velocities = sim.positions, sim.axes, sim.velocities
    made = fcm.Mobility(box=(9.0,) * 3, radii=1.0, count=12, viscosity=0.7, tolerance=1e-3, lubrication=True, swimming=True)
    made.positions = positions
    x, y, z = axes.T
    # 4 pi mu a^2 B2, with B2 = -2 B1 and 2/3 B1 = 0.9.
    strength = 4 * np.pi * 0.7 * -2.0 * 1.5 * 0.9
    stresslets = strength * np.column_stack([x * x - 1 / 3, x * y, x * z, y * y - 1 / 3, y * z])
    motion = made(swimming_velocities=0.9 * axes, active_stresslets=stresslets)
    assert np.linalg.norm(motion.velocities - velocities) < 2e-3 * np.linalg.norm(velocities)


def test_slip_needs_a_mobility_that_swims():
    with pytest.raises(fcm.InputError, match="set it to true"):
        mobility()(swimming_velocities=FORCES)
    with pytest.raises(fcm.InputError, match="rigid spheres with dipoles"):
        fcm.Mobility(box=BOX, radii=RADII, viscosity=2.0, swimming=True, rigid=False)
