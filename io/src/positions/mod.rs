//! Reading positions from files.

mod hdf5_file;
mod table;

use crate::FileError;
use domain::GivenPositions;
use std::path::Path;

/// Reads positions: a CSV file with the columns `x`, `y`, `z` and perhaps `radius` and `species`; extended XYZ with
/// `pos` and perhaps `radius` and `species` among its properties; HDF5 with `positions` and perhaps `radii` and
/// `species`, or in the H5MD format; or the last frame of a former run, by its folder.
pub fn read_positions(path: &Path) -> Result<GivenPositions, FileError> {
    if path.is_dir() {
        return read_positions(&path.join("trajectory.h5"));
    }
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    let read_text = || std::fs::read_to_string(path).map_err(|e| FileError::read(path, &e));
    let damaged = |reason: String| FileError::damaged(path, &reason);
    let mut placed = match extension.as_str() {
        "csv" => table::csv(&read_text()?).map_err(damaged),
        "xyz" | "extxyz" => table::extended_xyz(&read_text()?).map_err(damaged),
        "h5" | "hdf5" => hdf5_file::read(path),
        _ => Err(FileError::read(path, &"positions are read from .csv, .xyz, .extxyz, .h5, .hdf5 or a run's folder")),
    }?;
    check(&placed).map_err(damaged)?;
    placed.name = path.display().to_string();
    Ok(placed)
}

/// Every particle needs a position, and a radius and a species if the file has these.
fn check(placed: &GivenPositions) -> Result<(), String> {
    let count = placed.positions.len();
    let lists = [("radii", placed.radii.as_ref().map(Vec::len)), ("species", placed.species.as_ref().map(Vec::len))];
    if let Some((name, Some(found))) = lists.into_iter().find(|(_, found)| found.is_some_and(|n| n != count)) {
        return Err(format!("it has {count} positions, but {found} {name}; it needs one for each"));
    }
    if count == 0 {
        return Err("it has no positions".to_owned());
    }
    if let Some(row) = placed.positions.iter().position(|p| !p.is_finite()) {
        return Err(format!("position {row} is {}; it needs finite numbers", placed.positions[row]));
    }
    let radii = placed.radii.as_deref().unwrap_or_default();
    match radii.iter().position(|&r| !(r > 0.0 && r.is_finite())) {
        Some(row) => Err(format!("radius {row} is {}; it needs to be a finite number above 0", radii[row])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
