"""Scenes: the same checks and messages as in the program."""

import fcm_solve as fcm
import numpy as np
import pytest


def message_of(program, *arguments):
    with pytest.raises(AssertionError) as failed:
        program(*arguments)
    return str(failed.value)


def test_scenes_of_all_kinds_are_there(program):
    for kind in ("suspension", "granular-disks", "shear-cell", "shear-cell-continuum"):
        assert program("new", kind).endswith(fcm.Scene.new(kind).to_toml())
    assert fcm.Scene.new("shear-cell-continuum").is_whole and not fcm.Scene.new("suspension").is_whole
    with pytest.raises(fcm.InputError, match='no scene is called "pudding"; there are suspension, '):
        fcm.Scene.new("pudding")


def test_messages_are_those_of_the_program(program, scenes):
    path = scenes / "pair-settling.toml"
    with pytest.raises(fcm.InputError) as refused:
        fcm.Scene.load(path).set("time.step", -0.1)
    assert isinstance(refused.value, ValueError) and isinstance(refused.value, fcm.Error)
    assert str(refused.value) in message_of(program, "check", path, "--set", "time.step=-0.1")
    with pytest.raises(fcm.InputError, match="can't read the scene nowhere.toml"):
        fcm.Scene.load("nowhere.toml")


def test_keys_are_set_in_a_chain_or_together(pair):
    scene = fcm.Scene.from_dict(pair)
    changed = scene.set("time.step", np.float64(0.05)).set("species[0].force", np.array([0.0, 0.0, -1.0]))
    assert changed is scene and "step = 0.05" in scene.to_toml() and "force = [0.0, 0.0, -1.0]" in scene.to_toml()
    scene.set({"flow": {"kind": "shear", "rate": 0.5}, "time.duration": 1})
    assert 'kind = "shear"' in scene.to_toml() and "steps" not in scene.to_toml()
    before = scene.to_toml()
    with pytest.raises(fcm.InputError, match="time.stop"):
        scene.set("time.stop", 3)
    assert scene.to_toml() == before


def test_former_names_of_keys_warn():
    scene = fcm.Scene.new("shear-cell")
    with pytest.warns(fcm.Caution, match="time.settle has another name now: time.transient"):
        scene.set("time.settle", 0.02)
    assert "transient = 0.02" in scene.to_toml()


def test_dicts_are_written_as_toml(pair):
    text = fcm.Scene.from_dict({**pair, "title": 'a "title"\nof two lines', "seed": None}).to_toml()
    assert fcm.Scene(text).to_toml() == text
    import tomllib

    assert tomllib.loads(text) == {**pair, "title": 'a "title"\nof two lines'}
    with pytest.raises(TypeError, match="a scene has no values such as"):
        fcm.Scene.from_dict({"title": object()})


def test_paths_are_relative_to_the_file(tmp_path, pair):
    (tmp_path / "places.csv").write_text("x,y,z\n4,4,4\n8,8,8\n")
    path = tmp_path / "scene.toml"
    scene = fcm.Scene.from_dict(pair | {"particles": {"initial": "file", "path": str(tmp_path / "places.csv")}})
    path.write_text(scene.to_toml().replace(f"{tmp_path}/", ""))
    with fcm.Simulation(path) as simulation:
        assert np.array_equal(simulation.positions, [[4.0, 4.0, 4.0], [8.0, 8.0, 8.0]])
