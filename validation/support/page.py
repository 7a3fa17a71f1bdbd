"""Generated sections of documentation pages."""

import pathlib
import re
import sys

BOOK = pathlib.Path(__file__).resolve().parents[2] / "docs" / "src"
FIGURES = BOOK / "figures"


def write_section(page, name, title, lines, command=None):
    """Writes a title, the command, by default that of `scripts/validate`, and lines between the marks `<!-- name -->` and
    `<!-- /name -->` of a page."""
    path = BOOK / page
    text = path.read_text()
    pattern = re.compile(rf"(<!-- {re.escape(name)} -->\n).*?(<!-- /{re.escape(name)} -->)", re.S)
    if not pattern.search(text):
        raise SystemExit(f"{path} has no section <!-- {name} -->")
    command = command or " ".join(["scripts/validate", name, *(word for word in sys.argv[1:] if word not in name.split())])
    body = f"\n## {title}: `{command}`\n\n" + "\n".join(lines).strip() + "\n\n"
    path.write_text(pattern.sub(lambda match: match[1] + body + match[2], text))


def table(header, rows):
    """The lines of a table."""
    return ["| " + " | ".join(row) + " |" for row in (header, ["---"] * len(header), *rows)]


def save(figure, name):
    """Saves a figure of the book."""
    import matplotlib.pyplot as plt

    figure.savefig(FIGURES / name, dpi=90)
    plt.close(figure)
