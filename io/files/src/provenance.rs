//! Provenance of results, stored in every result file.

use crate::{FileError, frames, self_contained, text};
use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{File, Group};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Version of the layout of the files.
const SCHEMA: &str = "1";

/// The data needed to reproduce the numbers of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Provenance {
    /// The scene, as TOML.
    pub scene: String,
    /// Name and version of the program.
    pub program: String,
    /// Evaluation plan of the fluid, in words.
    pub plan: String,
    /// Number of ranks that the run started with.
    pub ranks: usize,
    /// Seed of the scene.
    pub seed: u64,
}

/// Files from which that of a folder is read, in order of preference.
const FILES: [&str; 5] = ["trajectory.h5", "observables.h5", "averages.h5", "solution.h5", "family.h5"];

impl Provenance {
    /// Provenance of the results in a folder; `None` if there are none.
    pub fn of_folder(folder: &Path) -> Result<Option<Self>, FileError> {
        let file = FILES.iter().map(|name| folder.join(name)).find(|path| path.is_file());
        let read = |path: PathBuf| {
            let file = self_contained::open(&path);
            file.and_then(|file| Self::read(&file)).map_err(|e| FileError::damaged(&path, &e))
        };
        file.map(read).transpose()
    }

    /// Reads the provenance of a file.
    pub(crate) fn read(file: &File) -> hdf5::Result<Self> {
        let parameters = file.group("parameters")?;
        Ok(Self {
            scene: text::read_dataset(&parameters, "scene")?,
            program: parameters.attr("program")?.read_scalar::<VarLenUnicode>()?.to_string(),
            plan: text::read_dataset(&parameters, "plan")?,
            ranks: parameters.attr("ranks")?.read_scalar()?,
            seed: parameters.attr("seed")?.read_scalar()?,
        })
    }

    /// Writes the groups `h5md` and `parameters`.
    pub(crate) fn write(&self, file: &File) -> hdf5::Result<()> {
        let h5md = file.create_group("h5md")?;
        h5md.new_attr::<i32>().shape(2).create("version")?.write(&ndarray::arr1(&[1, 1]))?;
        let (name, version) = self.program.split_once(' ').unwrap_or((&self.program, ""));
        let creator = h5md.create_group("creator")?;
        write_fixed(&creator, "name", name)?;
        write_fixed(&creator, "version", version)?;
        write_fixed(&h5md.create_group("author")?, "name", "unknown")?;
        self.write_parameters(&frames::group(file, "parameters")?)
    }

    fn write_parameters(&self, group: &Group) -> hdf5::Result<()> {
        text::write_dataset(group, "scene", &self.scene)?;
        text::write_dataset(group, "plan", &self.plan)?;
        text::write_attribute(group, "program", &self.program)?;
        text::write_attribute(group, "schema", SCHEMA)?;
        text::write_attribute(group, "units", "those of the scene: any length, time and force that fit together")?;
        group.new_attr::<u64>().create("ranks")?.write_scalar(&(self.ranks as u64))?;
        group.new_attr::<u64>().create("seed")?.write_scalar(&self.seed)
    }
}

/// H5MD attributes have a fixed length, on which readers in C and Fortran rely.
fn write_fixed(group: &Group, name: &str, text: &str) -> hdf5::Result<()> {
    group.new_attr::<FixedAscii<64>>().create(name)?.write_scalar(&text::fixed(text)?)
}
