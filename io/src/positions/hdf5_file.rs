//! Positions in HDF5.

use crate::frames::Sums;
use crate::{FileError, checksum, claimed_size};
use bytemuck::NoUninit;
use domain::GivenPositions;
use domain::Vector;
use hdf5::{File, Group, H5Type};
use std::path::Path;

pub(super) fn read(path: &Path) -> Result<GivenPositions, FileError> {
    if !path.exists() {
        return Err(FileError::read(path, &"there is no such file"));
    }
    let file = File::open(path).map_err(|e| FileError::damaged(path, &e))?;
    let placed = if file.link_exists("particles") { last_frame(&file) } else { flat(&file) };
    placed.map_err(|e| FileError::damaged(path, &e))
}

/// Datasets of the names that `fcm-solve mobility` uses.
fn flat(file: &File) -> hdf5::Result<GivenPositions> {
    let positions = vectors(&claimed_size::read(file, "positions")?);
    let radii = perhaps(file, "radii")?;
    let radii = radii.map(|r| if r.len() == 1 { vec![r[0]; positions.len()] } else { r });
    let species = perhaps(file, "species")?;
    Ok(GivenPositions { positions, radii, species, ..GivenPositions::default() })
}

/// The last whole frame of an H5MD trajectory.
fn last_frame(file: &File) -> hdf5::Result<GivenPositions> {
    let group = file.group("particles/all")?;
    let frames = group.dataset("position/step")?.size();
    let Some(last) = frames.checked_sub(1) else { return Err("the trajectory has no frame".into()) };
    if let Some(damage) = Sums::open(file)?.and_then(|sums| sums.damage(last)) {
        return Err(damage.to_string().into());
    }
    let positions = claimed_size::dataset(&group, "position/value")?.read_slice_2d::<f64, _>(hdf5_slice(last))?;
    let radii = perhaps(&group, "radius")?;
    let species = perhaps(&group, "species")?;
    Ok(GivenPositions {
        positions: vectors(positions.as_slice().unwrap_or_default()),
        radii,
        species,
        ..GivenPositions::default()
    })
}

/// The numbers of a dataset that may be missing.
fn perhaps<T: H5Type + NoUninit>(group: &Group, name: &str) -> hdf5::Result<Option<Vec<T>>> {
    group.link_exists(name).then(|| checksum::read(&group.dataset(name)?)).transpose()
}

fn hdf5_slice(frame: usize) -> hdf5::Hyperslab {
    hdf5::Hyperslab::from((frame, .., ..))
}

fn vectors(numbers: &[f64]) -> Vec<Vector> {
    numbers.chunks_exact(3).map(Vector::from_slice).collect()
}
