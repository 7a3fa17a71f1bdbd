"""The command that draws results."""

import argparse
import logging
import pathlib
import sys

from . import PlotError, animate, draw, save
from .error import reason
from .output import FORMATS, checked

DESCRIPTION = "Draws a picture to judge a run by, of any kind of scene, or the curves of a family of runs."
EXAMPLES = """examples:
  %(prog)s results/my                    results/my/picture.png
  %(prog)s results/my --format svg       results/my/picture.svg
  %(prog)s results/my figure.pdf         the picture in another place
  %(prog)s results/my --only relative_viscosity
  %(prog)s results/disks --by species    disks gray by species
"""


def parser(program):
    """The parser of the command line."""
    options = {"description": DESCRIPTION, "epilog": EXAMPLES, "formatter_class": argparse.RawDescriptionHelpFormatter}
    parser = argparse.ArgumentParser(prog=program, **options)
    parser.add_argument("folder", type=pathlib.Path, help="the results of a run, or of a family of runs")
    where = "where it goes, .png, .svg or .pdf; picture.png in the folder by default"
    parser.add_argument("picture", type=pathlib.Path, nargs="?", help=where)
    what = "what colours, or the gray of disks, say: excess velocity over the fluid's (the default), speed or species"
    parser.add_argument("--by", choices=("excess", "speed", "species"), default="excess", help=what)
    one = "one quantity of the answers, such as relative_viscosity, alone"
    parser.add_argument("--only", metavar="QUANTITY", help=one)
    parser.add_argument("--format", choices=FORMATS, help="the format, where no picture is named")
    parser.add_argument("--animate", action="store_true", help="all frames of disks, as a GIF")
    return parser


def picture_of(arguments):
    """The path of the output file."""
    formats, picture = ("gif",) if arguments.animate else FORMATS, arguments.picture
    if picture is None:
        return arguments.folder / f"picture.{formats[0] if arguments.animate else arguments.format or formats[0]}"
    if arguments.format is not None and picture.suffix.lower() != f".{arguments.format}":
        raise PlotError(f"{picture} and --format {arguments.format} name two formats; omit --format")
    return checked(picture, formats)


def carry_out(arguments):
    """Draws the figure, and prints its path and the parts left out of it."""
    picture, notes = picture_of(arguments), []
    if arguments.animate:
        animate(arguments.folder, picture, arguments.by)
    else:
        save(draw(arguments.folder, arguments.by, arguments.only, notes), picture)
    lines = [*(f"left out   {note}" for note in notes), f"picture    {picture}"]
    try:
        print("\n".join(lines), flush=True)
    except OSError as error:
        raise PlotError(f"{picture} was drawn, but the message can't be written: {reason(error)}") from error


def main(words=None, program="plot"):
    """Runs the command; returns the exit status, 1 after an error, which is printed in one line."""
    # Suppresses messages of matplotlib about its folders and fonts.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    arguments = parser(program).parse_args(words)
    try:
        carry_out(arguments)
    except PlotError as error:
        return _failed(str(error))
    except ModuleNotFoundError as error:
        return _failed(f"plots need {error.name}, which is not installed: pip install {error.name}")
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # noqa: BLE001 - a bug of this program; a traceback would not help the user
        what = " ".join(f"{type(error).__name__}: {error}".split())
        return _failed(
            f"can't draw {arguments.folder} ({what}); its files are damaged, or this is a fault of the program"
        )
    return 0


def _failed(message):
    print(f"error: {message}", file=sys.stderr)
    return 1
