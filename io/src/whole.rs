//! HDF5 files that are written at once.

use crate::{FileError, durable};
use hdf5::{File, FileBuilder, OpenMode};
use std::path::Path;

/// Writes a file by `fill`. It appears under its name when it is whole and on the disk; until then a former file of
/// that name is intact.
pub(crate) fn write(path: &Path, fill: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
    durable::put(path, |_, temporary| {
        let file = at_once().create(temporary)?;
        fill(&file).and_then(|()| file.flush()).inspect_err(|_| leave_open(&file))?;
        file.close()
    })
}

/// Changes a file by `edit`, likewise: it is a copy that is changed.
pub(crate) fn change(path: &Path, edit: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
    durable::put(path, |_, temporary| {
        std::fs::copy(path, temporary).map_err(|e| hdf5::Error::from(e.to_string()))?;
        let file = at_once().open_as(temporary, OpenMode::ReadWrite)?;
        edit(&file).and_then(|()| file.flush()).inspect_err(|_| leave_open(&file))?;
        file.close()
    })
}

/// What is written to a dataset is in the file at once, or the call says why it is not: what the library keeps until the
/// dataset is closed, it may lose then without a word.
fn at_once() -> FileBuilder {
    let mut builder = File::with_options();
    builder.with_fapl(|f| f.sieve_buf_size(0).chunk_cache(0, 0, 0.0));
    builder
}

/// Sees to it that a file is not closed before the program ends. After a failed write, closing would try again to write
/// what is left, whatever the disk is like, and the library does not bear that this fails too.
pub(crate) fn leave_open(file: &File) {
    std::mem::forget(file.clone());
}
