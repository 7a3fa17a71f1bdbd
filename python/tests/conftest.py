"""Fixtures shared by the tests."""

import os
import subprocess
from pathlib import Path

import pytest

# Ignores costs that the user of this machine may have measured.
os.environ["XDG_CACHE_HOME"] = "/nowhere"

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))


@pytest.fixture(scope="session")
def program():
    """Runs `fcm-solve` with arguments and returns its output: the program of `FCM_SOLVE`, or the release build, which is
    made if it is missing."""
    path = Path(os.environ.get("FCM_SOLVE", TARGET / "release" / "fcm-solve"))
    if not path.exists():
        subprocess.run(["cargo", "build", "--quiet", "--release"], cwd=ROOT, check=True)

    def run(*arguments, **options):
        done = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, **options)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture
def scenes():
    """The folder of the scenes that the program provides."""
    return ROOT / "scenes"


@pytest.fixture(scope="session")
def pair():
    """Two spheres that settle side by side, as a dict."""
    return {
        "box": {"edges": [16.0, 16.0, 16.0]},
        "fluid": {"viscosity": 1.0},
        "species": [{"name": "heavy", "radius": 1.0, "count": 2, "force": [0.0, 0.0, -18.85]}],
        "particles": {"initial": "positions", "positions": [[6.5, 8.0, 12.0], [9.5, 8.0, 12.0]]},
        "hydrodynamics": {"tolerance": 1e-3},
        "time": {"step": 0.1, "steps": 8},
        "output": {"trajectory_every": 1, "observables_every": 1, "checkpoint_every": 4},
    }
