"""A browser displays the reports of every kind of scene with a trajectory."""

import pathlib
import tempfile
import unittest

import matplotlib.image
import numpy as np

from browser import Browser, program
from program import ROOT, run
from runs import PLACE, SCENES, report

PICTURE = "#picture canvas"


def seen(browser, place):
    """The picture as an array of colours from 0 to 1."""
    return matplotlib.image.imread(browser.picture(pathlib.Path(place) / "seen.png", PICTURE))[..., :3]


def coloured(picture):
    """Pixels that are neither gray nor nearly gray: the box is gray, the spheres are not."""
    return np.ptp(picture, axis=-1) > 0.15


def changed(one, other):
    """The fraction of the pixels that differ clearly."""
    return np.mean(np.abs(one - other).max(axis=-1) > 0.15)


@unittest.skipUnless(program(), "needs chromium")
class Reports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.browser = cls.enterClassContext(Browser())
        cls.place = cls.enterClassContext(tempfile.TemporaryDirectory())

    def open(self, name):
        self.browser.open(report(name))

    def seen(self):
        return seen(self.browser, self.place)

    def value(self, expression):
        return self.browser.value(expression)

    def test_spheres_are_seen_and_move(self):
        for name in SCENES:
            with self.subTest(name):
                self.open(name)
                first = self.seen()
                self.assertGreater(np.mean(coloured(first)), 0.05)
                # White around the spheres, and no colour outside of the box.
                self.assertFalse(coloured(first)[:, :20].any())
                self.browser.press("End")
                self.assertGreater(changed(first, self.seen()), 0.01)
                self.browser.press("Home")
                self.assertEqual(changed(first, self.seen()), 0)

    def test_nothing_fails_and_nothing_is_asked_of_a_network(self):
        for name in SCENES:
            with self.subTest(name):
                self.open(name)
                self.seen()
                self.browser.press(" ")
                self.browser.until("document.getElementById('frame').valueAsNumber > 1")
                self.assertEqual(self.browser.complaints(), [])
                others = [url for url in self.browser.requests() if not url.startswith(("file://", "data:"))]
                self.assertEqual((others, self.browser.requests()[0]), ([], report(name).resolve().as_uri()))

    def test_a_long_box_is_seen_whole_at_first(self):
        self.open("chain")
        picture = self.seen()
        edges = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
        self.assertGreater(edges.min(), 0.95)
        rows = np.flatnonzero(coloured(picture).any(axis=1))
        self.assertGreater(rows[-1] - rows[0], 0.6 * len(picture))

    def test_the_box_tilts(self):
        self.open("sheared")
        tilts = "JSON.parse(document.getElementById('run').textContent).edges.map(e => e[3])"
        first, *_, last = self.value(tilts)
        self.assertEqual(first, 0)
        self.assertGreater(abs(last), 3)
        gray = [np.all(np.abs(picture - 0.27) < 0.1, axis=-1) for picture in self.at_both_ends()]
        self.assertGreater(np.mean(gray[0] != gray[1]), 0.002)

    def at_both_ends(self):
        """Pictures of the first and the last frame."""
        for key in ("Home", "End"):
            self.browser.press(key)
            yield self.seen()

    def test_colours_say_what_is_chosen(self):
        for name in SCENES:
            with self.subTest(name):
                self.open(name)
                self.assertTrue(self.browser.choose("species"))
                by_species = self.seen()
                self.assertTrue(self.browser.choose("speed"))
                self.assertIn("length/time", self.value("document.getElementById('legend').textContent"))
                self.assertGreater(changed(by_species, self.seen()), 0.03)
                self.assertEqual(self.browser.choose("stress"), name in ("settling", "sheared", "dense"))

    def test_forces_of_contacts_are_lines_between_small_spheres(self):
        for name in SCENES:
            self.open(name)
            self.assertEqual(self.value("document.getElementById('show-chains') !== null"), name == "dense")
        self.open("dense")
        self.browser.press("End")
        whole = self.seen()
        self.value("document.getElementById('show-chains').click()")
        forces = self.seen()
        # Lines are red, unlike any species.
        red = np.mean((forces[..., 0] > 0.3) & (forces[..., 1:].max(axis=-1) < 0.5 * forces[..., 0]))
        self.assertGreater(red, 0.002)
        self.assertLess(np.mean(coloured(forces)), 0.6 * np.mean(coloured(whole)))
        self.value("document.getElementById('show-chains').click()")
        self.assertEqual(changed(whole, self.seen()), 0)
        self.assertEqual(self.browser.complaints(), [])

    def test_axes_are_caps_of_oriented_spheres(self):
        box = "document.getElementById('show-axes')"
        self.open("settling")
        self.assertFalse(self.value(f"{box} !== null"))
        self.open("swimming")
        plain = self.seen()
        self.value(f"{box}.click()")
        capped = self.seen()
        # Caps are dark and gray.
        dark = [np.mean((picture.max(axis=-1) < 0.3) & ~coloured(picture)) for picture in (plain, capped)]
        self.assertGreater(dark[1], dark[0] + 0.005)
        self.browser.press("End")
        self.assertGreater(changed(capped, self.seen()), 0.005)
        self.browser.press("Home")
        self.value(f"{box}.click()")
        self.assertEqual(changed(plain, self.seen()), 0)
        self.assertEqual(self.browser.complaints(), [])

    def test_keys_step_and_play(self):
        self.open("settling")
        frame = "document.getElementById('frame').valueAsNumber"
        self.browser.press("ArrowRight")
        self.assertEqual(self.value(frame), 1)
        self.assertEqual(self.value("document.getElementById('time').textContent"), "time 0.25, step 10")
        self.browser.press("ArrowLeft")
        self.browser.press("ArrowLeft")
        self.assertEqual(self.value(frame), 4, "before the first comes the last")
        self.browser.press(" ")
        self.browser.until(f"{frame} === 2")
        self.assertEqual(self.value("document.getElementById('play').textContent"), "Pause")
        self.browser.press(" ")
        self.assertEqual(self.value("document.getElementById('play').textContent"), "Play")

    def test_the_picture_can_be_turned(self):
        self.open("cell")
        before = self.seen()
        x, y = (self.browser.place(PICTURE)[key] + 200 for key in ("x", "y"))
        for kind, across in [("mousePressed", 0), ("mouseMoved", 150), ("mouseReleased", 150)]:
            where = {"x": x + across, "y": y, "button": "left", "buttons": 1, "clickCount": 1}
            self.browser.call("Input.dispatchMouseEvent", type=kind, **where)
        self.assertGreater(changed(before, self.seen()), 0.05)
        self.value("document.getElementById('reset').click()")
        self.assertEqual(changed(before, self.seen()), 0)

    def test_charts_have_lines(self):
        for name in SCENES:
            with self.subTest(name):
                self.open(name)
                boxes = "[...document.querySelectorAll('svg .line')].map(line => line.getBoundingClientRect().width)"
                self.assertGreater(len([width for width in self.value(boxes) if width > 100]), 4)

    def test_a_run_without_frames_is_a_page_of_charts(self):
        out = pathlib.Path(PLACE.name) / "continuum"
        run(["run", ROOT / "scenes" / "shear-cell-continuum.toml", "--out", out])
        run(["report", out])
        self.browser.open(out / "report.html")
        self.assertEqual(self.value("document.querySelectorAll('svg').length"), 3)
        self.assertEqual((self.value("document.querySelectorAll('canvas').length"), self.browser.complaints()), (0, []))
