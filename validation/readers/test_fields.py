"""ParaView and pyvista read the velocity fields: every frame, every point, to the end of the box."""

import pathlib
import pickle
import subprocess
import tempfile
import unittest

import h5py
import numpy as np
import pyvista

from runs import WITH_FIELDS, folder

HERE = pathlib.Path(__file__).parent
# Spacings times counts and areas are sums of rounded numbers.
ROUNDING = 1e-12
# Points of cuts are in single precision.
CUT = 4 * np.finfo(np.float32).eps


def stored(run):
    """Time, lengths, positions and values with repeated planes of each frame, constructed here from the computed ones."""
    for path in sorted((run / "fields").glob("*.h5")):
        with h5py.File(path) as file:
            time, strain, edges = (file.attrs[name] for name in ("time", "strain", "edges"))
            periodic = [word == b"periodic" for word in file.attrs.get("boundary", [b"periodic"] * 3)]
            again = [(0, int(repeats)) for repeats in reversed(periodic)]
            values = np.pad(file["velocity"][:], [*again, (0, 0)], mode="wrap")
            counts = values.shape[2::-1]
            origin = file.attrs.get("origin", np.zeros(3))
            steps = np.subtract(counts, 1) * file.attrs.get("spacing", edges / np.subtract(counts, 1))
        lines = (np.linspace(origin[d], origin[d] + steps[d], counts[d]) for d in (2, 1, 0))
        z, y, x = np.meshgrid(*lines, indexing="ij")
        yield time, steps, np.stack([x + strain * y, y, z], axis=-1).reshape(-1, 3), values.reshape(-1, 3)


def read_by_pyvista(path):
    """The series as read by pyvista."""
    reader = pyvista.get_reader(str(path))
    for time in reader.time_values:
        reader.set_active_time_value(time)
        mesh = reader.read()
        if isinstance(mesh, pyvista.MultiBlock):
            (mesh,) = mesh
        areas = [mesh.slice(normal=normal, origin=mesh.center).area for normal in np.eye(3)]
        yield {"time": time, "points": mesh.points, "velocity": mesh["velocity"], "areas": areas}


class Fields(unittest.TestCase):
    def compare(self, run, frames):
        expected = list(stored(run))
        self.assertGreater(len(expected), 2)
        self.assertEqual([frame["time"] for frame in frames], [time for time, *_ in expected])
        for frame, (_, lengths, places, values) in zip(frames, expected):
            np.testing.assert_allclose(frame["points"], places, rtol=0, atol=ROUNDING * np.abs(places).max())
            np.testing.assert_array_equal(frame["velocity"], values)
            x, y, z = lengths
            # Cuts normal to x and z through the middle: a tilted box has the height and length of a rectangular one.
            np.testing.assert_allclose(frame["areas"][1:], [x * z, x * y], rtol=CUT)

    def test_pyvista(self):
        for name in WITH_FIELDS:
            with self.subTest(name):
                run = folder(name)
                self.compare(run, list(read_by_pyvista(run / "fields.xdmf")))

    def test_each_reader_of_paraview(self):
        with tempfile.TemporaryDirectory() as place:
            out = pathlib.Path(place) / "read.pickle"
            files = [str(folder(name) / "fields.xdmf") for name in WITH_FIELDS]
            pvbatch(HERE / "paraview_reads.py", out, *files)
            read = pickle.loads(out.read_bytes())
        self.assertEqual(len(read), 3)
        for reader, series in read.items():
            for name, frames in zip(WITH_FIELDS, series, strict=True):
                with self.subTest(f"{reader}, {name}"):
                    self.compare(folder(name), frames)

    def test_boxes_that_follow_spheres_are_of_several_sizes(self):
        sizes = {len(values) for _, _, _, values in stored(folder("cloud"))}
        self.assertGreater(len(sizes), 1)

    def test_a_run_can_be_moved(self):
        with tempfile.TemporaryDirectory() as place:
            moved = pathlib.Path(place) / "elsewhere"
            subprocess.run(["cp", "-r", folder("sheared"), moved], check=True)
            self.compare(moved, list(read_by_pyvista(moved / "fields.xdmf")))


def pvbatch(script, *arguments, cwd=None):
    """Runs a script in ParaView on a virtual screen, which does not reset itself between two connections: one that ParaView
    opens meanwhile is refused."""
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset", "pvbatch", script, *arguments]
    ended = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=300, cwd=cwd)
    if ended.returncode != 0:
        raise AssertionError(f"{script}: {ended.stdout}{ended.stderr}")
