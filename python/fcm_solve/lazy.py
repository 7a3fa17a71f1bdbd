"""HDF5 datasets as xarray variables that are read on access."""

from ._extras import needed


class Dataset:
    """The first `frames` frames of a dataset. A key has an integer or a slice for each axis."""

    def __init__(self, dataset, frames):
        self._dataset = dataset
        self.shape = (frames, *dataset.shape[1:])
        self.dtype = dataset.dtype

    def read(self, key):
        return self._dataset[_within(key, self.shape)]


class Unwrapped:
    """Unwrapped positions: position + image . lattice vectors."""

    def __init__(self, positions, images, edges):
        self._positions, self._images, self._edges = positions, images, edges
        self.shape, self.dtype = positions.shape, positions.dtype

    def read(self, key):
        frames, particles, axis = key
        spans = _span(frames), _span(particles), slice(None)
        images, edges = self._images.read(spans), self._edges.read((spans[0], slice(None), slice(None)))
        places = self._positions.read(spans) + images @ edges
        return places[tuple(slice(None) if isinstance(k, slice) else 0 for k in (frames, particles)) + (axis,)]


def _span(key):
    return key if isinstance(key, slice) else slice(key, key + 1)


def _within(key, shape):
    """The key with slices cut to `shape`, since the file may have grown after it was opened."""
    return tuple(slice(*k.indices(length)) if isinstance(k, slice) else k for k, length in zip(key, shape))


def variable(dimensions, array, attributes):
    """An xarray variable that reads the parts of `array` that are used."""
    xarray = needed("xarray", "to_xarray()")
    from xarray.backends import BackendArray
    from xarray.core import indexing

    class Lazy(BackendArray):
        shape, dtype = array.shape, array.dtype

        def __getitem__(self, key):
            support = indexing.IndexingSupport.BASIC
            return indexing.explicit_indexing_adapter(key, self.shape, support, array.read)

    return xarray.Variable(dimensions, indexing.LazilyIndexedArray(Lazy()), attributes)
