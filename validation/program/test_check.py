"""`check` refuses what `run` refuses at its start, in the same words, and nothing else."""

import csv
import pathlib
import subprocess
import tempfile
import unittest

from program import PATIENCE, ROOT, answered, command, run
from test_scenes import SMALLER

# For run.py.
HEAVY = 90

SCENES = {
    "spheres": """
seed = 1
[box]
edges = [10.0, 10.0, 10.0]
[fluid]
viscosity = 1.0
[[species]]
name = "a"
radius = 1.0
count = 4
force = [0.0, 0.0, -1.0]
[[species]]
name = "b"
radius = 0.5
count = 2
[hydrodynamics]
tolerance = 0.01
[time]
step = 0.01
steps = 1
""",
    "disks": """
kind = "granular-disks"
[box]
edges = [20.0, 20.0]
[fluid]
viscosity = 0.01
[flow]
kind = "shear"
rate = 0.01
[[species]]
radius = 1.0
share = 1.0
[particles]
area_fraction = 0.3
[preparation]
settled = 1.0
mixed = 1.0
[time]
steps = 1
""",
    "cell": """
kind = "shear-cell"
collisions = "event-driven"
[cell]
length = 8.0
height = 8.0
width = 8.0
speed = 1.0
[grains]
diameter = 1.0
density = 1.0
solid_fraction = 0.2
restitution = 0.9
[walls]
restitution = 0.9
[time]
step = 0.1
steps = 1
""",
}
FAILING = """
box.edges = [10.0, 10.0, 10.0]
fluid.viscosity = 1.0
time = { step = 1.0, steps = 3, integrator = "adaptive" }
hydrodynamics.tolerance = 0.01
particles = { initial = "positions", positions = [[1.0, 5.0, 5.0], [3.2, 5.0, 5.0]] }
[[species]]
name = "right"
radius = 1.0
count = 1
force = [30.0, 0.0, 0.0]
[[species]]
name = "left"
radius = 1.0
count = 1
force = [-30.0, 0.0, 0.0]
"""
CHANGES = {
    "spheres": [
        [],
        ["box.edges=[10.0, 10.0, 10.0, 99.0]"],
        ["box.edges=[1.9, 10.0, 10.0]"],
        ["species[1].radius=0.01"],
        ["species[1].radius=0.01", "hydrodynamics.lubrication=true"],
        ["species[1].radius=1e-300"],
        ["species[0].count=190"],
        ["species[0].name=all"],
        ["species[0].name='x, y'"],
        ["species[0].name='=1'"],
        ["particles.initial=file", "particles.path=missing.csv"],
        ["particles.initial=file", "particles.path=places.csv"],
        ["particles.initial=positions", f"particles.positions={[[1.0, 1.0, 1.0 + i] for i in range(6)]}"],
        ["particles.initial=lattice"],
        ["repulsion.strength=1.0", "repulsion.screening_length=50.0"],
        ["repulsion.strength=-1.0"],
        ["hydrodynamics.grid=[2, 2, 2]"],
        ["hydrodynamics.support=60"],
        ["time.step=0"],
        ["time.steps=0"],
        ["flow.kind=shear", "flow.rate=1.0", "output.fields_every=1"],
        ["box.boundaries=['periodic', 'periodic', 'walls']"],
        ["fluid.thermal_energy=1.0"],
        ["repulsion.strength=1.0", "repulsion.calibrate=true"],
        ["hydrodynamics.grid=[4000, 4000, 4000]"],
    ],
    "disks": [
        [],
        ["contact=[0.5]"],
        ["particles.area_fraction=0.9"],
        ["box.edges=[5.0, 5.0]"],
        ["time.step=1e9"],
    ],
    "cell": [
        [],
        ["grains.solid_fraction=0.7"],
        ["cell.gravity=inf"],
        ["top.kind=free", "top.pressure=1.0", "top.mass_per_area=0"],
    ],
}


class Check(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def test_check_and_run_refuse_the_same_scenes(self):
        (self.folder / "places.csv").write_text("x,y,z\n" + "\n".join(f"{3 * i + 0.5},{2 * i},1" for i in range(6)) + "\n")
        for kind, text in SCENES.items():
            (self.folder / f"{kind}.toml").write_text(text)
            for number, sets in enumerate(CHANGES[kind]):
                self.compare(self.folder / f"{kind}.toml", sets, f"{kind}{number}")

    def test_every_scene_has_the_same_verdict(self):
        for scene in sorted((ROOT / "io" / "scene" / "tests" / "bad").glob("*.toml")):
            self.assertEqual(self.compare(scene, [], scene.stem), 1, scene)
        for scene in sorted((ROOT / "io" / "scene" / "tests" / "good").glob("*.toml")):
            self.compare(scene, ["time.steps=1"], scene.stem)
        for scene in sorted((ROOT / "scenes").glob("*.toml")):
            sets = [f"{key}={value}" for key, value in SMALLER.get(scene.stem, {}).items()]
            steps = [] if scene.stem == "shear-cell-continuum" else ["time.steps=1"]
            self.assertEqual(self.compare(scene, [*sets, *steps], scene.stem), 0, scene)

    def test_several_ranks_make_the_same_scenes(self):
        """Families and grains run in one process."""
        alone = []
        for scene in sorted((ROOT / "scenes").glob("*.toml")):
            sets = [f"{key}={value}" for key, value in SMALLER.get(scene.stem, {}).items()]
            steps = [] if scene.stem == "shear-cell-continuum" else ["time.steps=1"]
            if self.compare(scene, [*sets, *steps], scene.stem, ranks=2):
                alone.append(scene.stem)
                self.assertEqual([*self.folder.glob(f"{scene.stem}/*")], [], "nothing is left of a run that is refused")
        grains = ["disk-sweep", "family", "granular-disks", "poiseuille-disks", "shear-cell", "shear-cell-continuum"]
        self.assertEqual(sorted(alone), grains)
        for name in grains[2:]:
            said = run(["check", ROOT / "scenes" / f"{name}.toml", "--ranks", 2], expect=1)
            self.assertIn("scenes of grains run in one process", said)

    def test_time_is_told_of_ranks_that_are_absent(self):
        """The fraction of the time that is computation does not depend on the duration of the trial steps."""
        words = ["check", ROOT / "scenes" / "settling.toml", "--json"]
        told = {ranks: answered([*words, "--ranks", ranks, "--ranks-per-machine", 1]) for ranks in (1, 2, 8, 64)}
        parts = [values["efficiency"] for values in told.values()]
        self.assertEqual(parts[0], 1.0)
        self.assertEqual(parts, sorted(parts, reverse=True))
        worth = {values["ranks_worth"] for values in told.values()}
        self.assertEqual(len(worth), 1)
        self.assertEqual([part >= 0.5 for part in parts], [ranks <= min(worth) for ranks in told])
        self.assertLess(told[8]["seconds_per_step"], 8 * told[1]["seconds_per_step"])
        self.assertNotIn("seconds_per_step", answered([*words, "--ranks", 2, "--no-trial"]))
        # The grid of an open box follows its spheres.
        open_fluid = answered(["check", ROOT / "scenes" / "cloud.toml", "--json", "--ranks", 2])
        self.assertNotIn("seconds_per_step", open_fluid)
        self.assertIn("output_bytes", open_fluid)

    def compare(self, scene, sets, name, ranks=None):
        """The exit code of `check`, which is that of `run`, as are the errors."""
        words = [word for item in sets for word in ("--set", item)]
        checked, ran = (
            subprocess.run(command(line, ranks), capture_output=True, text=True, timeout=PATIENCE)
            for line in (["check", scene, *words], ["run", scene, *words, "--out", self.folder / name])
        )
        errors = [[line for line in said.stderr.splitlines() if line.startswith("error:")] for said in (checked, ran)]
        with self.subTest(scene=scene.name, sets=sets, ranks=ranks):
            self.assertEqual(checked.returncode, ran.returncode, f"{checked.stderr}\n{ran.stderr}")
            self.assertEqual(*errors)
        return checked.returncode

    def test_steps_that_fail_are_an_error_after_the_outline(self):
        """No force keeps apart two spheres that are pressed together."""
        scene = self.folder / "fails.toml"
        scene.write_text(FAILING)
        self.assertEqual(self.compare(scene, [], "fails"), 1)
        self.assertIn("trial      the first steps fail", run(["check", scene], expect=1))
        run(["check", scene, "--no-trial"])

    def test_a_run_that_a_strain_ends_is_timed_until_then(self):
        scene = ROOT / "scenes" / "thickening.toml"
        sets = ["--set", "box.edges=[7.0, 7.0, 7.0]", "--set", "species[0].volume_fraction=0.15"]
        sets += ["--set", "flow.stress=2.0", "--set", "time.duration=1e5"]
        outline = answered(["check", scene, *sets, "--json"])
        self.assertEqual((outline["steps"], outline["last_strain"]), (100_000, 10.0))
        # The fluid alone would flow at a rate of 2 under this stress.
        self.assertTrue(10.0 / 2.0 <= outline["expected_steps"] < outline["steps"], outline["expected_steps"])
        self.assertLess(outline["seconds_of_run"], 10 * outline["seconds_per_step"] * outline["expected_steps"])
        said = run(["check", scene, *sets])
        self.assertRegex(said, r"steps      at most 100000, until strain 10 or time 100000\n")
        self.assertRegex(said, r"strain     reached after about \d+ steps at the rate of the first \d+, which may change\n")
        said = run(["check", scene, *sets, "--set", "time.duration=2.0"])
        self.assertRegex(said, r"strain     [0-9.]+% of it reached at time.duration")

    def test_a_scene_may_be_completed_on_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "part.toml"
            scene.write_text(SCENES["spheres"].replace("viscosity = 1.0", ""))
            self.assertIn("fluid.viscosity is missing", run(["check", scene], expect=1))
            run(["check", scene, "--no-trial", "--set", "fluid.viscosity=1.0"])


class Names(unittest.TestCase):
    def test_a_name_with_a_comma_is_one_column(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "a.toml").write_text(SCENES["spheres"].replace('"a"', '"silica, 2 um"'))
            run(["run", folder / "a.toml", "--out", folder / "out", "--set", "statistics.every=1"])
            run(["report", folder / "out"])
            with open(folder / "out" / "observables.csv") as file:
                header, *rows = csv.reader(file)
            self.assertIn("mean_velocity_x[silica, 2 um]", header)
            self.assertEqual({len(row) for row in rows}, {len(header)})


if __name__ == "__main__":
    unittest.main()
