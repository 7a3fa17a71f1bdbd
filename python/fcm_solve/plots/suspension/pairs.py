"""The panel of pair distributions."""

from ..panel import Panel
from ..style import colours
from ..text import shown

# Largest number of pairs of species that can be distinguished.
MOST = 6


def distribution(run):
    """Pair distribution function of each pair of species, from the statistics."""
    table = run.statistics.get("pairs")
    if table is None or not table.has("first", "second", "distance", "g"):
        return None
    panel = Panel(run, ("distance", "length"), ("pair distribution g(r)", ""), level=1)
    pairs = list(dict.fromkeys(zip(table["first"].tolist(), table["second"].tolist())))[:MOST]
    for (first, second), colour in zip(pairs, colours(len(pairs))):
        rows = table.where(first=first, second=second)
        label = shown(first, 14) if first == second else f"{shown(first, 14)} \u2013 {shown(second, 14)}"
        panel.add(rows["distance"], rows["g"], label if len(pairs) > 1 else "", colour=colour)
    return panel
