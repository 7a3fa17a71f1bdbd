//! Where the results of a folder come from, by their own words.

use super::ReportError;
use crate::{FileError, text};
use hdf5::File;
use hdf5::types::VarLenUnicode;
use std::path::{Path, PathBuf};

/// Files of results, those first that know most.
const FILES: [&str; 5] = ["trajectory.h5", "observables.h5", "averages.h5", "sweep.h5", "solution.h5"];

/// Where results come from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Origin {
    /// The scene, as TOML.
    pub(super) scene: String,
    /// Name and version of the program.
    pub(super) program: String,
    /// How they were computed, in words.
    pub(super) plan: String,
    /// Number of ranks that the run started with.
    pub(super) ranks: u64,
    /// The scene's seed.
    pub(super) seed: u64,
}

impl Origin {
    /// That of the results in a folder.
    pub(super) fn of(folder: &Path) -> Result<Self, ReportError> {
        let path = FILES.iter().map(|name| folder.join(name)).find(|path| path.is_file());
        let path = path.ok_or_else(|| nothing(folder))?;
        Self::read(&path).map_err(|e| FileError::damaged(&path, &e).into())
    }

    fn read(path: &Path) -> hdf5::Result<Self> {
        let parameters = File::open(path)?.group("parameters")?;
        Ok(Self {
            scene: text::read_dataset(&parameters, "scene")?,
            program: parameters.attr("program")?.read_scalar::<VarLenUnicode>()?.to_string(),
            plan: text::read_dataset(&parameters, "plan")?,
            ranks: parameters.attr("ranks")?.read_scalar()?,
            seed: parameters.attr("seed")?.read_scalar()?,
        })
    }
}

fn nothing(folder: &Path) -> ReportError {
    let folder: PathBuf = folder.to_owned();
    if folder.join("scene.toml").exists() { ReportError::NoResults { folder } } else { ReportError::NoRun { folder } }
}
