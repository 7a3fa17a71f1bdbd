//! Positions that somebody brings.

mod hdf5_file;
mod table;

use crate::FileError;
use domain::Vector;
use std::path::Path;

/// Positions from a file, with what else it says of the particles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placed {
    /// Positions.
    pub positions: Vec<Vector>,
    /// Radii, if the file has them.
    pub radii: Option<Vec<f64>>,
    /// Species as indices from 0, if the file has them.
    pub species: Option<Vec<u32>>,
}

impl Placed {
    /// Reads positions: a CSV file with the columns `x`, `y`, `z` and perhaps `radius` and `species`; extended XYZ with
    /// `pos` and perhaps `radius` and `species` among its properties; HDF5 with `positions` and perhaps `radii` and
    /// `species`, or in the H5MD format; or the last frame of a former run, by its folder.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        if path.is_dir() {
            return Self::read(&path.join("trajectory.h5"));
        }
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        let read_text = || std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e));
        let damaged = |reason: String| FileError::damaged(path, &reason);
        let placed = match extension.as_str() {
            "csv" => table::csv(&read_text()?).map_err(damaged),
            "xyz" | "extxyz" => table::extended_xyz(&read_text()?).map_err(damaged),
            "h5" | "hdf5" => hdf5_file::read(path),
            _ => {
                Err(FileError::read(path, &"positions are read from .csv, .xyz, .extxyz, .h5, .hdf5 or a run's folder"))
            }
        }?;
        match placed.positions.iter().position(|p| !p.is_finite()) {
            Some(row) => Err(FileError::damaged(path, &format!("position {row} is {}", placed.positions[row]))),
            None => Ok(placed),
        }
    }
}

#[cfg(test)]
mod tests;
