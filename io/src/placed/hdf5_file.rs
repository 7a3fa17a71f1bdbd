//! Positions in HDF5.

use super::Placed;
use crate::frames::Sums;
use crate::{FileError, checksum};
use domain::Vector;
use hdf5::{Dataset, File};
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<Placed, FileError> {
    if !path.exists() {
        return Err(FileError::read(path, &"there is no such file"));
    }
    let file = File::open(path).map_err(|e| FileError::damaged(path, &e))?;
    let placed = if file.link_exists("particles") { last_frame(&file) } else { flat(&file) };
    placed.map_err(|e| FileError::damaged(path, &e))
}

/// Datasets of the names that `fcm-solve mobility` uses.
fn flat(file: &File) -> hdf5::Result<Placed> {
    let positions = vectors(&file.dataset("positions")?.read_raw::<f64>()?);
    let radii = file.dataset("radii").ok().map(|radii| radii.read_raw::<f64>()).transpose()?;
    let radii = radii.map(|r| if r.len() == 1 { vec![r[0]; positions.len()] } else { r });
    let species = file.dataset("species").ok().map(|species| species.read_raw::<u32>()).transpose()?;
    Ok(Placed { positions, radii, species })
}

/// The last whole frame of an H5MD trajectory.
fn last_frame(file: &File) -> hdf5::Result<Placed> {
    let group = file.group("particles/all")?;
    let frames = group.dataset("position/step")?.size();
    let Some(last) = frames.checked_sub(1) else { return Err("the trajectory has no frame".into()) };
    if let Some(damage) = Sums::open(file)?.and_then(|sums| sums.damage(last)) {
        return Err(damage.to_string().into());
    }
    let positions = group.dataset("position/value")?.read_slice_2d::<f64, _>(hdf5_slice(last))?;
    let fixed = |name: &str| group.dataset(name).ok();
    let radii = fixed("radius").map(|d: Dataset| checksum::read::<f64>(&d)).transpose()?;
    let species = fixed("species").map(|d| checksum::read::<u32>(&d)).transpose()?;
    Ok(Placed { positions: vectors(positions.as_slice().unwrap_or_default()), radii, species })
}

fn hdf5_slice(frame: usize) -> hdf5::Hyperslab {
    hdf5::Hyperslab::from((frame, .., ..))
}

fn vectors(numbers: &[f64]) -> Vec<Vector> {
    numbers.chunks_exact(3).map(Vector::from_slice).collect()
}
