"""Any number of ranks gives the same answer."""

import contextlib
import itertools
import resource
import tempfile
import unittest

import h5py
import numpy as np

from program import ROOT, mobility, run

HEAVY = 140

RANKS = (1, 2, 3, 4, 7)

# Ranks add in another order, which changes round-off: 1e-16 in f64, 6e-8 on a grid in f32; sums of thousands of terms
# and the solve for the stresslets amplify both.
DIFFERENCE = {"f64": 1e-12, "f32": 1e-6}

# Lubrication has two nested iterations.
LUBRICATED = 1e-10

# Relative error of random motions: the residual at which solves end hardly depends on the order of sums.
WHITENED = {"f64": 1e-6, "f32": 1e-4}

# Tolerances with which grids are in f32 and in f64.
LOOSE, TIGHT = 1e-3, 1e-7

# Smaller than the effect of loads of order 1, and larger than round-off where the answer is zero.
NOTHING = 1e-9

QUANTITIES = ("velocities", "angular_velocities", "strain_rates", "stresslets")


def case(seed, **changes):
    """Spheres of two sizes without contacts, in a box with three different edges."""
    random = np.random.default_rng(seed)
    edges = np.array([12.0, 10.0, 8.0])
    places = np.stack(np.meshgrid(*[np.arange(n) for n in (4, 3, 2)], indexing="ij"), axis=-1).reshape(-1, 3)
    positions = (places + 0.5) * edges / (4, 3, 2) + random.uniform(-0.3, 0.3, places.shape)
    count = len(positions)
    return {
        "box": edges.tolist(),
        "viscosity": 1.3,
        "positions": positions.tolist(),
        "radii": np.where(np.arange(count) % 3 == 0, 1.2, 0.8).tolist(),
        "forces": random.normal(size=(count, 3)).tolist(),
        "torques": random.normal(size=(count, 3)).tolist(),
        "background": {"velocity_gradient": [[0.1, 0.5, 0.0], [0.2, -0.3, 0.0], [0.0, 0.1, 0.2]]},
        **changes,
    }


def precision(plan):
    return "f32" if "in f32" in plan else "f64"


def relative_difference(first, second):
    first, second = np.asarray(first), np.asarray(second)
    return np.linalg.norm(second - first) / np.linalg.norm(first)


def crowd():
    """Spheres moved together to a smallest gap of 0.004, with lubrication."""
    crowd = case(16, lubrication=True)
    return crowd | {name: (0.87 * np.array(crowd[name])).tolist() for name in ("box", "positions")}


@contextlib.contextmanager
def no_file_beyond(size):
    """Limits the files and the anonymous memory of new processes to a size in bytes."""
    kind, limits = resource.RLIMIT_FSIZE, resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(kind, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(kind, limits)


class RanksAgree(unittest.TestCase):
    def agree_on(self, case, tolerance, allowed=None):
        with tempfile.TemporaryDirectory() as folder:
            alone = mobility(case, folder, tolerance=tolerance)
            for ranks in RANKS:
                answer = mobility(case, folder, ranks, tolerance)
                self.assertEqual(answer["plan"], alone["plan"])
                self.assertEqual(answer["iterations"], alone["iterations"])
                for name in [q for q in QUANTITIES if np.linalg.norm(alone.get(q, 0)) > NOTHING]:
                    difference = relative_difference(alone[name], answer[name])
                    self.assertLess(difference, allowed or DIFFERENCE[precision(alone["plan"])], f"{name} on {ranks} ranks")

    def test_rigid_spheres(self):
        self.agree_on(case(1), TIGHT)

    def test_rigid_spheres_to_a_loose_tolerance(self):
        self.agree_on(case(2), LOOSE)

    def test_lubrication(self):
        self.agree_on(crowd(), TIGHT, LUBRICATED)

    def test_given_stresslets(self):
        stresslets = np.random.default_rng(3).normal(size=(24, 5)).tolist()
        self.agree_on(case(3, rigid=False, stresslets=stresslets), TIGHT)

    def test_monopoles(self):
        self.agree_on(case(4, multipoles="monopole", torques=[]), TIGHT)

    def test_random_motions_of_a_trimer(self):
        """Three lubricated spheres in a sheared box, whitened with the matrix of one rank: numbers of order 1, the same for each draw."""
        places = [[5.0, 5.0, 5.0], [6.9, 5.85, 5.2], [6.0, 4.4, 7.95]]
        trimer = {"box": [14.0] * 3, "strain": 0.2, "viscosity": 1.0, "radii": [1.0, 1.0, 2.0], "positions": places, "lubrication": True}
        noise = {"noise": {"draws": 4, "seed": 7}}
        with tempfile.TemporaryDirectory() as folder:
            columns = []
            for kind, place in itertools.product(("forces", "torques"), range(9)):
                load = np.eye(9)[place].reshape(3, 3).tolist()
                answer = mobility(trimer | {kind: load}, folder, tolerance=LOOSE)
                columns.append(np.ravel([answer[name] for name in ("velocities", "angular_velocities")]))
            root = np.linalg.cholesky(0.5 * (np.array(columns) + np.array(columns).T))
            for tolerance, kind in ((LOOSE, "f32"), (TIGHT, "f64")):
                white = []
                for ranks in (None, 2, 7):
                    answer = mobility(trimer | noise, folder, ranks, tolerance)
                    drawn = [np.reshape(answer[f"noise_{name}"], (4, 9)) for name in ("velocities", "angular_velocities")]
                    white.append(np.linalg.solve(root, np.concatenate(drawn, axis=1).T))
                self.assertEqual(precision(answer["plan"]), kind)
                self.assertLess(abs(np.mean(white[0] ** 2) - 1), 3.5 * np.sqrt(2 / white[0].size))
                for other in white[1:]:
                    self.assertLess(np.abs(other - white[0]).max(), WHITENED[kind])

    def test_fewer_particles_than_ranks(self):
        lone = case(5)
        lone.update({name: lone[name][:1] for name in ("positions", "radii", "forces", "torques")})
        self.agree_on(lone, TIGHT)

    def agree_on_run(self, scene, sets, allowed):
        """Ten steps: Runge-Kutta, then Adams-Bashforth."""
        sets |= {"time.steps": 10, "hydrodynamics.tolerance": TIGHT, "output.trajectory_every": 10}
        sets = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        with tempfile.TemporaryDirectory() as folder:
            frames = []
            for ranks in RANKS:
                out = f"{folder}/{ranks}"
                run(["run", ROOT / "scenes" / scene, "--out", out, *sets], ranks)
                with h5py.File(f"{out}/trajectory.h5") as file:
                    particles = file["particles/all"]
                    frames.append([particles[name]["value"][-1] for name in ("position", "velocity", "stresslet")])
            for ranks, frame in zip(RANKS, frames):
                for first, here in zip(frames[0], frame):
                    self.assertLess(relative_difference(first, here), allowed, f"{ranks} ranks")

    def test_a_run(self):
        self.agree_on_run("settling.toml", {"box.edges": "[16.0, 16.0, 16.0]", "species[0].count": 60}, DIFFERENCE["f64"])

    def test_a_lubricated_run(self):
        """In a box that shears, at 20%."""
        sets = {"box.edges": "[10.0, 10.0, 10.0]", "hydrodynamics.lubrication": "true"}
        sets |= {"species[0].volume_fraction": 0.1, "species[1].volume_fraction": 0.1}
        self.agree_on_run("shear.toml", sets, LUBRICATED)

    def test_where_no_memory_can_be_shared(self):
        """Messages are used instead, with the same bits: half of this grid's columns are 18 MB, and Open MPI itself needs 4."""
        sets = ["box.edges=[16.0, 16.0, 16.0]", "species[0].count=20", "time.steps=1", "output.trajectory_every=1"]
        sets += ["hydrodynamics.method=direct", "hydrodynamics.grid=[144, 144, 144]"]
        arguments = ["run", ROOT / "scenes/settling.toml", *[word for one in sets for word in ("--set", one)], "--out"]
        with tempfile.TemporaryDirectory() as folder:
            run([*arguments, f"{folder}/shared"], 2)
            with no_file_beyond(16 << 20):
                run([*arguments, f"{folder}/messages"], 2)
            with h5py.File(f"{folder}/shared/trajectory.h5") as shared, h5py.File(f"{folder}/messages/trajectory.h5") as messages:
                for name in ("position", "velocity", "stresslet"):
                    ours, theirs = (file[f"particles/all/{name}/value"][-1] for file in (shared, messages))
                    self.assertTrue(np.array_equal(ours, theirs), name)
