"""The how-to pages: each command with what it prints. Writes them anew; names of pages, such as `viscosity`, choose some."""

import pathlib
import sys
import tempfile

from support.console import run_page
from support.page import BOOK

PAGES = sorted((BOOK / "how-to").glob("*.md"))


def main():
    chosen = [page for page in PAGES if page.stem in sys.argv[1:]] or PAGES
    for page in chosen:
        with tempfile.TemporaryDirectory() as folder:
            page.write_text(run_page(page.read_text(), pathlib.Path(folder)))
        print(page)


if __name__ == "__main__":
    main()
