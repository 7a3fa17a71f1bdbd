"""The formulas of the book, as displayed."""

import re
import sys
import unittest

from program import ROOT

sys.path.insert(0, str(ROOT / "validation" / "book"))
import formulas
import rendered

RIGHT = r"""Of \\(x\\, y^\*\\), `\(code\)` and

\\[ \begin{pmatrix} a_{1} \\\\ b \end{pmatrix} = \left| \frac{d}{dz} \right| f', \\]

<!-- \frac --> all is seen:

    export PATH="$PWD"
"""
# Pages, and the beginnings of the reported faults.
WRONG = (
    ("lost blank", r"\\(1 - 6.55\,\phi\\)", r"1: Markdown takes the backslash of \,: write \\,"),
    ("lost brace", "\nthe set \\\\(\\{x\\}\\\\)", "2: Markdown takes the backslash of \\{"),
    ("lost new line", r"\\(\begin{matrix} a \\ b \end{matrix}\\)", "1: two backslashes are seen as a blank"),
    ("emphasis by stars", r"\\(x^* = y^*\\)", "1: * marks emphasis"),
    ("emphasis by a low line", r"\\(\dot{x}_t = y_{n}\\)", "1: _ after punctuation"),
    ("tag", r"\\(a <b\\)", "1: < before a letter"),
    ("list", "\\\\(a\n+ b\\\\)", "1: a line that begins like that of a list"),
    ("quotation", "\\\\(a\n> b\\\\)", "1: a line that begins with >"),
    ("one backslash", r"the sum \(a\)", "1: \\( is no mark"),
    ("no mark", r"\frac12 of it", r"1: \frac is outside"),
    ("dollars", r"of $x$", "1: $ is no mark"),
    ("not closed", r"\\(a \\[ b \\]", r"1: \\[ does not match"),
    ("never closed", "\n\\\\(a", r"2: \\( is not closed"),
    ("not opened", r"a\\)", r"1: \\) does not match"),
)


class Source(unittest.TestCase):
    def test_formulas_of_the_book_are_written_so_that_they_are_seen(self):
        count, faults = 0, []
        for path in sorted(rendered.SOURCE.glob("*.md")):
            found, wrong = formulas.read(path.read_text())
            count += len(found)
            faults += [f"{path.name}:{fault}" for fault in wrong]
        self.assertEqual(faults, [])
        self.assertGreater(count, 400)

    def test_a_formula_is_what_is_left_of_its_source(self):
        found, faults = formulas.read(RIGHT)
        self.assertEqual(faults, [])
        self.assertEqual([formula.line for formula in found], [1, 3])
        self.assertEqual(found[0].meant, r"x\, y^*")
        self.assertIn(r"a_{1} \\ b", found[1].meant)

    def test_each_fault_of_a_page_is_named_with_its_line(self):
        for name, page, expected in WRONG:
            with self.subTest(name):
                faults = formulas.read(page)[1]
                self.assertTrue(faults)
                self.assertTrue(faults[0].startswith(expected), faults)


class Credits(unittest.TestCase):
    def test_the_sources_that_use_a_reference_exist(self):
        text = (rendered.SOURCE / "credits.md").read_text()
        named = re.findall(r"`([a-z-]+/[a-z0-9_/.-]+)`", text)
        self.assertGreater(len(named), 40)
        self.assertEqual([name for name in named if not (ROOT / name).exists()], [])


class Page(unittest.TestCase):
    def faults(self, source, page):
        found, left = rendered.read(f"<p>\\frac</p><main>{page}</main>")
        return [*left, *rendered.compare(formulas.read(source)[0], found)]

    def test_a_page_with_the_formulas_of_its_source_is_right(self):
        page = r"<p>Of \(x\, y^*\) &amp; <code>\(b\)</code>, \[ a &lt; 1 \]</p><pre>\frac</pre>"
        self.assertEqual(self.faults(r"Of \\(x\\, y^\*\\) & `\(b\)`, \\[ a < 1 \\]", page), [])

    def test_what_a_page_loses_is_seen(self):
        for name, source, page, expected in (
            ("command", r"\\(a\, b\\)", r"\(a, b\)", r"line 1: a\, b is seen as a, b"),
            ("prime", r"\\(f'\\)", r"\(f’\)", "line 1: f' is seen as f’"),
            ("formula", r"\\(a\\) and \\(b\\)", r"\(a\)", "2 formulas in the source, 1 on the page"),
            ("emphasis", r"\\(x^* y^*\\)", r"\(x^<em> y^</em>\)", r"\( is seen as it stands"),
            ("raw", r"\frac12", r"<p>\frac12</p>", r"\frac is seen as it stands"),
        ):
            with self.subTest(name):
                faults = self.faults(source, page)
                self.assertTrue(faults[0].startswith(expected), faults)
