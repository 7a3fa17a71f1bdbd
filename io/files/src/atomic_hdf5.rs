//! Atomic replacement of HDF5 files.

use crate::{FileError, atomic_file, self_contained};
use hdf5::{File, FileBuilder, OpenMode};
use std::path::Path;

/// Writes a file with `fill`. It appears under its name when it is complete and on the disk; until then a former
/// file of that name is intact.
pub(crate) fn write(path: &Path, fill: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
    atomic_file::write_with(path, |_, temporary| {
        let file = at_once().create(temporary)?;
        fill(&file).and_then(|()| file.flush()).inspect_err(|_| leave_open(&file))?;
        file.close()
    })
}

/// Edits a copy of a file with `edit`, which then replaces the file like [`write()`].
pub(crate) fn change(path: &Path, edit: impl FnOnce(&File) -> hdf5::Result<()>) -> Result<(), FileError> {
    atomic_file::write_with(path, |_, temporary| {
        std::fs::copy(path, temporary).map_err(|e| hdf5::Error::from(e.to_string()))?;
        let file = at_once().open_as(temporary, OpenMode::ReadWrite)?;
        self_contained::check(&file)?;
        edit(&file).and_then(|()| file.flush()).inspect_err(|_| leave_open(&file))?;
        file.close()
    })
}

/// File options with which a write to a dataset reaches the file at once, or fails at once: HDF5 can lose data that
/// it caches until a dataset is closed, without an error.
fn at_once() -> FileBuilder {
    let mut builder = File::with_options();
    builder.with_fapl(|f| f.sieve_buf_size(0).chunk_cache(0, 0, 0.0));
    builder
}

/// Keeps a file open until the program ends. Closing it after a failed write would write the remaining data again,
/// and HDF5 cannot handle a failure of that.
pub(crate) fn leave_open(file: &File) {
    std::mem::forget(file.clone());
}
