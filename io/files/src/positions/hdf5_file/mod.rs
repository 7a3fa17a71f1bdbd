//! Positions in HDF5 files.

mod array;
mod element;
mod flat;
mod h5md;

use super::StartFile;
use crate::{FileError, self_contained};
use hdf5::File;
use scene::StartSource;

/// Reads the positions of a file, in the H5MD format if it has a group `particles`.
pub(super) fn read(source: &StartSource) -> Result<StartFile, FileError> {
    let path = &source.path;
    if !path.exists() {
        return Err(FileError::read(path, &"there is no such file"));
    }
    let unfit = |reason: String| FileError::start(path, &reason);
    let file = File::open(path).map_err(|e| unfit(format!("it is no whole HDF5 file: {e}")))?;
    self_contained::check(&file).map_err(|e| unfit(e.to_string()))?;
    let read = if file.group("particles").is_ok() { h5md::read(&file, source) } else { flat::read(&file, source) };
    read.map_err(unfit)
}
