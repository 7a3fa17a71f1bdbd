"""scripts/gpu times JFSD and cuFCM where they run, and says why where they do not: here programs that print what these print."""

import importlib.machinery
import importlib.util
import os
import pathlib
import sys
import tempfile
import textwrap
import unittest
from unittest import mock

from program import PROGRAM, ROOT

sys.path.insert(0, str(ROOT / "scripts" / "python"))
import peers_on_card

# Seconds of a step of the false JFSD, and of its compilation.
STEP, COMPILATION = 0.02, 1.0
JAX = "def default_backend(): return {device!r}\n"
JFSD = """
import time
import numpy as np

compiled = []


def main(steps, period, step, lx, ly, lz, count, strain, heat, radius, xi, tolerance, strength, buoyancy, reach, positions, *more):
    print("jfsd is running on device: cpu")
    assert positions.shape == (count, 3) and abs(positions).max() <= lx / 2 and tolerance == 1e-3
    if not compiled:
        time.sleep({compilation})
    compiled.append(steps)
    {then}
    time.sleep({step} * steps)
    return None, np.zeros((steps, count, 5)), None, None
"""
# Motions by this program, with a relative error of 1e-4.
CUFCM = """
import json
import pathlib
import subprocess

info = dict(line.split("=") for line in open("simulation_info").read().split())
values = list(info.values())
assert [values[i] for i in (0, 1, 8, 9)] == [info[name] for name in ("N", "rh", "repeat", "prompt")] and len(values) == 18
read = lambda name: [list(map(float, line.split())) for line in open(info[name])]
positions, forces, torques = (read(name) for name in ("$posfile", "$forcefile", "$torquefile"))
assert len(positions) == int(values[0])
box = float(values[13])
case = {"box": [box] * 3, "viscosity": 1.0, "positions": positions, "radii": 1.0, "rigid": False, "forces": forces, "torques": torques}
said = subprocess.run([PROGRAM, "mobility", "-", "--tolerance", "1e-6"], input=json.dumps(case), capture_output=True, text=True, check=True)
answer = json.loads(said.stdout)
with open("data/simulation/simulation_data.dat", "w") as file:
    for i, (v, w) in enumerate(zip(answer["velocities"], answer["angular_velocities"])):
        row = [*positions[i], *forces[i], *torques[i], *(1.0001 * x for x in v), *(1.0001 * x for x in w)]
        file.write(" ".join([str(i), *(f"{x:.16f}" for x in row)]) + "\\n")
    file.write("\\n#")
# Finer grids take longer.
points = int(values[5])
print(f"-------\\nSimulation\\n-------\\nOrder:\\t\\t\\t<{ORDER}>\\nGrid points:\\t\\t({points} {points} {points})\\n")
print("-------\\nTimings\\n-------\\nInit CUDA:\\t0.5s\\nReadfile:\\t0 s")
for name, seconds in [("Hashing", 1e-5), ("Spreading", 1e-6 * points), ("FFT+flow", 2e-5), ("Gathering", 3e-5), ("Correction", 4e-5)]:
    print(f"{name}:\\t{seconds} \\t+/-\\t 1e-07 s")
print("Compute total:\\t1e-4 s\\nPTPS:\\t1e8 /s")
"""


def script(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)
    return path


def gpu():
    """scripts/gpu as a module."""
    loader = importlib.machinery.SourceFileLoader("gpu", str(ROOT / "scripts" / "gpu"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("gpu", loader))
    with mock.patch.object(sys, "dont_write_bytecode", True):
        loader.exec_module(module)
    return module


def page(peers):
    """The page of a machine where nothing else was measured, and the rows of its two tables."""
    parity = {"difference": 1e-4, "tolerance": "1e-3", "same_bits": True}
    found = {name: [] for name in ("times", "round_off", "two_ranks", "sanitized", "steps", "runs")}
    text = gpu().page({**found, "card": "a card", "day": "2026-01-01", "parity": [parity], "peers": peers})
    rows = [line[1:-1].split("|") for line in text.splitlines() if line.startswith("|")]
    return text, rows


class Peers(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder, self.out = pathlib.Path(place.name) / "peers", pathlib.Path(place.name) / "out"
        self.folder.mkdir()
        names = {name: "" for name in ("JFSD", "JFSD_PYTHON", "CUFCM")}
        set_up = mock.patch.dict(os.environ, {**names, "PYTHONPATH": str(self.folder / "jfsd")})
        set_up.start()
        self.addCleanup(set_up.stop)

    def jfsd(self, then="pass", device="cpu"):
        text = JFSD.format(compilation=COMPILATION, step=STEP, then=then)
        for name, content in (("jax.py", JAX.format(device=device)), ("jfsd/__init__.py", ""), ("jfsd/main.py", text)):
            script(self.folder / "jfsd" / name, content)

    def cufcm(self, text):
        return script(self.folder / "cufcm" / "bin" / "CUFCM", f"#!{sys.executable}\n{textwrap.dedent(text)}")

    def motions(self, order="Rotation"):
        self.cufcm(f"PROGRAM, ORDER = {PROGRAM!r}, {order!r}\n{CUFCM}")

    def measured(self, device=None, program=PROGRAM, seconds=60):
        return peers_on_card.measured(program, device, self.folder, self.out, seconds)

    def test_both_are_in_the_tables(self):
        self.jfsd()
        self.motions()
        found = self.measured()
        self.assertEqual(found["said"], [])
        text, rows = page(found)
        times, steps = rows[2], [row for row in rows if "equal spheres" in row[0]]
        self.assertEqual(len(times), len(rows[0]))
        self.assertEqual([len(row) for row in steps], [len(rows[3])] * 2)
        # Of grids of 12, 16 and 18 points the coarsest takes the shortest time: 12 + 20 + 30 + 40 + 10 microseconds.
        self.assertEqual([word.strip() for word in times[4:6]], ["forces and torques, cuFCM", "12 x 12 x 12"])
        self.assertEqual([word.strip() for word in times[6:13]], ["0.012", "0.02", "0.03", "0.04", "", "0.112", "1.0e-04"])
        self.assertTrue(steps[1][0].strip().endswith("JFSD"))
        taken = float(steps[1][3]) / 1e3
        # Not with the compilation, which takes longer than all steps.
        self.assertTrue(STEP / 2 < taken < COMPILATION / 2, f"a step takes {taken} s")
        self.assertIn("JFSD: wall time", text)
        self.assertIn("cuFCM: its own means", text)

    def test_a_program_without_torques_is_said_to_have_forces_alone(self):
        self.motions(order="Translation")
        found = self.measured()
        # Its motions are those of forces and torques, so they have a large error beside those of forces.
        self.assertEqual(found["times"][0]["loads"], "forces alone, cuFCM")
        self.assertGreater(found["times"][0]["error"], 1e-2)

    def test_programs_that_are_not_there_are_named(self):
        found = self.measured()
        self.assertEqual((found["steps"], found["times"]), ([], []))
        self.assertEqual(found["said"], ["JFSD: no checkout of it is here.", "cuFCM: no program of it is here."])
        text, rows = page(found)
        self.assertEqual(len(rows), 4)
        self.assertTrue(text.endswith("JFSD: no checkout of it is here.\ncuFCM: no program of it is here.\n"))

    def test_a_checkout_that_cannot_be_imported_is_named(self):
        script(self.folder / "jfsd" / "jfsd" / "main.py", "import a_library_that_nobody_has\n")
        (said, _) = self.measured()["said"]
        self.assertEqual(said, "JFSD: failed: ModuleNotFoundError: No module named 'a_library_that_nobody_has'.")

    def test_failures_are_named(self):
        self.jfsd(then="raise ValueError('GMRES did not converge! Iterations are 9. Abort!')")
        self.cufcm("import sys\nsys.exit('error: CUDA API call : out of memory')")
        found = self.measured()
        self.assertEqual((found["steps"], found["times"]), ([], []))
        wanted = "JFSD, 100 spheres: failed: ValueError: GMRES did not converge! Iterations are 9. Abort!."
        self.assertEqual(found["said"], [wanted, "cuFCM, 100 spheres: failed: error: CUDA API call : out of memory."])

    def test_errors_of_kernels_and_missing_times_are_failures(self):
        self.cufcm("import sys\nprint('CUDA error spread: no kernel image is available', file=sys.stderr)")
        wanted = "cuFCM, 100 spheres: failed: CUDA error spread: no kernel image is available."
        self.assertEqual(self.measured()["said"][1], wanted)
        self.cufcm("print('Hashing:\\tnan \\t+/-\\t nan s')")
        self.assertEqual(self.measured()["said"][1], "cuFCM, 100 spheres: printed no times.")

    def test_a_program_that_hangs_is_ended_with_its_children(self):
        self.cufcm("""
            import subprocess
            child = subprocess.Popen(["sleep", "600"])
            open("child", "w").write(str(child.pid))
            child.wait()
        """)
        found = self.measured(seconds=2)
        self.assertEqual(found["times"], [])
        self.assertEqual(found["said"][1], "cuFCM, 100 spheres: no result within 2 s.")
        child = pathlib.Path("/proc") / (self.out / "child").read_text() / "stat"
        self.assertTrue(not child.exists() or child.read_text().rpartition(")")[2].split()[0] == "Z", "the child goes on")

    def test_times_of_jfsd_without_a_card_are_not_those_of_a_card(self):
        self.jfsd()
        only_here = f"#!/bin/sh\n[ -d \"$2\" ] || sed -i /hydrodynamics.device/d \"$2\"\nexec {PROGRAM} \"$@\"\n"
        program = script(self.folder / "fcm-solve", only_here)
        with mock.patch.object(peers_on_card, "SHEARED", (100,)):
            found = self.measured(device="gpu", program=program)
            self.assertEqual((found["steps"], found["said"][0]), ([], "JFSD, 100 spheres: JAX finds no card."))
            self.jfsd(device="gpu")
            self.assertEqual(len(self.measured(device="gpu", program=program)["steps"]), 2)


if __name__ == "__main__":
    unittest.main()
