"""Predicted and measured peaks of memory, by rank.

`scripts/validate memory` runs 1,000 to 100,000 spheres at 12%, and grains; `--full` also a million spheres, which takes
several gigabytes and half an hour."""

import argparse
import pathlib
import tempfile

from support.page import table, write_section
from support.peak import measured, predicted
from support.program import PROGRAM, ROOT

# Allowed relative difference of prediction and measurement.
ALLOWED = 0.2
FRACTION = 0.12
SIZES, MORE = (1_000, 10_000, 100_000), (1_000_000,)
# Largest number of spheres for which the direct method fits a small machine.
MOST_DIRECT = 100_000

GRAINS = {
    "disks": ("granular-disks", {"time.steps": 300, "output.checkpoint_every": 100}),
    "400,000 disks": ("granular-disks", {"box.edges": "[1500.0, 1500.0]", "time.steps": 30, "preparation.elastic_until": 3.0,
                                         "preparation.inelastic_until": 1.5, "output.checkpoint_every": 10}),
    "shear cell, events": ("shear-cell", {"time.steps": 20, "time.transient": 0.002}),
    "shear cell, steps": ("shear-cell", {"time.steps": 20, "time.transient": 0.002, "collisions": "time-stepped",
                                         "time.collision_step": 1e-6}),
    "continuum": ("shear-cell-continuum", {}),
    "continuum, 20,000 heights": ("shear-cell-continuum", {"output.points": 20_000}),
}


def spheres(count, method, lubrication):
    """A scene of settling spheres, as text."""
    edge = (count * 4.18879020478639 / FRACTION) ** (1 / 3)
    return f"""
seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
particles = {{ initial = "random", minimum_gap = 0.02 }}
hydrodynamics = {{ tolerance = 1e-3, method = "{method}", lubrication = {str(lubrication).lower()} }}
time = {{ step = 0.001, steps = 2 }}
output = {{ trajectory_every = 1, checkpoint_every = 1 }}
[[species]]
radius = 1.0
count = {count}
force = [0.0, 0.0, -18.85]
"""


def cases(sizes):
    """Each case's name, the words that name its scene, and its ranks. Scenes of spheres are written to a folder."""
    for count in sizes:
        for method in ("split", "direct") if count <= MOST_DIRECT else ("split",):
            for lubrication in (False, True):
                name = f"{count:,} spheres, {method}{', lubrication' * lubrication}"
                yield name, spheres(count, method, lubrication), (1, 2)
    for name, (scene, sets) in GRAINS.items():
        words = [ROOT / "scenes" / f"{scene}.toml"]
        yield name, words + [word for item in sets.items() for word in ("--set", "=".join(map(str, item)))], (1,)


def compared(sizes):
    """A row for each rank of each case: its name, the rank, and the bytes predicted and measured."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "scene.toml"
        for name, scene, ranks in cases(sizes):
            words = scene
            if isinstance(scene, str):
                path.write_text(scene)
                words = [path]
            for count in ranks:
                both = zip(predicted(PROGRAM, words, count), measured(PROGRAM, words, count))
                for rank, (said, found) in enumerate(both):
                    yield name, f"{rank + 1} of {count}", said, found


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--full", action="store_true", help="also a million spheres")
    arguments.add_argument("--sizes", type=int, nargs="+", help="only these numbers of spheres; the page is not written")
    asked = arguments.parse_args()
    sizes = asked.sizes or SIZES + MORE * asked.full
    rows, wrong = [], []
    for name, rank, said, found in compared(sizes):
        rows.append([name, rank, f"{said / 1e6:.0f}", f"{found / 1e6:.0f}", f"{said / found:.2f}"])
        wrong += [rows[-1]] * (abs(said / found - 1) > ALLOWED)
        print(*rows[-1], sep="  ", flush=True)
    if not asked.sizes:
        header = ["scene", "rank", "predicted, MB", "measured, MB", "ratio"]
        write_section("memory.md", "memory", "Predicted and measured peaks", table(header, rows))
    if wrong:
        raise SystemExit(f"failed: predictions differ by more than {ALLOWED:.0%}: {wrong}")


if __name__ == "__main__":
    main()
