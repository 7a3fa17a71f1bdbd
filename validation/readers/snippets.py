"""The snippets of the documentation that open a run's files, by the program that they are for."""

import re

from program import ROOT

PAGE = ROOT / "docs" / "src" / "file-formats.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


STARTS = "Starts from files"


def snippets():
    """The snippets of each heading below `In other programs`, and those of `Starts from files`."""
    parts = re.split(r"^### (.*)$", section("In other programs"), flags=re.MULTILINE)[1:]
    found = {name: BLOCK.findall(text) for name, text in zip(parts[::2], parts[1::2])}
    return found | {STARTS: BLOCK.findall(section(STARTS))}


def section(heading):
    """The text below a heading, up to the next one of its level."""
    return re.search(rf"^## {heading}$(.*?)(?=^## |\Z)", PAGE.read_text(), re.MULTILINE | re.DOTALL)[1]
