"""Output files of figures."""

import os
from pathlib import Path

from .error import PlotError, reason

FORMATS = ("png", "svg", "pdf")


def checked(picture, formats):
    """The path, if its suffix is that of an allowed format and its folder exists."""
    picture = Path(picture)
    if picture.suffix.lower().lstrip(".") not in formats:
        raise PlotError(f"{picture} must end in one of " + ", ".join(f".{name}" for name in formats))
    if picture.is_dir():
        raise PlotError(f"{picture} is a folder; name a file")
    if not picture.parent.is_dir():
        raise PlotError(f"{picture} can't be written: there is no folder {picture.parent}")
    return picture


def save(figure, picture):
    """Writes a figure in the format of the file's suffix."""
    write(checked(picture, FORMATS), figure.savefig)


def write(picture, store):
    """Calls a function that writes a file to a path, such that the file is complete or absent."""
    from . import style

    part = picture.with_name(f".{picture.stem}.part{picture.suffix}")
    try:
        with style.applied():
            store(part)
        os.replace(part, picture)
    except OSError as error:
        raise PlotError(f"can't write {picture}: {reason(error)}") from error
    finally:
        part.unlink(missing_ok=True)
