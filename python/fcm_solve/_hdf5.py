"""HDF5 files of a run, which may be read while they still grow."""

from ._errors import Error
from ._extras import needed


def opened(path, what):
    """The file, open for reading, without a lock."""
    h5py = needed("h5py", what)
    try:
        return h5py.File(path, "r", locking=False)
    except OSError as error:
        raise Error(f"can't read {path}: {error}") from error
