"""Output of a figure: its picture, its data, the rows of comparisons, and the page of the documentation with all of these."""

import argparse
import csv
import fnmatch
import json
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from runs import ROOT

DATA = ROOT / "validation" / "data" / "figures"
PICTURES = ROOT / "docs" / "src" / "figures"
# The pages: the figures on each, and the file with its introduction.
PAGES = {"figures": ("fig*", "about"), "disks": ("disks-*", "about_disks"), "shear-cell": ("shear-cell", "about_shear_cell")}


class Report:
    """The rows, curves and axes of one figure."""

    def __init__(self, name, mode, title, panels=1):
        self.name, self.mode, self.title = name, mode, title
        self.rows, self.curves = [], []
        self.figure, axes = plt.subplots(1, panels, figsize=(5.6 * panels, 4.2), layout="constrained", squeeze=False)
        self.panels = axes[0]
        self.figure.suptitle(f"{title} ({mode})", fontsize=10)

    def points(self, label, x, found, panel=0, **style):
        """Measured points, `found` as (value, error)."""
        values, errors = zip(*found)
        bars = [error if math.isfinite(error) else 0.0 for error in errors]
        self.panels[panel].errorbar(x, values, bars, label=label, capsize=2, markersize=5, **style)
        self.curves += [(label, *row) for row in zip(x, values, errors)]

    def curve(self, label, x, y, panel=0, **style):
        """A line without errors."""
        self.panels[panel].plot(x, y, label=label, **style)
        self.curves += [(label, a, b, math.nan) for a, b in zip(x, y)]

    def compare(self, quantity, reference, expected, found, tolerance=0.1):
        """Compares a number with a theory or the paper; they agree within two errors or the tolerance."""
        value, error = found
        apart = value - expected
        fine = abs(apart) <= max(2 * error if math.isfinite(error) else 0.0, tolerance * abs(expected))
        verdict = "agrees" if fine else f"{100 * apart / expected:+.0f}%"
        self.rows.append([quantity, f"{reference}: {expected:.4g}", shown(found), verdict])

    def state(self, quantity, reference, found, holds):
        """Records a statement of the paper and whether it holds."""
        self.rows.append([quantity, reference, found, "yes" if holds else "no"])

    def label(self, x, y, panel=0, **axes):
        """Labels the axes; others go to `set`."""
        self.panels[panel].set(xlabel=x, ylabel=y, **axes)
        self.panels[panel].legend(fontsize=7)

    def save(self):
        """Writes the picture, the data, and the page."""
        DATA.mkdir(parents=True, exist_ok=True)
        self.figure.savefig(PICTURES / f"{self.name}.png", dpi=90)
        plt.close(self.figure)
        with open(DATA / f"{self.name}.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["curve", "x", "y", "error"])
            table.writerows([label, *(f"{number:.6g}" for number in numbers)] for label, *numbers in self.curves)
        judged = {"title": self.title, "mode": self.mode, "rows": self.rows}
        (DATA / f"{self.name}.json").write_text(json.dumps(judged, indent=1, ensure_ascii=False) + "\n")
        write_page(next(page for page, (figures, _) in PAGES.items() if fnmatch.fnmatch(self.name, figures)))
        print(f"{self.title} ({self.mode})")
        for row in self.rows:
            print("  " + " | ".join(row))
        print(f"figure     {PICTURES / self.name}.png\ndata       {DATA / self.name}.csv")


def root(found):
    """The square root of a number with an error."""
    value, error = found
    return value**0.5, 0.5 * error / value**0.5


def shown(found):
    """A value with its error."""
    value, error = found
    return f"{value:.4g} ± {error:.1g}" if math.isfinite(error) else f"{value:.4g}"


def number(path):
    """Number of a figure; figures that are not in the paper come last."""
    return int(path.stem.partition("fig")[2] or 1000)


def table(columns, rows):
    """The lines of a table."""

    def line(cells):
        return "| " + " | ".join(cells) + " |"

    return [line(columns), "|" + "---|" * len(columns), *map(line, rows)]


def write_page(page):
    """Writes a page: its introduction, and all of its figures that have been made."""
    figures, about = PAGES[page]
    lines = [(ROOT / "validation" / "figures" / f"{about}.md").read_text().rstrip()]
    cost = DATA / "cost.json"
    if page == "figures" and cost.exists():
        lines += ["", "## Cost of the runs", "", "`scripts/reproduce cost`", "", *table(**json.loads(cost.read_text()))]
    for path in sorted(DATA.glob(f"{figures}.json"), key=number):
        judged = json.loads(path.read_text())
        lines += ["", f"## {judged['title']}", "", f"`scripts/reproduce {path.stem} --{judged['mode']}`", ""]
        lines += table(["quantity", "paper or theory", "here", "verdict"], judged["rows"])
        lines += ["", f"![{judged['title']}](figures/{path.stem}.png)"]
    (ROOT / "docs" / "src" / f"{page}.md").write_text("\n".join(lines) + "\n")


def main(make):
    """Makes a figure with the options of the command line."""
    parser = argparse.ArgumentParser(description=make.__doc__)
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--quick", dest="mode", action="store_const", const="quick", help="minutes, small samples (default)")
    how.add_argument("--full", dest="mode", action="store_const", const="full", help="length and size of the paper")
    parser.set_defaults(mode="quick")
    make(parser.parse_args().mode).save()
