"""HTML pages about runs, as files and in notebooks."""

from __future__ import annotations

from html import escape
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory

from . import _core
from .results import Run


def report(run: Run | str | PathLike, path: str | PathLike | None = None) -> Path:
    """Writes a page about a run: one HTML file with charts and a player of the trajectory, which needs no network.

    run   a `Run`, or its folder
    path  the file; by default report.html in the folder of the run

    Returns the path of the file, which is the same as `fcm-solve report` writes.
    """
    folder = _folder(run)
    path = folder / "report.html" if path is None else Path(path)
    _core.write_report(str(folder), str(path))
    return path


def show(run: Run | str | PathLike, height: int = 700) -> Page:
    """The page about a run, to be shown as the last value of a notebook cell in a frame of `height` pixels."""
    with TemporaryDirectory() as folder:
        return Page(report(run, Path(folder) / "report.html").read_text(), height)


class Page:
    """An HTML page with a notebook representation."""

    def __init__(self, html: str, height: int) -> None:
        self.html = html
        """The HTML text of the page."""
        self._height = int(height)

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self._height}px; border: 0"
        return f'<iframe srcdoc="{escape(self.html)}" style="{style}" sandbox="allow-scripts"></iframe>'

    def __repr__(self) -> str:
        return f"<fcm_solve page of {len(self.html)} characters; notebooks show it>"


def _folder(run: Run | str | PathLike) -> Path:
    return run.folder if isinstance(run, Run) else Path(run)
