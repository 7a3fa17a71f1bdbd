"""Style of figures: as wide as a journal page, with letters legible at that size, in colours that are distinguishable
with colour blindness."""

import logging
import warnings
from contextlib import contextmanager

import matplotlib
import numpy as np
from cycler import cycler
from matplotlib import font_manager

# Width of a page with two columns, in inches.
PAGE = 7.0
# Palette of Okabe & Ito.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"]
GRAY, LIGHT = "0.35", "0.75"
# Fallback fonts for letters that the default font lacks; the first one that is installed is used.
OTHER_FONTS = ["Noto Sans CJK JP", "Noto Sans CJK SC", "WenQuanYi Zen Hei", "Droid Sans Fallback", "Noto Sans"]


def colours(count):
    """`count` distinguishable colours: from a palette for few, from a colour map for many."""
    if count <= len(COLOURS):
        return COLOURS[:count]
    return [matplotlib.colors.to_hex(colour) for colour in matplotlib.colormaps["viridis"](np.linspace(0, 0.92, count))]


def fonts():
    """The fonts to take letters from, in order of preference."""
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return ["DejaVu Sans", *(name for name in OTHER_FONTS if name in installed)]


def settings():
    """The parameters for matplotlib."""
    return {
        "axes.prop_cycle": cycler(color=COLOURS),
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.formatter.useoffset": False,
        "axes.linewidth": 0.7,
        "font.family": fonts(),
        "font.size": 8,
        "axes.titlesize": 8,
        "axes.labelsize": 8,
        "figure.titlesize": 8,
        "xtick.labelsize": 7,
        "ytick.labelsize": 7,
        "legend.fontsize": 7,
        "legend.frameon": False,
        "legend.handlelength": 1.6,
        "lines.linewidth": 1.2,
        "figure.dpi": 200,
        "savefig.dpi": 200,
        "svg.fonttype": "none",
        "pdf.fonttype": 42,
    }


@contextmanager
def applied():
    """Context manager for drawing in this style, without warnings of matplotlib about missing glyphs or small panels."""
    logger = logging.getLogger("matplotlib")
    level = logger.level
    with matplotlib.rc_context(settings()), warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        logger.setLevel(logging.ERROR)
        try:
            yield
        finally:
            logger.setLevel(level)


def _width(labels, columns):
    """Width of a legend's rows in letters, including line samples; its columns are filled one after another."""
    rows = -(-len(labels) // columns)
    return sum(5 + max(map(len, labels[start : start + rows])) for start in range(0, len(labels), rows))


def legend_above(axes, room=46):
    """Draws a legend above the axes, where it covers no data, with a limit on the letters per row; none for fewer than two
    entries."""
    handles, labels = axes.get_legend_handles_labels()
    if len(handles) > 1:
        columns = next((n for n in range(min(4, len(labels)), 1, -1) if _width(labels, n) <= room), 1)
        options = {"loc": "lower left", "bbox_to_anchor": (0, 1.0), "ncols": columns, "borderaxespad": 0.2}
        axes.legend(handles, labels, columnspacing=1.2, handletextpad=0.5, labelspacing=0.25, **options)
