"""Plans and memory of scenes of any size, from `fcm-solve check` of a large one."""

import dataclasses
import json
import pathlib
import subprocess
import tempfile

from support.program import PROGRAM

from scaling.counts import FRACTION, STEPPED_FRACTION, edge, scene

# Spheres of the scene whose plan is taken for all.
LARGE = 10**9


@dataclasses.dataclass(frozen=True)
class Plan:
    """Edge of the box, grid points along it, and the distance to which a sphere reaches into other ranks."""

    edge: float
    points: int
    reach: float

    def of(self, count):
        """The plan of so many spheres, at the same spacing."""
        scale = (count / LARGE) ** (1 / 3)
        return Plan(self.edge * scale, 2 * round(self.points * scale / 2), self.reach)


def checked(count, lubricated, ranks):
    """The outline by `check` of a scene of so many spheres on ranks."""
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / "scene.toml"
        path.write_text(scene(count, STEPPED_FRACTION if lubricated else FRACTION, lubricated))
        words = [PROGRAM, "check", path, "--json", "--no-trial", "--ranks", str(ranks)]
        return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)


def large(lubricated):
    """The plan of the large scene."""
    chosen = checked(LARGE, lubricated, 1)["plan"]
    box, points = edge(LARGE, STEPPED_FRACTION if lubricated else FRACTION), chosen["grid"][0]
    return Plan(box, points, max(chosen["cutoff"], chosen["support"][1] * box / points / 2))


def memory(count, ranks, lubricated):
    """Bytes of the largest rank."""
    return max(checked(count, lubricated, ranks)["memory_bytes"])
