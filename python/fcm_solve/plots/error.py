"""Errors of plots, each with a message of one line."""

from contextlib import contextmanager


class PlotError(Exception):
    """Error if nothing can be drawn; the message names the file and says what to do."""


@contextmanager
def damage(path):
    """Converts any exception while a file is read into an error that names the file."""
    try:
        yield
    except PlotError:
        raise
    except KeyError as error:
        raise PlotError(f"{path} is damaged, or of another program: it has no {error.args[0]!r}") from error
    except OSError as error:
        raise PlotError(f"can't read {path}: {reason(error)}") from error
    except Exception as error:  # noqa: BLE001 - the content of a file may be anything
        raise PlotError(f"{path} is damaged: {reason(error)}") from error


def reason(error):
    """The message of an exception on one line."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(text.split())[:200]
