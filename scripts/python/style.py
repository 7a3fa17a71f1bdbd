"""How pictures look: as wide as a journal's page, with letters that can be read there, in colours that all tell apart."""

import matplotlib
from cycler import cycler

# Inches: the width of a page with two columns.
PAGE = 7.0
# Okabe & Ito.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"]


def use():
    """Makes it the style of all pictures from here on. What is no drawing has 200 dots an inch."""
    matplotlib.use("Agg")
    matplotlib.rcParams.update(
        {
            "axes.prop_cycle": cycler(color=COLOURS),
            "axes.spines.top": False,
            "axes.spines.right": False,
            "font.size": 8,
            "axes.titlesize": 8,
            "figure.titlesize": 8,
            "xtick.labelsize": 7,
            "ytick.labelsize": 7,
            "legend.fontsize": 7,
            "legend.frameon": False,
            "lines.linewidth": 1.2,
            "savefig.dpi": 200,
        }
    )
