"""Results of a run, read back."""

import sys

import fcm_solve as fcm
import h5py
import numpy as np
import pytest
import xarray


@pytest.fixture(scope="module")
def sheared(tmp_path_factory, pair):
    """The folder of a short run in shear, with fields and statistics, in which spheres cross the faces of the box."""
    folder = tmp_path_factory.mktemp("results") / "sheared"
    scene = fcm.Scene.from_dict(pair).set(
        {
            "flow": {"kind": "shear", "rate": 1.0},
            "particles.positions": [[15.5, 12.0, 8.0], [6.5, 4.0, 0.1]],
            "output.fields_every": 4,
            "statistics": {"every": 1},
        }
    )
    with fcm.Simulation(scene, out=folder) as simulation:
        simulation.run()
    return folder


def test_the_time_series_is_a_table(sheared):
    table = fcm.open(sheared).observables.to_pandas()
    assert table.index.name == "time" and len(table) == 9
    with h5py.File(sheared / "observables.h5") as file:
        assert np.array_equal(table["relative_viscosity"], file["observables/relative_viscosity/value"])
        assert np.array_equal(table.index, file["observables/relative_viscosity/time"])


def test_answers_have_errors_and_verdicts(sheared):
    answers = fcm.open(sheared).answers
    viscosity = answers["relative_viscosity"]
    assert answers[0] is viscosity and viscosity.verdict in ("converged", "too short", "drifting")
    assert viscosity.error >= 0 and viscosity.transient <= 0.8 and viscosity.unit == ""
    assert repr(viscosity).startswith("<relative_viscosity = ") and repr(viscosity) in repr(answers)
    with pytest.raises(fcm.Error, match="'viscosity' names no answer; there are .*relative_viscosity"):
        answers["viscosity"]
    assert list(fcm.open(sheared).statistics["summary"].columns)[-1] == "converged"


def test_answers_that_are_not_written_yet_are_named(sheared, tmp_path):
    (tmp_path / "scene.toml").write_text((sheared / "scene.toml").read_text())
    with pytest.raises(fcm.Error, match="has no answers yet"):
        _ = fcm.open(tmp_path).answers


def test_answers_are_read_as_they_are_written(tmp_path):
    table = tmp_path / "summary.csv"
    table.write_text(
        "quantity,species,value,error,samples,transient,verdict,longer,unit\n"
        'settling_velocity,"silica, 2 um",0.5134,0.0123,12.5,3.0,too short,2.4,length/time\n'
        "diffusivity,b,,,,3.0,meaningless,,length^2/time\n"
    )
    (tmp_path / "scene.toml").write_text("")
    answers = fcm.open(tmp_path).answers
    assert repr(answers[0]) == "<settling_velocity[silica, 2 um] = 0.513 +- 0.012 length/time, too short: 2.4 times longer>"
    assert answers["settling_velocity", "silica, 2 um"].longer == 2.4
    assert np.isnan(answers["diffusivity"].value) and "unknown" in repr(answers[1])


def test_frames_are_read_one_by_one(sheared):
    trajectory = fcm.open(sheared).trajectory
    assert len(trajectory) == 9 and trajectory[-1].step == 8 and trajectory[2].time == 0.2
    assert sum(1 for _ in trajectory) == 9
    with h5py.File(sheared / "trajectory.h5") as file:
        particles = file["particles/all"]
        assert np.array_equal(trajectory[3].positions, particles["position/value"][3])
        assert np.array_equal(trajectory[3].stresslets, particles["stresslet/value"][3])
    assert (trajectory.radii.tolist(), trajectory.ids.tolist()) == ([1.0, 1.0], [0, 1])
    with pytest.raises(IndexError):
        trajectory[9]


def whole(sheared, unwrapped):
    with h5py.File(sheared / "trajectory.h5") as file:
        particles = file["particles/all"]
        positions = particles["position/value"][:9]
        images, edges = particles["image/value"][:9], particles["box/edges/value"][:9]
    assert np.abs(images).max() > 0 and np.ptp(edges[:, 1, 0]) > 0.5
    return positions + images @ edges if unwrapped else positions


KEYS = [
    {},
    {"time": 4},
    {"time": slice(1, 8, 3), "particle": 1},
    {"particle": [1, 0], "axis": 2},
    {"time": -1, "particle": 0, "axis": 1},
    {"time": slice(None, None, -2)},
]


@pytest.mark.parametrize("unwrapped", [False, True])
@pytest.mark.parametrize("key", KEYS)
def test_datasets_read_what_is_used(sheared, unwrapped, key):
    found = fcm.open(sheared).trajectory.to_xarray(unwrapped=unwrapped)["position"].isel(key)
    expected = xarray.DataArray(whole(sheared, unwrapped), dims=("time", "particle", "axis")).isel(key)
    assert np.array_equal(found.values, expected.values)


def test_datasets_are_lazy_and_labelled(sheared):
    trajectory = fcm.open(sheared).trajectory
    data = trajectory.to_xarray()
    assert {"position", "image", "velocity", "angular_velocity", "stresslet", "lattice"} == set(data.data_vars)
    assert data["velocity"].attrs["units"] == "length/time" and list(data["component"].values)[1] == "xy"
    assert data["velocity"].sel(axis="z").shape == (9, 2)
    first = data["position"].isel(time=0).values
    trajectory.close()
    assert first.shape == (2, 3)
    with pytest.raises((ValueError, RuntimeError)):
        data["velocity"].values  # noqa: B018


def test_unwrapped_positions_do_not_jump(sheared):
    path = fcm.open(sheared).trajectory.to_xarray(unwrapped=True)["position"].values
    assert np.abs(np.diff(path, axis=0)).max() < 3.0


def test_fields_are_those_of_their_steps(sheared):
    fields = fcm.open(sheared).fields
    assert list(fields) == [0, 4, 8] and len(fields) == 3
    field = fields[4]
    assert field.velocity.shape[3] == 3 and (field.step, field.time) == (4, 0.4)
    assert field.strain == pytest.approx(0.4)
    data = field.to_xarray()
    assert data.sel(axis="z").shape == field.velocity.shape[:3] and data["x"][0] == 0.0
    with pytest.raises(KeyError):
        fields[5]


def test_fields_say_where_their_points_are(sheared, pair, tmp_path):
    walls = {"box.boundaries": ["periodic", "periodic", "walls"], "output.fields_every": 8}
    scene = fcm.Scene.from_dict(pair).set(walls | {"particles.positions": [[5.5, 6.0, 3.0], [6.5, 4.0, 7.1]]})
    with fcm.Simulation(scene, out=tmp_path / "channel") as simulation:
        simulation.run()
    field = fcm.open(tmp_path / "channel").fields[8]
    places = field.to_xarray()
    assert field.origin == pytest.approx(0.0) and places["z"].values[-1] == pytest.approx(field.edges[2])
    assert places["x"].values[-1] + field.spacing[0] == pytest.approx(field.edges[0])
    periodic = fcm.open(sheared).fields[4]
    assert periodic.spacing * periodic.velocity.shape[2::-1] == pytest.approx(periodic.edges)


def test_contacts_are_those_of_their_steps(pair, tmp_path):
    """Two spheres pressed against each other by forces along x, across a face of the box."""
    pressed = (("left", -2.0), ("right", 2.0))
    species = [{"name": name, "radius": 1.0, "count": 1, "force": [force, 0.0, 0.0]} for name, force in pressed]
    scene = fcm.Scene.from_dict(
        pair
        | {
            "species": species,
            "particles": {"initial": "positions", "positions": [[1.0, 8.0, 8.0], [14.996, 8.0, 8.0]]},
            "hydrodynamics": {"tolerance": 1e-3, "lubrication": True},
            "contacts": {"friction": 0.5, "stiffness": 20000.0},
            "output": {"contacts_every": 4},
        }
    )
    with fcm.Simulation(scene, out=tmp_path / "touching") as simulation:
        simulation.run()
    contacts = fcm.open(tmp_path / "touching").contacts
    assert list(contacts) == [0, 4, 8] and len(contacts) == 3
    found = contacts[8]
    with h5py.File(tmp_path / "touching/contacts/contacts-0000000008.h5") as file:
        assert np.array_equal(found.normal_forces, file["normal_force"])
        assert np.array_equal(found.tangential_forces, file["tangential_force"])
    assert (found.step, found.time, len(found), found.pairs.tolist()) == (8, 0.8, 1, [[0, 1]])
    # At rest, the contact carries the forces of 2.
    assert found.forces[0] == pytest.approx([2.0, 0.0, 0.0], abs=0.1) and not found.sliding[0]
    assert found.normals[0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-6)
    assert found.lattice.tolist() == (16.0 * np.eye(3)).tolist()
    with pytest.raises(KeyError):
        contacts[5]


def test_statistics_are_tables(sheared):
    tables = fcm.open(sheared).statistics
    assert {"summary", "lags"} <= set(tables) and "observables" not in tables
    summary = tables["summary"].set_index(["quantity", "species"])
    assert np.isfinite(summary.loc[("mean_velocity_z", "heavy"), "value"])


def test_the_scene_is_kept(sheared, pair):
    assert fcm.open(sheared).scene.to_toml().count("rate = 1.0") == 1


def test_what_is_not_there_is_said(tmp_path, pair):
    with pytest.raises(fcm.Error, match="holds no run: it has no scene.toml"):
        fcm.open(tmp_path)
    silent = fcm.Scene.from_dict(pair | {"output": {"trajectory_every": 0, "observables_every": 0}})
    with fcm.Simulation(silent, out=tmp_path / "silent") as simulation:
        simulation.step()
    run = fcm.open(tmp_path / "silent")
    with pytest.raises(fcm.Error, match="observables.csv does not exist; a run writes it if output.observables_every"):
        run.observables  # noqa: B018
    (tmp_path / "silent" / "trajectory.h5").write_bytes(b"no file")
    with pytest.raises(fcm.Error, match="can't read .*trajectory.h5"):
        run.trajectory  # noqa: B018


def test_pages_are_the_program_s(program, sheared, tmp_path):
    program("report", sheared, "--out", tmp_path / "program.html")
    run = fcm.open(sheared)
    assert fcm.report(run, tmp_path / "python.html") == tmp_path / "python.html"
    assert (tmp_path / "python.html").read_text() == (tmp_path / "program.html").read_text()
    assert fcm.report(sheared) == sheared / "report.html" and (sheared / "report.html").exists()
    shown = fcm.show(run, height=400)._repr_html_()
    assert shown.startswith("<iframe srcdoc=") and "height: 400px" in shown and shown.count('"') == 6
    with pytest.raises(fcm.Error, match="holds no run"):
        fcm.report(tmp_path / "elsewhere")


@pytest.mark.parametrize("package", ["pandas", "h5py", "xarray"])
def test_packages_that_are_missing_are_named(sheared, monkeypatch, package):
    run = fcm.open(sheared)
    if package == "xarray":
        len(run.trajectory)
    monkeypatch.setitem(sys.modules, package, None)
    uses = {"pandas": "statistics", "h5py": "trajectory", "xarray": "trajectory"}
    with pytest.raises(ImportError, match=f"needs {package}, which is not installed: pip install {package}"):
        getattr(run, uses[package]).to_xarray()
