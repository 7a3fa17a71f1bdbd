//! The contents of the folder of a run, as `fcm-solve info` shows them.

use crate::checkpoint::Checkpoints;
use crate::{Contents, FileError, FrameSpan};
use scene::{Scene, in_full};
use serde::Serialize;
use std::fmt::{Display, Formatter};
use std::path::Path;

/// Files of frames and of averages, in the order in which they are shown.
const FILES: [&str; 4] = ["trajectory.h5", "observables.h5", "statistics/statistics.h5", "stats/statistics.h5"];

/// The contents of a folder of results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FolderContents {
    /// Kind of the scene.
    pub kind: &'static str,
    /// Step of the last checkpoint, and last step of the scene; `None` for a scene without steps.
    pub steps: Option<[u64; 2]>,
    /// The HDF5 files.
    pub files: Vec<FolderFile>,
    /// Path of the folder, for advice.
    #[serde(skip)]
    folder: String,
}

/// An HDF5 file of a folder.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FolderFile {
    /// Name within the folder.
    pub name: String,
    /// Frames, if the file has some.
    pub frames: Option<FrameSpan>,
    /// The parts that do not match their checksums, or the reason why the file cannot be read.
    pub damage: Vec<String>,
}

impl FolderContents {
    /// Reads a folder that holds a run.
    pub fn read(folder: &Path) -> Result<Self, FileError> {
        let path = folder.join("scene.toml");
        if !path.is_file() {
            let reason = "the folder holds no run: it has no scene.toml; name a folder of results, or a file in it";
            return Err(FileError::read(folder, &reason));
        }
        let text = std::fs::read_to_string(&path).map_err(|e| FileError::read(&path, &e))?;
        let name = path.display().to_string();
        let scene = Scene::parse(&text, &name, &[]).map_err(|e| FileError::read(&path, &in_full(&e)))?;
        let (last, planned) = (Checkpoints::of(folder).last_step()?, scene.kind().steps());
        let files = FILES.iter().filter(|name| folder.join(name).is_file());
        Ok(Self {
            kind: scene.kind().name(),
            steps: (planned > 0).then(|| [last.unwrap_or(0), planned]),
            files: files.map(|name| FolderFile::read(folder, name)).collect(),
            folder: folder.display().to_string(),
        })
    }

    /// Damaged parts of each file.
    pub fn damage(&self) -> Vec<String> {
        let of =
            |file: &FolderFile| (!file.damage.is_empty()).then(|| format!("{}: {}", file.name, file.damage.join("; ")));
        self.files.iter().filter_map(of).collect()
    }
}

impl FolderFile {
    fn read(folder: &Path, name: &str) -> Self {
        let (frames, damage) = match Contents::read(&folder.join(name)) {
            Ok(contents) => (contents.frames, contents.damage),
            Err(error) => (None, vec![in_full(&error)]),
        };
        Self { name: name.to_owned(), frames, damage }
    }
}

impl Display for FolderContents {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "kind       {}", self.kind)?;
        match self.steps {
            Some([last, planned]) if last >= planned => writeln!(f, "steps      {planned}, all of them taken")?,
            Some([last, planned]) => writeln!(
                f,
                "steps      {last} of {planned} are in the last checkpoint; to go on: fcm-solve resume {}",
                self.folder
            )?,
            None => {}
        }
        for FolderFile { name, frames, .. } in &self.files {
            match frames {
                Some(frames) => writeln!(f, "{name:<25} frames {frames}")?,
                None => writeln!(f, "{name}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_a_run_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = FolderContents::read(folder.path()).unwrap_err().to_string();
        assert!(error.contains(&folder.path().display().to_string()) && error.contains("no scene.toml"), "{error}");
        std::fs::write(folder.path().join("scene.toml"), "box = 3").unwrap();
        let error = FolderContents::read(folder.path()).unwrap_err().to_string();
        assert!(error.contains("scene.toml"), "{error}");
    }
}
