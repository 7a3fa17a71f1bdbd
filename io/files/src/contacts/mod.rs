//! Contact forces, one file for each step at which they are due: `contacts/contacts-STEP.h5`.

mod recorded;
#[cfg(test)]
mod tests;

use crate::{FileError, Manifest, Provenance, atomic_hdf5, checksum, manifest, text};
use hdf5::{File, H5Type};
pub use recorded::RecordedContacts;
use simulation::{ContactForce, ContactForces};
use std::path::{Path, PathBuf};

/// Folder of the files.
pub(crate) const FOLDER: &str = "contacts";

/// Writes the contacts of a step to `contacts/` in the folder of a run.
pub fn write_contacts(contacts: &ContactForces, run: &Manifest, provenance: &Provenance) -> Result<(), FileError> {
    let folder = run.folder().join(FOLDER);
    run.make_folder(&folder)?;
    let path = folder.join(name(contacts.step));
    run.enter(&path)?;
    atomic_hdf5::write(&path, |file| fill(file, contacts, provenance))
}

fn name(step: u64) -> String {
    format!("contacts-{step:010}.h5")
}

fn fill(file: &File, contacts: &ContactForces, provenance: &Provenance) -> hdf5::Result<()> {
    provenance.write(file)?;
    let root = file.as_group()?;
    root.new_attr::<u64>().create("step")?.write_scalar(&contacts.step)?;
    root.new_attr::<f64>().create("time")?.write_scalar(&contacts.time)?;
    let lattice: Vec<f64> = contacts.lattice.iter().flat_map(domain::Vector::to_array).collect();
    root.new_attr::<f64>().shape((3, 3)).create("lattice")?.write_raw(&lattice)?;
    let columns = ContactDatasets { file, list: &contacts.list };
    columns.write("pair", "", 2, |contact| contact.ids)?;
    columns.write("position", "length", 3, |contact| contact.position.to_array())?;
    columns.write("separation", "length", 3, |contact| contact.separation.to_array())?;
    columns.write("normal_force", "force", 1, |contact| [contact.normal])?;
    columns.write("tangential_force", "force", 3, |contact| contact.tangential.to_array())?;
    columns.write("state", "", 1, |contact| [contact.state.number()])
}

/// Datasets of a file, one row per contact.
struct ContactDatasets<'a> {
    file: &'a File,
    list: &'a [ContactForce],
}

impl ContactDatasets<'_> {
    fn write<T: H5Type + bytemuck::NoUninit, const N: usize>(
        &self,
        name: &str,
        unit: &str,
        width: usize,
        of_one: impl Fn(&ContactForce) -> [T; N],
    ) -> hdf5::Result<()> {
        let values: Vec<T> = self.list.iter().flat_map(of_one).collect();
        let new = self.file.new_dataset::<T>();
        let rows = self.list.len();
        let dataset =
            if width == 1 { new.shape((rows,)).create(name)? } else { new.shape((rows, width)).create(name)? };
        dataset.write_raw(&values)?;
        checksum::attach(&dataset, checksum::of(&values))?;
        text::write_dimensions(&dataset, unit)
    }
}

/// Removes the contacts of an earlier part of the run after step `last`.
pub fn drop_contacts_after(run: &Manifest, last: u64) -> Result<(), FileError> {
    let late = name(last);
    let is_late = |path: &PathBuf| path.file_name().is_some_and(|name| *name > *late);
    files(run.folder())?.iter().filter(|path| is_late(path)).try_for_each(|path| run.remove(path))
}

/// Contact files in the folder of a run, oldest first.
fn files(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let folder = folder.join(FOLDER);
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let entries = std::fs::read_dir(&folder).map_err(|e| FileError::read(&folder, &e))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(|path| is_one(path)).collect();
    files.sort();
    Ok(files)
}

fn is_one(path: &Path) -> bool {
    manifest::is_numbered(path, "contacts-", ".h5")
}
