"""The validation cases at a small size."""

import os
import subprocess
import sys
import tempfile
import unittest

from program import PROGRAM, ROOT

# Runs of the figures' scenes go to a separate folder.
PLACE = tempfile.TemporaryDirectory()
os.environ["FCM_SOLVE_RUNS"] = PLACE.name
sys.path.insert(0, str(ROOT / "validation" / "figures"))
sys.path.insert(0, str(ROOT / "validation"))
import iterations
import pair_settling
import runs
import settling
import shear
import theory
import viscosity
from support import hard_spheres


class PairSettling(unittest.TestCase):
    def test_two_spheres_settle_as_in_unbounded_fluid(self):
        reference = {key: value for key, value in pair_settling.read_reference().items() if key[0] == 2.0}
        self.assertEqual(len(reference), 8)
        worst = pair_settling.differences(reference, pair_settling.compute(list(reference)))
        self.assertLess(max(worst.values()), pair_settling.LIMIT)


class Iterations(unittest.TestCase):
    def test_a_dense_suspension_takes_few_and_more_without_a_preconditioner(self):
        found, _ = iterations.solve(0.45, 1e-4, 1e-3)
        plain, _ = iterations.solve(0.45, 1e-4, 1e-3, preconditioner=False)
        self.assertLessEqual(found, iterations.ALLOWED[0.45][0])
        self.assertGreater(plain, 2 * found)


class HardSpheres(unittest.TestCase):
    def test_they_start_without_overlap_where_their_lattice_does_not_fit(self):
        centres, edge = hard_spheres.equilibrium(64, 0.5, seed=1, sweeps=1)
        self.assertEqual(edge, hard_spheres.box(64, 0.5))
        self.assertGreater(hard_spheres.smallest_gap(centres, edge), 0)


class Viscosity(unittest.TestCase):
    def test_a_dilute_suspension_has_einsteins_viscosity(self):
        found = viscosity.compute((0.01,), seeds=4, spheres=50)
        for lubrication in (False, True):
            value, error = found[0.01, lubrication]
            # Pairs add about 0.035 phi at this concentration.
            self.assertAlmostEqual((value - 1) / 0.01, 2.5 + 0.035, delta=max(5 * error / 0.01, 0.05))


class Theories(unittest.TestCase):
    def test_the_exact_mobilities_give_batchelors_coefficient(self):
        self.assertAlmostEqual(sum(theory.random_pairs()), -6.55, delta=0.01)

    def test_pairs_at_random_fluctuate_alike_in_the_plane_of_shear(self):
        pairs = theory.DilutePairs()
        along, gradient, vorticity = pairs.slopes("random")
        self.assertEqual(along, gradient)
        self.assertAlmostEqual(gradient / vorticity, 4, delta=0.2)
        # Far apart, pairs are uncorrelated.
        self.assertAlmostEqual(pairs.q[-1], 1, delta=1e-3)

    def test_a_mixture_of_equal_spheres_is_one_fluid(self):
        mixed = theory.structure([0.01, 0.02], [1.0, 1.0]).sum(axis=1)
        phi = 0.03 * runs.volume(1)
        self.assertAlmostEqual(mixed[0], (1 - phi) ** 4 / (1 + 2 * phi) ** 2, delta=1e-6)
        self.assertAlmostEqual(mixed[0], mixed[1], delta=1e-9)


class Figures(unittest.TestCase):
    def test_runs_of_the_figures_go_on_and_are_made_once(self):
        scene = shear.scene([("small", 1.0, 0.05), ("large", 1.5, 0.05)], 12.0, "quick", 1)
        scene["time"]["duration"] = 0.5
        scene["statistics"] = {"every": 5, "from": 0.1, "diffusive_from": 0.1}
        run = runs.Run("small", scene)
        runs.make([run])
        made = (run.folder / "observables.csv").stat().st_mtime_ns
        runs.make([runs.Run("small", scene)])
        self.assertEqual((run.folder / "observables.csv").stat().st_mtime_ns, made)
        self.assertGreater(shear.tensor("yy", "small")(run)[0], 0)
        self.assertGreater(run.series("relative_viscosity")[1][-1], 1.2)
        # As if it had been stopped before its end was recorded.
        run.finished.unlink()
        runs.make([runs.Run("small", scene)])
        self.assertTrue(run.is_finished())

    def test_scenes_at_full_size_are_right(self):
        scenes = [
            shear.scene([("sphere", 1.0, 0.2)], 48.0, "full", 1, lubrication=True),
            settling.scene(settling.two_sizes(3.0, 0.1), 48.0, "full", 1),
        ]
        for scene in scenes:
            path = runs.FOLDER / "full.toml"
            path.write_text(runs.scene_text(scene))
            subprocess.run([PROGRAM, "check", path], check=True, capture_output=True)
