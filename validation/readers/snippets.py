"""The snippets of the documentation that open a run's files, by the program that they are for."""

import re

from program import ROOT

PAGE = ROOT / "docs" / "src" / "file-formats.md"
STARTS = "Starts from files"


def snippets():
    """The snippets of each heading below `In other programs`, and those of `Starts from files`."""
    parts = re.split(r"^### (.*)$", section("In other programs"), flags=re.MULTILINE)[1:]
    found = {name: blocks("python", text) for name, text in zip(parts[::2], parts[1::2])}
    return found | {STARTS: blocks("python", section(STARTS))}


def blocks(language, text):
    """The blocks of a language in a text."""
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def section(heading):
    """The text below a heading, up to the next one of its level."""
    return re.search(rf"^## {heading}$(.*?)(?=^## |\Z)", PAGE.read_text(), re.MULTILINE | re.DOTALL)[1]
