//! Files in a folder that have names of results and that no known run has made.

use super::names::{is_of_results, is_of_results_in};
use super::{MANIFEST, Manifest, found, older};
use crate::FileError;
use std::fmt::{Display, Formatter};
use std::path::Path;

/// Largest number of names that are shown.
const SHOWN: usize = 8;

/// Names in a folder that a new run would need and must not remove; folders end in `/`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Obstacles(Vec<String>);

impl Obstacles {
    /// Obstacles in a folder with this manifest, if it has one.
    pub fn of(folder: &Path, manifest: Option<&Manifest>) -> Result<Self, FileError> {
        let listed = manifest.and_then(Manifest::listed);
        let (files, folders) = listed.as_ref().map(|l| (&l.entries.files, &l.entries.folders)).unzip();
        let mut obstacles = Vec::new();
        for name in names_in(folder)? {
            let is_there = found(&folder.join(&name));
            let is_file = is_there.as_ref().is_some_and(std::fs::Metadata::is_file);
            let is_folder = is_there.is_some_and(|found| found.is_dir());
            let is_listed_file = files.is_some_and(|files| files.contains(&name));
            let is_ours = is_file && is_listed_file && older::looks_like_ours(&folder.join(&name));
            let is_listed_folder = folders.is_some_and(|folders| folders.contains(&name));
            if is_folder && is_listed_folder {
                let strangers = names_in(&folder.join(&name))?.into_iter();
                let strangers =
                    strangers.filter(|file| is_of_results_in(&name, file)).map(|file| format!("{name}/{file}"));
                let is_ours = |path: &String| {
                    let is_file = found(&folder.join(path)).is_some_and(|found| found.is_file());
                    let is_listed = files.is_some_and(|files| files.contains(path));
                    is_file && is_listed && older::looks_like_ours(&folder.join(path))
                };
                obstacles.extend(strangers.filter(|path| !is_ours(path)));
            } else if !is_ours
                && (is_of_results(&name) || is_listed_file || is_listed_folder || is_no_manifest(&name, is_file))
            {
                obstacles.push(if is_folder { name + "/" } else { name });
            }
        }
        obstacles.sort();
        Ok(Self(obstacles))
    }

    /// Whether there are no obstacles.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

fn is_no_manifest(name: &str, is_file: bool) -> bool {
    name == MANIFEST && !is_file
}

fn names_in(folder: &Path) -> Result<Vec<String>, FileError> {
    let entries = std::fs::read_dir(folder).map_err(|e| FileError::read(folder, &e))?;
    Ok(entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect())
}

impl Display for Obstacles {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let shown = self.0.len().min(SHOWN);
        f.write_str(&self.0[..shown].join(", "))?;
        if self.0.len() > shown { write!(f, " and {} more", self.0.len() - shown) } else { Ok(()) }
    }
}
