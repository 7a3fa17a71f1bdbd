"""Messages in the source of the program, as a user sees them."""

import re
import unittest

from program import ROOT

# Comments, characters and raw strings are not messages; the rest are strings.
TOKEN = re.compile(
    r"//[^\n]*|/\*.*?\*/|'(?:\\[^\n]|[^'\\\n])'|\bb?r(#*)\".*?\"\1|\"(?P<text>(?:[^\"\\]|\\.)*)\"",
    re.S,
)
# Repeated blanks after two or more words of a line; after one word they separate a label.
GAP = re.compile(r"\S+ \S.*? {2,}\S")
# Longer texts are pages, which have columns.
PAGE = 4
PACKAGES = """domain simd solver fcm lubrication hydrodynamics statistics simulation suspension granular io/scene io/files
    io/report io/run fcm-solve python fuzz""".split()


def gaps(source):
    """The strings of a Rust source with unintended repeated blanks or line breaks."""
    source = source.split("#[cfg(test)]")[0]
    for token in TOKEN.finditer(source):
        text = re.sub(r"\\\n\s*", "", token["text"] or "")
        broken = 0 < text.count("\n") < PAGE and re.search(r"\w[,;]?\n +\w", text)
        if broken or ("\n" not in text and any(map(GAP.search, text.split("\\n")))):
            yield text


class Messages(unittest.TestCase):
    def test_no_message_has_two_blanks_in_a_row(self):
        sources = [path for package in PACKAGES for path in (ROOT / package / "src").rglob("*.rs")]
        self.assertGreater(len(sources), 300)
        found = [f"{path.relative_to(ROOT)}: {text}" for path in sources for text in gaps(path.read_text())]
        self.assertEqual(found, [])

    def test_a_lost_continuation_is_found(self):
        self.assertEqual(list(gaps('f("as much              shorter")')), ["as much              shorter"])
        self.assertEqual(len(list(gaps('f("as much\n         shorter")'))), 1)
        for right in ('"as much \\\n    shorter"', '"repulsion  strength"', "// a  \"b  c\"", "r\"a  b\" '\"' \"a\""):
            self.assertEqual(list(gaps(right)), [], right)
