"""Values of Python as TOML."""

import json
import math
import re

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def value(item):
    """A value on one line, as written after `key =`. Values that would lose information, such as a mask or a unit, are refused."""
    if hasattr(item, "mask") or hasattr(item, "unit") or hasattr(item, "units"):
        raise TypeError(f"a scene has no masks and no units such as those of {_shown(item)}; give the numbers alone")
    if getattr(getattr(item, "dtype", None), "kind", None) in ("m", "M"):
        raise TypeError(f"a scene has no dates and time spans such as {_shown(item)}")
    item = item.tolist() if hasattr(item, "tolist") else item
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, int):
        return str(item)
    if isinstance(item, float):
        return repr(item) if math.isfinite(item) else str(item)
    if isinstance(item, dict):
        return "{ " + ", ".join(f"{_key(key)} = {value(held)}" for key, held in item.items()) + " }"
    if isinstance(item, (list, tuple)):
        return "[" + ", ".join(value(held) for held in item) + "]"
    if isinstance(item, str) or hasattr(item, "__fspath__"):
        return json.dumps(str(item), ensure_ascii=False).replace("\x7f", "\\u007f")
    raise TypeError(f"a scene has no values such as {_shown(item)}; it takes numbers, strings, booleans, lists and dicts")


def _shown(item):
    """A value as shown in a message, cut to one line."""
    shown = " ".join(repr(item).split())
    return shown if len(shown) <= 80 else shown[:80] + "..."


def document(table):
    """The text of a dict of dicts: keys, then tables, then lists of tables."""
    return "\n".join(_lines(table, ())).lstrip("\n") + "\n"


def _lines(table, path):
    tables = {key: held for key, held in table.items() if isinstance(held, dict)}
    lists = {key: held for key, held in table.items() if _is_list_of_tables(held)}
    plain = {key: held for key, held in table.items() if key not in tables and key not in lists}
    yield from (f"{_key(key)} = {value(held)}" for key, held in plain.items() if held is not None)
    for key, held in tables.items():
        yield from (f"\n[{_dotted(path, key)}]", *_lines(held, (*path, key)))
    for key, items in lists.items():
        for held in items:
            yield from (f"\n[[{_dotted(path, key)}]]", *_lines(held, (*path, key)))


def _is_list_of_tables(held):
    return isinstance(held, (list, tuple)) and len(held) > 0 and all(isinstance(item, dict) for item in held)


def _dotted(path, key):
    return ".".join(_key(part) for part in (*path, key))


def _key(key):
    if not isinstance(key, str):
        raise TypeError(f"{_shown(key)} is not a key of a scene; keys are strings")
    return key if _BARE.fullmatch(key) else json.dumps(key, ensure_ascii=False)
