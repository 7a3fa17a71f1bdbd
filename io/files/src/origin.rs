//! Provenance of the frames in a file.

use crate::frames::Frames;
use crate::scene_history::{self, SceneHistory};
use crate::{FileError, Provenance};
use hdf5::File;

/// Provenance of a file's first frame, and the changes of the scene since then.
pub(crate) struct Origin {
    provenance: Provenance,
    scenes: Option<SceneHistory>,
}

impl Origin {
    pub(crate) fn new(provenance: &Provenance) -> Self {
        Self { provenance: provenance.clone(), scenes: None }
    }

    /// Writes both to a new file.
    pub(crate) fn write(&self, file: &File) -> hdf5::Result<()> {
        self.provenance.write(file)?;
        scene_history::create(file)?;
        self.scenes.as_ref().map_or(Ok(()), |scenes| scenes.write(file))
    }

    /// Records the changes of the scene, also in the file.
    pub(crate) fn note_scenes(&mut self, scenes: &SceneHistory, frames: &mut Frames) -> Result<(), FileError> {
        self.scenes = Some(scenes.clone());
        frames.write(|file| scenes.write(file))
    }
}
