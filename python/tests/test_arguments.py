"""Arguments: any array-like is accepted, and unsuitable ones are refused by name."""

import datetime

import fcm_solve as fcm
import numpy as np
import pytest

BOX, RADII = (12.0, 12.0, 12.0), (1.0, 1.0)
PLACES = np.array([[3.0, 3.0, 3.0], [8.0, 8.0, 8.0]])
FORCES = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]])


class Measured(np.ndarray):
    """An array with a unit, like those of packages for units."""

    unit = "um"


def mobility(**more):
    made = fcm.Mobility(**{"box": BOX, "radii": RADII, "viscosity": 1.0, **more})
    made.positions = PLACES
    return made


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (FORCES + 0j, "has complex numbers"),
        ((FORCES + 1j).tolist(), "has complex numbers"),
        (FORCES > 0, "has true and false"),
        ([[True, 0.0, 0.0], [0.0, 0.0, 0.0]], "has true and false"),
        (np.ma.masked_less(FORCES, -0.5), "is a masked array"),
        (list(np.ma.masked_less(FORCES, -0.5)), "is a masked array"),
        (FORCES.astype(str), "has text"),
        (FORCES.astype(bytes), "has text"),
        (FORCES.astype(object), "has objects"),
        ([[None, 0.0, 0.0], [0.0, 0.0, 0.0]], "has objects"),
        (FORCES.astype("datetime64[s]"), "has dates"),
        (FORCES.astype("timedelta64[s]"), "has time spans"),
        (FORCES.view(Measured), "has a unit"),
        (np.full((2, 3), 2**53 + 1), "has whole numbers beyond 2\\^53"),
        ([[0.0, 0.0, 0.0], [0.0, 0.0]], "is not an array of numbers"),
        (FORCES.T, r"has the shape \(3, 2\); it needs to be \(2, 3\)"),
        (FORCES.ravel(), r"has the shape \(6,\); it needs to be \(2, 3\)"),
    ],
)
def test_loads_that_are_no_real_numbers_are_refused_by_name(value, message):
    with pytest.raises(fcm.InputError, match=f"^forces {message}"):
        mobility()(forces=value)
    with pytest.raises(fcm.InputError, match=f"^positions {message}"):
        mobility().positions = value


class Foreign:
    """An array of another library, which exports it by DLPack alone."""

    def __init__(self, array, device=1, copies=True):
        self.array, self.device, self.copies = array, device, copies

    def __dlpack_device__(self):
        return (self.device, 0)

    def __dlpack__(self, dl_device=None, **_):
        if self.device != 1 and not (self.copies and dl_device == (1, 0)):
            raise BufferError("no copies")
        return self.array.__dlpack__()


@pytest.mark.parametrize("device", [1, 2])
def test_arrays_of_other_libraries_are_taken_and_motions_given_by_dlpack(device):
    found = mobility()(forces=Foreign(FORCES, device)).velocities
    assert np.array_equal(found, mobility()(forces=FORCES).velocities)
    assert np.shares_memory(np.from_dlpack(found), found)


def test_arrays_that_cannot_be_exported_are_refused_by_name():
    with pytest.raises(fcm.InputError, match="^forces is in the memory of a device, .*no copies"):
        mobility()(forces=Foreign(FORCES, device=2, copies=False))
    with pytest.raises(fcm.InputError, match="^forces cannot be exported"):
        mobility()(forces=Foreign(FORCES.astype(object)))


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int8, np.uint64, np.int64, list])
def test_real_numbers_of_any_kind_are_taken(kind):
    forces = np.array([[0, 0, 1], [1, 0, 0]])
    given = forces.tolist() if kind is list else forces.astype(kind)
    found, expected = mobility()(forces=given), mobility()(forces=forces.astype(float))
    assert np.array_equal(found.velocities, expected.velocities)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"rigid": "yes"}, "rigid is 'yes'; it needs to be True or False"),
        ({"rigid": 1}, "rigid is 1; it needs to be True or False"),
        ({"rigid": None}, "rigid is None"),
        ({"lubrication": "yes"}, "lubrication has text"),
        ({"viscosity": "1"}, "viscosity has text"),
        ({"viscosity": True}, "viscosity has true and false"),
        ({"viscosity": 1 + 0j}, "viscosity has complex numbers"),
        ({"viscosity": [1.0]}, r"viscosity has the shape \(1,\); it needs to be a number"),
        ({"viscosity": datetime.timedelta(1)}, "viscosity has objects|viscosity has time spans"),
        ({"tolerance": np.bool_(True)}, "tolerance has true and false"),
        ({"strain": None}, "strain has objects"),
        ({"strain": np.nan}, "strain contains nan"),
        ({"radii": 1.0, "count": 2.0}, "count is 2.0; it needs to be a whole number"),
        ({"radii": 1.0, "count": True}, "count is True"),
        ({"radii": [1.0, 1j]}, "radii has complex numbers"),
        ({"radii": np.ma.array([1.0, 1.0], mask=[0, 1])}, "radii is a masked array"),
        ({"radii": [[1.0], [1.0]]}, r"radii has the shape \(2, 1\)"),
        ({"radii": [1.0, 1e-300]}, "radii has a sphere whose radius is 1e-300"),
        ({"box": (12.0, 12.0, 12.0, 99.0)}, r"box has the shape \(4,\)"),
        ({"box": ("12", "12", "12")}, "box has text"),
        ({"boundaries": ("periodic", "periodic", "periodic", "walls")}, "boundaries is .* needs to be 3 words"),
        ({"boundaries": (1, 2, 3)}, "boundaries is .* needs to be 3 words"),
        ({"method": 3}, "method is 3; it needs to be a word"),
        ({"device": "tpu"}, 'device is "tpu"; it needs to be "cpu" or "gpu"'),
        ({"threads": True}, "threads is True"),
    ],
)
def test_parameters_of_another_type_are_refused_by_name(more, message):
    with pytest.raises((fcm.InputError, TypeError), match=message):
        mobility(**more)


def test_radii_are_those_that_were_planned_for():
    given = np.ones(2)
    made = mobility(radii=given)
    given[0] = 3.0
    assert np.array_equal(made.radii, [1.0, 1.0])
    with pytest.raises(ValueError, match="read-only"):
        made.radii[0] = 2.0
    given[:] = 1.0
    made.positions = (moved := PLACES.copy())
    moved[0] = 0.0
    assert np.array_equal(made.positions, PLACES)


def test_whole_numbers_of_draws_are_whole():
    for draws in (1.5, True, "2", 0):
        with pytest.raises(fcm.InputError, match="draws is"):
            mobility().noise(draws=draws, seed=1)
    with pytest.raises(fcm.InputError, match="box has an edge of 1000000, 83333 times the shortest"):
        mobility(box=(1e6, 12.0, 12.0)).noise(draws=1, seed=1)


def test_operators_are_of_real_vectors():
    pytest.importorskip("scipy")
    operator = mobility().linear_operator("forces", "velocities")
    with pytest.raises(fcm.InputError, match="forces has complex numbers"):
        operator @ np.full(6, 1j)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (1 + 2j, "a scene has no values such as"),
        (np.datetime64("2020-01-01"), "no dates"),
        (np.ma.array([1.0, 2.0, 3.0], mask=[0, 0, 1]), "no masks"),
        (np.ones(3).view(Measured), "no units"),
        (b"bytes", "a scene has no values such as"),
        (None, "a scene has no values such as None"),
    ],
)
def test_values_of_scenes_are_those_of_scene_files(pair, value, message):
    with pytest.raises(TypeError, match=message):
        fcm.Scene.from_dict(pair).set("box.edges", value)


def test_scenes_have_lists_of_their_lengths(pair):
    with pytest.raises(fcm.InputError, match="box.edges has the wrong type: found a list of length 4"):
        fcm.Scene.from_dict(pair).set("box.edges", [12, 12, 12, 99])
    with pytest.raises(TypeError, match="3 is not a key of a scene"):
        fcm.Scene.from_dict({**pair, 3: 4})
