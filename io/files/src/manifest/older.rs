//! Files of results that are recognised by their content: those of versions without a manifest.

use super::entry::Entries;
use super::{SCENE, found, is_checkpoint};
use crate::signatures::{ANSWERS, ANSWERS_START, REPORT_START, starts_with};
use crate::{FileError, self_contained, text};
use hdf5::types::VarLenUnicode;
use std::path::{Path, PathBuf};

/// Folders to which runs and `stats` write files.
const FOLDERS: [&str; 5] = ["fields", "contacts", "statistics", "stats", "cases"];

/// First bytes of a checkpoint of those versions.
const CHECKPOINT: &[u8] = b"fcm-solve checkpoint 1\n";

/// Files of a run of an older version; `None` if the folder has a scene but no other file of this program.
pub(super) fn entries(folder: &Path) -> Result<Option<Entries>, FileError> {
    let mut entries = Entries::default();
    let of_run = known(folder)?;
    if of_run.is_empty() {
        return Ok(None);
    }
    entries.files.extend(of_run);
    entries.files.insert(SCENE.to_owned());
    for name in FOLDERS {
        let path = folder.join(name);
        if !found(&path).is_some_and(|found| found.is_dir()) {
            continue;
        }
        let files = known(&path)?;
        if !files.is_empty() {
            entries.folders.insert(name.to_owned());
            entries.files.extend(files.into_iter().map(|file| format!("{name}/{file}")));
        }
    }
    Ok(Some(entries))
}

/// Names of the files in a folder that this program wrote: HDF5 files and checkpoints by their content, tables by an
/// HDF5 file that has the same table.
fn known(folder: &Path) -> Result<Vec<String>, FileError> {
    let read = std::fs::read_dir(folder).map_err(|e| FileError::read(folder, &e))?;
    let files: Vec<PathBuf> = read.filter_map(|file| Some(file.ok()?.path())).collect();
    let files = files.into_iter().filter(|path| found(path).is_some_and(|found| found.is_file()));
    let (files, mut names, mut tables) = (files.collect::<Vec<_>>(), Vec::new(), Vec::new());
    for path in &files {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let is_checkpoint = is_checkpoint(name) && starts_with(path, CHECKPOINT);
        if is_checkpoint || (path.extension().is_some_and(|e| e == "h5") && is_of_this_program(path, &mut tables)) {
            names.push(name.to_owned());
        }
    }
    for path in &files {
        let Some(name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let is_table = name.strip_suffix(".csv").is_some_and(|table| tables.iter().any(|known| known == table));
        let is_case = folder.ends_with("cases") && starts_with(path, b"seed,viscosity,rate,area_fraction,");
        let is_index = name == "fields.xdmf" && starts_with(path, b"<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">");
        let is_report = name == "report.html" && starts_with(path, REPORT_START.as_bytes());
        let is_summary = name == ANSWERS && starts_with(path, ANSWERS_START.as_bytes());
        if is_table || is_case || is_index || is_report || is_summary {
            names.push(name.to_owned());
        }
    }
    Ok(names)
}

/// Whether a listed file looks like a file that the program writes under that name, as far as its content tells: a
/// file that the user has put in its place does not.
pub(super) fn looks_like_ours(path: &Path) -> bool {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("h5") => is_of_this_program(path, &mut Vec::new()),
        Some("bin") => starts_with(path, b"fcm-solve checkpoint "),
        Some("html") => starts_with(path, REPORT_START.as_bytes()),
        _ => true,
    }
}

/// Whether an HDF5 file has the parameters that this program writes; adds the names of its tables to `tables`.
fn is_of_this_program(path: &Path, tables: &mut Vec<String>) -> bool {
    let read = || {
        let file = self_contained::open(path)?;
        let program = file.group("parameters")?.attr("program")?.read_scalar::<VarLenUnicode>()?;
        Ok((program, file.as_group()?.member_names()?))
    };
    let found: hdf5::Result<_> = if starts_with(path, &text::HDF5) { read() } else { return false };
    let known = found.ok().filter(|(program, _)| program.starts_with("fcm-solve "));
    tables.extend(known.iter().flat_map(|(_, names)| names.iter().cloned()));
    known.is_some()
}
