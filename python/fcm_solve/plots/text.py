"""Text of users, such as names of species, as matplotlib shows it."""

from functools import lru_cache

from matplotlib import font_manager

from .style import fonts

LONGEST = 32
# In the place of a letter of which no font has a picture.
MISSING = "\u25a1"


def shown(text, longest=LONGEST):
    """A name without mathematics, line breaks, excess length, and letters that no font has. Labels that begin with `_`
    would be left out of legends."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    text = text if len(text) <= longest else text[: longest - 1].rstrip() + "\u2026"
    text = "".join(c if ord(c) in _letters() else MISSING for c in text)
    text = text.replace("$", r"\$")
    return " " + text if text.startswith("_") else text


def words(name):
    """The name of a quantity of a table in words: `storage_modulus` is a storage modulus."""
    return shown(name.replace("_", " "), 48)


@lru_cache
def _letters():
    """The letters of the fonts."""
    paths = [font_manager.findfont(name) for name in fonts()]
    return {letter for path in paths for letter in font_manager.get_font(path).get_charmap()}
