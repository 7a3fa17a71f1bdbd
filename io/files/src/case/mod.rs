//! Files of cases and of their answers: JSON, or HDF5 with the same names.

mod answer;
mod hdf5_input;

pub use answer::CaseAnswer;

use crate::{FileError, self_contained};
use scene::Case;
use std::path::Path;

/// Reads and checks a case. Files whose name ends in `.h5` or `.hdf5` are HDF5, all others JSON.
pub fn read_case(path: &Path) -> Result<Case, FileError> {
    if !is_hdf5(path) {
        let text = std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e))?;
        return parse_case(&text, path);
    }
    let file = self_contained::open(path).map_err(|e| FileError::read(path, &e))?;
    let document = hdf5_input::contents(&file, true).map_err(|e| FileError::read(path, &e))?;
    Case::of_document(&document, &|mismatch| hdf5_input::in_words(mismatch, &file))
        .map_err(|e| FileError::read(path, &e))
}

/// Checks a case in JSON; `name` identifies it in messages.
pub fn parse_case(text: &str, name: &Path) -> Result<Case, FileError> {
    Case::parse(text).map_err(|reason| FileError::read(name, &reason))
}

fn is_hdf5(path: &Path) -> bool {
    path.extension().is_some_and(|e| e == "h5" || e == "hdf5")
}

#[cfg(test)]
mod tests;
