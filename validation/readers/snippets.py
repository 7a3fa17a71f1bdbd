"""The snippets of the documentation that open a run's files, by the program that they are for."""

import re

from program import ROOT

PAGE = ROOT / "docs" / "src" / "file-formats.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def snippets():
    """The snippets of each heading below `In other programs`."""
    section = re.search(r"^## In other programs$(.*?)^## ", PAGE.read_text(), re.MULTILINE | re.DOTALL)[1]
    parts = re.split(r"^### (.*)$", section, flags=re.MULTILINE)[1:]
    return {name: BLOCK.findall(text) for name, text in zip(parts[::2], parts[1::2])}
