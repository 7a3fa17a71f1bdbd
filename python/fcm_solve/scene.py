"""Scenes: descriptions of computations, as in the program's scene files."""

from __future__ import annotations

from os import PathLike, fspath
from typing import Any
from warnings import warn

from . import _core, _toml
from ._errors import Caution


class Scene:
    """A scene that has been checked: every number is in its range.

    Made by `Scene.load`, `Scene.new` or `Scene.from_dict`. A scene that is not allowed raises `InputError` with the
    message of the program, which names the key, what was found and what is allowed.
    """

    def __init__(self, text: str, name: str = "scene.toml") -> None:
        """Checks the text of a scene file. Paths in it are relative to the folder of `name`."""
        self._name = name
        self._take(text, [])

    @classmethod
    def load(cls, path: str | PathLike) -> Scene:
        """Reads a scene file. Paths in it are relative to its folder."""
        return cls(_core.read(fspath(path)), fspath(path))

    @classmethod
    def new(cls, kind: str) -> Scene:
        """A scene that the program provides, as printed by `fcm-solve new KIND`, such as "suspension"."""
        return cls(_core.template(kind), f"{kind}.toml")

    @classmethod
    def from_dict(cls, items: dict[str, Any]) -> Scene:
        """A scene from a dict of dicts with the keys of a scene file; keys with the value `None` are left out."""
        return cls(_toml.document(items), "dict.toml")

    def set(self, key: str | dict[str, Any], value: Any = None) -> Scene:
        """Sets a key, such as `"time.step"` or `"species[0].count"`, or all keys of a dict at once.

        Returns the scene, so that calls can be chained. If the new values are not allowed, the scene stays unchanged.
        """
        items = key if isinstance(key, dict) else {key: value}
        self._take(self._text, [f"{name}={_toml.value(item)}" for name, item in items.items()])
        return self

    def to_toml(self) -> str:
        """The text of the scene file, with the keys that were set."""
        return self._text

    @property
    def is_whole(self) -> bool:
        """Whether the scene is carried out as a whole (the continuum model) and not in time steps."""
        return self._is_whole

    def _take(self, text, overrides):
        self._text, self._is_whole, warnings = _core.check(text, self._name, overrides)
        for warning in warnings:
            warn(warning, Caution, stacklevel=3)

    def __repr__(self):
        return f"<fcm_solve.Scene {self._name}>"


def scene_of(scene: Scene | dict[str, Any] | str | PathLike) -> Scene:
    """A scene from a scene, a dict or the path of a file."""
    if isinstance(scene, Scene):
        return scene
    return Scene.from_dict(scene) if isinstance(scene, dict) else Scene.load(scene)
