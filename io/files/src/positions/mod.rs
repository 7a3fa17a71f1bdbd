//! Starting positions from files of this program and of others.

mod file_box;
mod fit;
mod frame;
mod hdf5_file;
mod order;
mod run_folder;
mod species;
mod text;

use crate::FileError;
use domain::{Number, Quaternion, Vector};
pub use file_box::FileBox;
pub use fit::{Fitted, disks, spheres, strain_for_disks, strain_for_spheres};
use scene::{SceneReader, StartSource};
use species::SpeciesColumn;
use std::fmt::{Display, Formatter};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Particles in one frame of a file. All lists have one entry per particle.
#[derive(Debug, Clone, Default)]
pub struct StartFile {
    /// Positions, inside or outside of the box.
    pub positions: Vec<Vector>,
    /// Lattice steps to the unwrapped positions.
    images: Option<Vec<[i32; 3]>>,
    /// Radii.
    pub radii: Option<Vec<f64>>,
    species: Option<SpeciesColumn>,
    /// Orientations, zero for particles without.
    pub orientations: Option<Vec<Quaternion>>,
    /// Numbers that identify the particles, in any order.
    ids: Option<Vec<u64>>,
    /// The box.
    pub cell: Option<FileBox>,
    /// The frame.
    pub frame: TakenFrame,
}

/// The frame that was read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TakenFrame {
    /// Number of the frame, from 0.
    pub number: usize,
    /// Number of frames of the file.
    pub count: usize,
    /// Step, if the file has it.
    pub step: Option<i64>,
    /// Time, if the file has it.
    pub time: Option<f64>,
}

/// Reader of scenes that takes missing edges of a box from the file that a scene starts from.
pub const SCENES: SceneReader = SceneReader::new(edges);

fn edges(source: &StartSource) -> Result<Option<[f64; 3]>, String> {
    let read = read_start(source).map_err(|error| error.to_string())?;
    Ok(read.cell.map(|cell| cell.edges().to_array()))
}

/// Reads CSV with a line of names; plain or extended XYZ; LAMMPS dumps; HDF5 with a dataset `positions`, or in
/// the H5MD format; or a frame of a former run, given by its folder.
pub fn read_start(source: &StartSource) -> Result<StartFile, FileError> {
    let read = read_any(source)?;
    check(&read).map_err(|reason| FileError::start(&source.path, &reason))?;
    Ok(read)
}

fn read_any(source: &StartSource) -> Result<StartFile, FileError> {
    let path = &source.path;
    let unfit = |reason: String| FileError::start(path, &reason);
    if path.is_dir() {
        return run_folder::read(source);
    }
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    let is_hdf5 = matches!(extension.as_str(), "h5" | "hdf5" | "h5md");
    if !is_hdf5 && source.group.is_some() {
        return Err(unfit("particles.group goes with H5MD files only; leave it out".to_owned()));
    }
    match extension.as_str() {
        _ if is_hdf5 => hdf5_file::read(source),
        "csv" | "tsv" => text::csv(&text_of(path)?, source.frame).map_err(unfit),
        "xyz" | "extxyz" => text::xyz(&text_of(path)?, source.frame).map_err(unfit),
        _ if begins_as_dump(path).map_err(|e| FileError::read(path, &e))? => {
            text::lammps(&text_of(path)?, source.frame).map_err(unfit)
        }
        _ => Err(unfit(OTHER.to_owned())),
    }
}

/// Text of a file: UTF-8, or UTF-16 with a byte order mark.
fn text_of(path: &Path) -> Result<String, FileError> {
    let bytes = std::fs::read(path).map_err(|e| FileError::read(path, &e))?;
    text::decoded(bytes).map_err(|reason| FileError::start(path, &reason))
}

const OTHER: &str = "its name has another ending than .csv, .tsv, .xyz, .extxyz, .h5, .hdf5 or .h5md, and it does not \
                     begin with ITEM: as dumps of LAMMPS do; name such a file, or the folder of a run";

fn begins_as_dump(path: &Path) -> std::io::Result<bool> {
    let mut start = Vec::new();
    File::open(path)?.take(5).read_to_end(&mut start)?;
    Ok(start == b"ITEM:")
}

/// Every particle must have a position, and a radius, a species and an id if any particle has these.
fn check(file: &StartFile) -> Result<(), String> {
    let count = file.positions.len();
    let lists = [
        ("radii", file.radii.as_ref().map(Vec::len)),
        ("species", file.species.as_ref().map(SpeciesColumn::len)),
        ("ids", file.ids.as_ref().map(Vec::len)),
        ("images", file.images.as_ref().map(Vec::len)),
        ("orientations", file.orientations.as_ref().map(Vec::len)),
    ];
    if let Some((name, Some(found))) = lists.into_iter().find(|(_, found)| found.is_some_and(|n| n != count)) {
        return Err(format!("it has {count} positions, but {found} {name}; it needs one for each"));
    }
    if count == 0 {
        return Err("it has no positions".to_owned());
    }
    if let Some(row) = file.positions.iter().position(|p| !p.is_finite()) {
        return Err(format!("position {row} is {}; it needs finite numbers", file.positions[row]));
    }
    let radii = file.radii.as_deref().unwrap_or_default();
    match radii.iter().position(|&r| !(r > 0.0 && r.is_finite())) {
        Some(row) => Err(format!("radius {row} is {}; it needs to be a finite number above 0", radii[row])),
        None => Ok(()),
    }
}

impl Display for TakenFrame {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "frame {} (of {}, from 0)", self.number, self.count)?;
        self.step.map_or(Ok(()), |step| write!(f, ", step {step}"))?;
        self.time.map_or(Ok(()), |time| write!(f, ", time {:.6}", Number(time)))
    }
}

#[cfg(test)]
mod tests;
