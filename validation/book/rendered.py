"""Checks that every formula of the built book agrees with its source: rendered.py BOOK KATEX

BOOK is the folder of the built book, KATEX that of the library that renders its formulas. Each page must have the formulas of the source in
the same order and no LaTeX in its text, and the library must render each without an error."""

import html.parser
import json
import pathlib
import re
import subprocess
import sys

import formulas

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "src"
DRAW = pathlib.Path(__file__).with_name("draw.js")
# Elements that the library skips.
NOT_DRAWN = {"script", "noscript", "style", "textarea", "pre", "code", "option"}
DRAWN = re.compile(r"\\\((.*?)\\\)|\\\[(.*?)\\\]|\$\$(.*?)\$\$", re.S)


class Passages(html.parser.HTMLParser):
    """The text of the page's `main` in pieces between tags, as the library sees it."""

    def __init__(self):
        super().__init__()
        self.passages, self.hidden, self.inside = [], [], False

    def handle_starttag(self, tag, attrs):
        if tag == "main":
            self.inside = True
        elif tag in NOT_DRAWN:
            self.hidden.append(tag)

    def handle_endtag(self, tag):
        if tag == "main":
            self.inside = False
        elif self.hidden and self.hidden[-1] == tag:
            self.hidden.pop()

    def handle_data(self, data):
        if self.inside and not self.hidden:
            self.passages.append(data)


def read(page):
    """The formulas of a page in HTML and a list of faults."""
    parser = Passages()
    parser.feed(page)
    parser.close()
    found, faults = [], []
    for passage in parser.passages:
        found += [next(filter(None, match), "") for match in DRAWN.findall(passage)]
        left = DRAWN.sub(" ", passage)
        faults += [f"{match[0]} is seen as it stands: {around(left, match)}" for match in re.finditer(r"\\(?:[A-Za-z]+|[()\[\]])", left)]
    return found, faults


def around(text, match):
    return " ".join(text[max(0, match.start() - 40) : match.end() + 40].split())


def compare(source, found):
    """Differences between the formulas of a page and those of its source."""
    meant = [formula.meant for formula in source]
    if len(meant) != len(found):
        yield f"{len(meant)} formulas in the source, {len(found)} on the page"
    for formula, seen in zip(source, found):
        if formula.meant.split() != seen.split():
            yield f"line {formula.line}: {formula.source.strip()} is seen as {seen.strip()}"
            return


def complaints(found, katex):
    """Errors of the library in rendering formulas."""
    drawn = subprocess.run(["node", DRAW, katex], input=json.dumps(found), capture_output=True, text=True, check=True)
    return json.loads(drawn.stdout)


def main(book, katex):
    wrong, count = [], 0
    for path in sorted(SOURCE.glob("*.md")):
        page = pathlib.Path(book) / f"{path.stem}.html"
        if not page.exists():
            continue
        source, faults = formulas.read(path.read_text())
        found, left = read(page.read_text())
        count += len(found)
        wrong += [f"{path.name}: {fault}" for fault in [*faults, *left, *compare(source, found), *complaints(found, katex)]]
    print("\n".join([*wrong, f"{count} formulas, {len(wrong)} faults"]))
    return bool(wrong) or not count


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
