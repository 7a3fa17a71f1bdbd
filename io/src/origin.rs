//! Where the numbers of a file of frames come from.

use crate::frames::Frames;
use crate::scene_history::{self, SceneHistory};
use crate::{FileError, Provenance};
use hdf5::File;

/// The provenance of a file's first frame, and the changes of the scene since.
pub(crate) struct Origin {
    provenance: Provenance,
    scenes: Option<SceneHistory>,
}

impl Origin {
    pub(crate) fn new(provenance: &Provenance) -> Self {
        Self { provenance: provenance.clone(), scenes: None }
    }

    /// Writes both into a new file.
    pub(crate) fn write(&self, file: &File) -> hdf5::Result<()> {
        self.provenance.write(file)?;
        scene_history::create(file)?;
        self.scenes.as_ref().map_or(Ok(()), |scenes| scenes.write(file))
    }

    /// Notes the changes of the scene, in the file too.
    pub(crate) fn note_scenes(&mut self, scenes: &SceneHistory, frames: &mut Frames) -> Result<(), FileError> {
        self.scenes = Some(scenes.clone());
        frames.write(|file| scenes.write(file))
    }
}
