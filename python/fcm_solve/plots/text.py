"""Text of users, such as names of species, as matplotlib shows it."""

LONGEST = 32


def shown(text, longest=LONGEST):
    """A name without mathematics, line breaks and excess length. Labels that begin with `_` would be left out of
    legends."""
    text = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    text = text if len(text) <= longest else text[: longest - 1].rstrip() + "\u2026"
    text = text.replace("$", r"\$")
    return " " + text if text.startswith("_") else text


def words(name):
    """The name of a quantity of a table in words: `storage_modulus` is a storage modulus."""
    return shown(name.replace("_", " "), 48)
