"""The reproducible content of the files in the folder of a run, bit by bit; files that cannot be read."""

import csv

import h5py

# Durations of steps, and checksums of them, are not reproducible.
UNDETERMINED = "seconds_per_step"


def end_state(out):
    """The contents of all files of a run's folder."""
    state = {str(path.relative_to(out)): columns(path) for path in sorted(out.rglob("*.csv"))}
    # An older one that could not be removed may remain.
    state |= {path.name: path.read_bytes() for path in sorted(out.glob("checkpoint-*.bin"))[-1:]}
    for path in sorted(out.rglob("*.h5")):
        state |= datasets(path, path.relative_to(out))
    state["fields.xdmf"] = (out / "fields.xdmf").read_bytes() if (out / "fields.xdmf").exists() else None
    return state


def columns(path):
    """The reproducible columns of a table."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    if any(len(row) != len(rows[0]) for row in rows):
        raise ValueError(f"{path} has rows of different lengths")
    return [column for column in zip(*rows) if column[0] != UNDETERMINED]


def datasets(path, name):
    """The reproducible datasets of an HDF5 file."""
    found = {}

    def take(place, item):
        if isinstance(item, h5py.Dataset) and not place.startswith("parameters") and UNDETERMINED not in place:
            value = item[()]
            found[f"{name}:{place}"] = (item.shape, value.tolist() if item.dtype.hasobject else value.tobytes())

    with h5py.File(path) as file:
        file.visititems(take)
    return found


def unreadable(out):
    """The HDF5 files of a folder that do not open or lack numbers, with the reason. Files appear only when complete."""
    reasons = []
    for path in out.rglob("*.h5"):
        try:
            datasets(path, path.name)
        except (OSError, RuntimeError, KeyError) as error:
            reasons.append(f"{path.relative_to(out)}: {error}")
    return reasons


def differences(found, expected):
    """Names of the items in which two states differ."""
    names = sorted(found.keys() | expected.keys())
    return [name for name in names if found.get(name) != expected.get(name)]
