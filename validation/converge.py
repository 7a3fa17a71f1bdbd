"""Dependence of the answers of three scenes on step, box, tolerance and stiffness: `fcm-solve converge` of scenes that
the program provides, at sizes that take some minutes each.

    scripts/validate converge

Runs are kept in results/converge, or where FCM_SOLVE_RUNS says, and made once."""

import os
import pathlib
import subprocess

from support.page import write_section
from support.program import PROGRAM, ROOT

RUNS = pathlib.Path(os.environ.get("FCM_SOLVE_RUNS", ROOT / "results")) / "converge"
# The scene, the answer that is tested, and the settings that make it small.
CASES = [
    ("settling", "hindered", ["box.edges=[14.0, 14.0, 14.0]", "species[0].count=80", "time.steps=2000"]),
    ("shear", "relative_viscosity", ["box.edges=[12.0, 12.0, 12.0]", "time.duration=8.0"]),
    ("dense", "relative_viscosity", ["box.edges=[9.1, 9.1, 9.1]"]),
]


def words(setting):
    """A setting as typed on the command line."""
    key, value = setting.split("=", 1)
    return f'--set {key}="{value}"' if " " in value else f"--set {setting}"


def made(name, quantity, settings):
    """The lines of a scene: its commands, and what they print."""
    folder, scene = RUNS / name, RUNS / f"{name}.toml"
    scene.write_text(subprocess.run([PROGRAM, "new", name], check=True, capture_output=True, text=True).stdout)
    sets = [word for setting in settings for word in ("--set", setting)]
    command = [PROGRAM, "converge", scene, "--of", quantity, "--out", folder, *sets]
    ended = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if ended.returncode:
        raise SystemExit(f"{name} ended with {ended.returncode}: the same command continues")
    typed = " ".join([f"fcm-solve converge {name}.toml --of {quantity}", *map(words, settings)])
    print(ended.stdout, flush=True)
    return ["```console", f"$ fcm-solve new {name} > {name}.toml", f"$ {typed}", *ended.stdout.splitlines(), "```", ""]


def main():
    RUNS.mkdir(parents=True, exist_ok=True)
    lines = [line for case in CASES for line in made(*case)]
    write_section("convergence.md", "converge", "Three scenes", lines)


if __name__ == "__main__":
    main()
