"""Forecasts of `check` against the measured seconds and bytes of runs: of the scenes that the program provides, of larger
suspensions, and on two ranks. Needs a machine without other load."""

import json
import math
import pathlib
import subprocess
import tempfile
import time

from support.page import table, write_section
from support.program import PROGRAM

SCENES = pathlib.Path(__file__).parents[1] / "scenes"
LARGE = [f"box.edges=[{edge}, {edge}, {edge}]" for edge in (90.0,)]
CASES = [
    *((path.stem, path, [], []) for path in sorted(SCENES.glob("*.toml")) if path.stem not in ("shear-cell-continuum", "family")),
    ("settling, 21,000 spheres", SCENES / "settling.toml", [*LARGE, "species[0].count=21000", "time.steps=60"], []),
    ("shear, larger, lubrication", SCENES / "shear.toml", ["box.edges=[60.0, 60.0, 60.0]", "hydrodynamics.lubrication=true", "time.steps=40"], []),
    ("settling on 2 ranks", SCENES / "settling.toml", [], ["mpirun", "-n", "2"]),
]


def output(folder):
    """Bytes on the disk; space reserved for later frames is not counted."""
    return sum(512 * path.stat().st_blocks for path in folder.rglob("*") if path.is_file())


def compared(scene, overrides, launch):
    """Forecast and measured seconds, then forecast and measured bytes."""
    sets = [word for override in overrides for word in ("--set", override)]
    said = subprocess.run([*launch, PROGRAM, "check", scene, *sets, "--json"], check=True, capture_output=True, text=True)
    said = json.loads(said.stdout)
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "run"
        begin = time.perf_counter()
        run = [*launch, PROGRAM, "run", scene, *sets, "--out", str(out)]
        subprocess.run(run, check=True, capture_output=True)
        return said["seconds_of_run"], time.perf_counter() - begin, said["output_bytes"], output(out)


def row(name, scene, overrides, launch):
    expected, found, said, written = compared(str(scene), overrides, launch)
    print(f"{name}: forecast {expected:.3g} s, measured {found:.3g} s; forecast {said:.3g} bytes, measured {written:.3g}", flush=True)
    ratio = expected / found
    verdict = "" if abs(math.log(ratio)) < math.log(1.5) or found < 1.0 else " *"
    return [name, f"{expected:.3g}", f"{found:.3g}", f"{ratio:.2f}{verdict}", f"{said / 1e6:.3g}", f"{written / 1e6:.3g}"]


HEADER = ["scene", "forecast, s", "measured, s", "ratio", "forecast, MB", "measured, MB"]
rows = [row(*case) for case in CASES]
write_section("costs.md", "forecast", "Forecasts of `check` and measurements", table(HEADER, rows))
