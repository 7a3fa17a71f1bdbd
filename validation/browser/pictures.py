"""Makes the pictures of the documentation that show reports: runs scenes, and opens their pages in a browser."""

import argparse
import pathlib
import subprocess
import sys
from dataclasses import dataclass

from PIL import Image, ImageChops

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "program"))
from browser import Browser
from program import ROOT, TARGET, command

FIGURES = ROOT / "docs" / "src" / "figures"
RUNS = TARGET / "gallery"
# Number of colours of a picture: more would only increase its size.
COLOURS = 256

# Margin of a cropped picture in pixels.
MARGIN = 6

# Scene and settings of each run.
SCENES = {
    "settling": ("settling", {"statistics.every": 4}),
    "sheared": ("shear", {"time.duration": 1.4, "statistics.every": 4}),
    "segregation": ("segregation", {}),
    "disks": ("granular-disks", {"time.strain": 20.4, "output.trajectory_every": 680}),
    "cell": ("shear-cell", {}),
}


@dataclass
class Picture:
    """The part of a run's page that a picture shows."""

    run: str
    colours: str
    # In pixels, from the top of the page.
    size: tuple
    # Only the view of the player, or the whole page.
    alone: bool
    frame: int = -1


PICTURES = {
    "report-suspension": Picture("settling", "speed", (1000, 1260), alone=False),
    "report-sheared": Picture("sheared", "species", (1000, 830), alone=False, frame=10),
    "report-disks": Picture("disks", "species", (1000, 830), alone=False),
    "gallery-settling": Picture("settling", "speed", (420, 620), alone=True),
    "gallery-shear": Picture("sheared", "species", (560, 620), alone=True, frame=10),
    "gallery-segregation": Picture("segregation", "species", (420, 620), alone=True),
    "gallery-disks": Picture("disks", "species", (560, 620), alone=True),
    "gallery-shear-cell": Picture("cell", "speed", (420, 620), alone=True),
}


def page(name):
    """The page about a run, which is made or continued first if necessary."""
    scene, sets = SCENES[name]
    words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
    for arguments in (
        ["run", ROOT / "scenes" / f"{scene}.toml", "--out", RUNS / name, "--continue", *words],
        ["report", RUNS / name],
    ):
        subprocess.run(command(arguments), check=True)
    return RUNS / name / "report.html"


def take(picture, path):
    """Takes a picture of a page."""
    with Browser(*picture.size) as browser:
        browser.open(page(picture.run))
        browser.choose(picture.colours)
        browser.press("Home" if picture.frame >= 0 else "End")
        for _ in range(picture.frame):
            browser.press("ArrowRight")
        browser.picture(path, "#picture canvas" if picture.alone else None)
        if browser.complaints():
            raise SystemExit(f"{path}: {browser.complaints()}")
    image = Image.open(path).convert("RGB")
    if picture.alone:
        image = cropped(image)
    colours = {"colors": COLOURS, "method": Image.Quantize.FASTOCTREE, "dither": Image.Dither.NONE}
    image.quantize(**colours).save(path, optimize=True)


def cropped(image):
    """The part of a picture that is not white, with a margin."""
    white = Image.new("RGB", image.size, "white")
    left, upper, right, lower = ImageChops.difference(image, white).point(lambda value: 255 * (value > 8)).getbbox()
    return image.crop((left - MARGIN, upper - MARGIN, right + MARGIN, lower + MARGIN))


def main():
    parser = argparse.ArgumentParser(prog="scripts/gallery", description=__doc__)
    parser.add_argument("picture", nargs="*", default=[*PICTURES], help=f"{', '.join(PICTURES)} [all]")
    for name in parser.parse_args().picture:
        path = FIGURES / f"{name}.png"
        take(PICTURES[name], path)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
