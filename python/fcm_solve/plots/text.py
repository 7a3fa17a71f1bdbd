"""Text of users, such as names of species, made safe for matplotlib."""

from functools import lru_cache

from matplotlib import font_manager

from .style import fonts

LONGEST = 32
# Replacement for a letter that no font has.
MISSING = "\u25a1"


def shown(text, longest=LONGEST):
    """A name without mathematical markup, line breaks, excess length, leading `_` (which hides a label from legends), and
    letters that no font has."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    text = text if len(text) <= longest else text[: longest - 1].rstrip() + "\u2026"
    text = "".join(c if ord(c) in _letters() else MISSING for c in text)
    text = text.replace("$", r"\$")
    return " " + text if text.startswith("_") else text


def words(name):
    """The name of a table's quantity in words: "storage modulus" for `storage_modulus`."""
    return shown(name.replace("_", " "), 48)


@lru_cache
def _letters():
    """The letters of the fonts."""
    paths = [font_manager.findfont(name) for name in fonts()]
    return {letter for path in paths for letter in font_manager.get_font(path).get_charmap()}
