//! Export of trajectories to the formats of other programs.

mod contacts;
mod gsd;
mod range;
#[cfg(test)]
mod tests;
mod vtp;
mod xyz;

pub use contacts::{ContactFormat, export_contacts};
pub use range::FrameRange;

use crate::trajectory_reader::{TimedFrame, TrajectoryReader};
use crate::{FileError, Manifest, atomic_file};
use scene::{Kind, Scene};
use std::io::BufWriter;
use std::path::Path;

/// Format of another program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Extended XYZ: text, all frames in one file.
    Xyz,
    /// GSD of HOOMD-blue: binary, single precision, all frames in one file.
    Gsd,
    /// `PolyData` of VTK, one file per frame, and a `.pvd` file that lists them with their times.
    Vtp,
}

impl Format {
    /// Extension of the file name; for VTP that of the list.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Xyz => "xyz",
            Self::Gsd => "gsd",
            Self::Vtp => "pvd",
        }
    }
}

/// Writes frames of a trajectory to a file, which is entered in the manifest if it is in the manifest's folder. The
/// file appears under its name when it is complete.
pub fn export(
    recorded: &TrajectoryReader,
    frames: &mut dyn Iterator<Item = TimedFrame>,
    format: Format,
    path: &Path,
    run: &Manifest,
) -> Result<(), FileError> {
    if path.exists() && !path.is_file() {
        return Err(FileError::write(path, &"it is no file"));
    }
    run.enter(path)?;
    match format {
        Format::Xyz => atomic_file::write_with(path, |file, _| xyz::write(&mut BufWriter::new(file), frames)),
        Format::Gsd => {
            let species = species(recorded)?;
            atomic_file::write_with(path, |file, _| gsd::write(&mut BufWriter::new(file), &species, frames))
        }
        Format::Vtp => vtp::write((path, run), frames),
    }
}

/// Names of the species according to the scene, or else their numbers.
fn species(recorded: &TrajectoryReader) -> Result<Vec<String>, FileError> {
    let scene = Scene::parse(&recorded.provenance().scene, "the scene of the run", &[]).ok();
    let named: Vec<String> = match scene.as_ref().map(Scene::kind) {
        Some(Kind::Suspension(scene)) => scene.model.species.iter().map(|species| species.name.clone()).collect(),
        _ => Vec::new(),
    };
    names(recorded.species(), named).map_err(|found| FileError::damaged(recorded.path(), &found))
}

/// Names of the species of particles, of which the first have been given; the error says which species is too many.
fn names(species: &[u32], mut named: Vec<String>) -> Result<Vec<String>, String> {
    let (particles, count) = (species.len(), species.iter().max().map_or(0, |last| *last as usize + 1));
    if count > particles.max(named.len()) {
        return Err(format!("a particle of species {}, of {particles} particles", count - 1));
    }
    named.truncate(count);
    named.extend((named.len()..count).map(|number| number.to_string()));
    Ok(named)
}
