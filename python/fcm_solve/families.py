"""Families of runs over seeds and values of keys."""

from __future__ import annotations

import json
import os
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from . import _arrays, _core, _toml
from ._errors import Error, InputError
from .scene import Scene
from .simulation import Simulation

_NAMED = 5


def run_family(
    scene: dict[str, Any] | str | PathLike,
    out: str | PathLike,
    cores: int | None = None,
    force: bool = False,
) -> list[dict[str, Any]]:
    """Makes the missing runs of a family, and returns the table of means over the seeds.

    scene    the path of a scene file with `[ensemble]` or `[sweep]`, or a dict with these keys
    out      the folder of the results, in the form of `fcm-solve run`: each can continue a family that the other has begun
    cores    number of runs at a time, each in a separate process; the number of cores by default
    force    replace the results of an earlier family in that folder

    Rows are dicts with the columns of `family.csv`: `pandas.DataFrame(rows)` makes a table of them. A failed run does
    not end the others; an `Error` at the end names it. In a script, call this function below
    `if __name__ == "__main__":`, since the processes import the script again.
    """
    text, name = _text_of(scene)
    folder, force = fspath(out), _arrays.flag("force", force)
    cores = os.cpu_count() or 1 if cores is None else _arrays.whole("cores", cores, 1)
    missing = _core.claim_family(text, name, folder, force)
    failures = []
    with ProcessPoolExecutor(max(1, min(cores, len(missing))), mp_context=get_context("spawn")) as pool:
        running = {pool.submit(_run_member, fspath(path), scene): member for member, path, scene in missing}
        for ended in as_completed(running):
            failure = ended.exception()
            if failure is not None:
                failures.append(f"{running[ended]} failed: {failure}")
            _core.write_family(text, name, folder)
    if failures:
        more = f"; and {len(failures) - _NAMED} more" if len(failures) > _NAMED else ""
        raise Error("; ".join(failures[:_NAMED]) + more)
    return json.loads(_core.write_family(text, name, folder))


def _text_of(scene):
    if isinstance(scene, dict):
        return _toml.document(scene), "dict.toml"
    name = fspath(scene)
    try:
        return Path(name).read_text(encoding="utf-8"), name
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"can't read the scene {name}: {error}") from None


def _run_member(folder, text):
    """Runs or continues a member, on one core."""
    has_checkpoint = any(Path(folder).glob("checkpoint-*.bin"))
    if has_checkpoint:
        simulation = Simulation.resume(folder, threads=1)
    else:
        simulation = Simulation(Scene(text), out=folder, force=True, threads=1)
    with simulation:
        simulation.run()
