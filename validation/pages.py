"""Rewrites pages that show commands with their output; names of pages, such as `viscosity`, select some."""

import pathlib
import sys
import tempfile

from support.console import PAGES, prepare, run_page


def main():
    chosen = [page for page in PAGES if page.stem in sys.argv[1:]] or PAGES
    for page in chosen:
        text = page.read_text()
        with tempfile.TemporaryDirectory() as folder:
            prepare(text, pathlib.Path(folder))
            page.write_text(run_page(text, pathlib.Path(folder)))
        print(page)


if __name__ == "__main__":
    main()
