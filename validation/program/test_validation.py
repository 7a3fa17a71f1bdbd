"""The validation cases at a small size."""

import sys
import unittest

from program import ROOT

sys.path.insert(0, str(ROOT / "validation"))
import pair_settling


class PairSettling(unittest.TestCase):
    def test_two_spheres_settle_as_in_unbounded_fluid(self):
        reference = {key: value for key, value in pair_settling.read_reference().items() if key[0] == 2.0}
        self.assertEqual(len(reference), 8)
        worst = pair_settling.differences(reference, pair_settling.compute(list(reference)))
        self.assertLess(max(worst.values()), pair_settling.LIMIT)
