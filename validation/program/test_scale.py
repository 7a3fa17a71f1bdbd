"""The model of scripts/validate scale: published transforms, and the program's own counts."""

import sys
import unittest

from program import ROOT

sys.path.insert(0, str(ROOT / "validation"))

from scaling import counts, measured, pages, published  # noqa: E402
from scaling.network import Group, Layout  # noqa: E402
from scaling.projection import Slice, images  # noqa: E402


class Published(unittest.TestCase):
    def test_transforms_are_reproduced_with_a_network_that_thins_out_alone(self):
        found = [of for of in published.transforms() if of.ranks <= published.RANKS]
        self.assertEqual(len(found), 36)
        ratios = published.ratios(found, published.fitted_exponent(found))
        self.assertLess(max(*ratios, *(1 / ratios)), published.FACTOR)
        self.assertLess(min(published.ratios(found, 0.0)), 1 / published.FACTOR)


class Network(unittest.TestCase):
    def test_ranks_that_follow_each_other_share_a_node(self):
        layout = Layout(64, 8)
        self.assertEqual(Group(8, 1).shares(layout), (0.0, 7 / 8))
        self.assertEqual(Group(8, 8).shares(layout), (7 / 8, 0.0))
        self.assertEqual(Group(64, 1).shares(layout), (7 / 8, 7 / 64))


class OwnCounts(unittest.TestCase):
    def test_transpositions_send_what_was_counted(self):
        stored = measured.load()["counts"]["evaluation"]
        for ranks in (16, 64):
            of = stored[str(ranks)]
            grid, layout = Slice(ranks, of["grid"][0]), Layout(ranks, counts.RANKS_PER_NODE)
            rows, columns = grid.table
            away = sum(group.shares(layout)[0] for group in (Group(columns, 1), Group(rows, columns)) if group.size > 1)
            self.assertAlmostEqual(of["groups_bytes"][1] / (2 * away * 12 * grid.points**3 / ranks), 1, delta=0.15)

    def test_an_image_takes_as_many_bytes_on_any_number_of_ranks(self):
        stored = measured.load()
        plan, expected = measured.plan(stored, counts.EVALUATED, False), pages.calls_of(stored)[False].image_bytes
        for ranks in (4, 8, 16, 32, 64):
            found = images(counts.EVALUATED, plan, Slice(ranks, plan.points).table).count
            sent = stored["counts"]["evaluation"][str(ranks)]["halos_bytes"][1]
            self.assertAlmostEqual(sent / found / expected, 1, delta=0.15)


if __name__ == "__main__":
    unittest.main()
