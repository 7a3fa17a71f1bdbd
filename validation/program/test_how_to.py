"""Every command of the how-to pages runs as printed, and prints what the page says, but for numbers."""

import pathlib
import sys
import tempfile
import unittest

from program import ROOT

sys.path.insert(0, str(ROOT / "validation"))

from support.console import BLOCK, run_page, without_numbers  # noqa: E402


class HowTo(unittest.TestCase):
    def test_commands_print_what_the_pages_say(self):
        pages = sorted((ROOT / "docs" / "src" / "how-to").glob("*.md"))
        self.assertTrue(pages)
        for page in pages:
            text = page.read_text()
            with self.subTest(page=page.stem), tempfile.TemporaryDirectory() as folder:
                now = run_page(text, pathlib.Path(folder))
                shown = [without_numbers(block) for block in BLOCK.findall(text)]
                self.assertEqual([without_numbers(block) for block in BLOCK.findall(now)], shown)
