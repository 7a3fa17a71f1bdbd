//! Reading of scenes that may take the box of the file that they start from.

use crate::scene::SceneText;
use crate::start_box::EdgesOfStartFile;
use crate::{Scene, SceneError, SceneFile, text_size};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads scenes. Where a scene has no box, it takes the edges from the file that the scene starts from, by a function
/// of the crate that knows the formats of such files. Without that function, a scene needs a box.
#[derive(Debug, Clone, Copy)]
pub struct SceneReader {
    edges_of: EdgesOfStartFile,
}

impl Default for SceneReader {
    fn default() -> Self {
        Self { edges_of: |_| Ok(None) }
    }
}

impl SceneReader {
    /// A reader with access to start files.
    pub const fn new(edges_of: EdgesOfStartFile) -> Self {
        Self { edges_of }
    }

    /// Reads a scene file, as [`Scene::read`] does.
    pub fn read(self, path: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
        let name = path.display().to_string();
        self.parse(&text_size::read(opened(path, &name)?, &name)?, &name, overrides)
    }

    /// Checks the text of a scene, as [`Scene::parse`] does.
    pub fn parse(self, text: &str, name: &str, overrides: &[String]) -> Result<Scene, SceneError> {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        Scene::of_text(SceneText { text, name, folder, overrides, without: &[], edges_of: self.edges_of })
    }

    /// Reads a file with a scene or a family of scenes, and sets the keys of `overrides`.
    pub fn read_file(self, path: &Path, overrides: &[String]) -> Result<SceneFile, SceneError> {
        let name = path.display().to_string();
        self.read_file_from(opened(path, &name)?, &name, overrides)
    }

    /// The same from any source; `name` identifies it in messages, and paths are relative to its folder.
    pub fn read_file_from(self, from: impl Read, name: &str, overrides: &[String]) -> Result<SceneFile, SceneError> {
        self.parse_file(&text_size::read(from, name)?, name, overrides)
    }

    /// The same of a text.
    pub fn parse_file(self, text: &str, name: &str, overrides: &[String]) -> Result<SceneFile, SceneError> {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        SceneFile::of_text(SceneText { text, name, folder, overrides, without: &[], edges_of: self.edges_of })
    }
}

impl Scene {
    /// Reads a scene file and sets the keys of `overrides`, each a text `key=value` such as `time.step=0.1`. Paths in
    /// the scene are relative to its folder. The scene has a box: [`SceneReader`] reads those that take the box of the
    /// file that they start from.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        SceneReader::default().read(path, overrides)
    }

    /// Checks the text of a scene. `name` is the file's, for messages, and paths are relative to its folder.
    pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        SceneReader::default().parse(text, name, overrides)
    }
}

impl SceneFile {
    /// Reads a file and sets the keys of `overrides`, as [`Scene::read`] does.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        SceneReader::default().read_file(path, overrides)
    }

    /// The same of a text, as [`Scene::parse`] does.
    pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        SceneReader::default().parse_file(text, name, overrides)
    }
}

fn opened(path: &Path, name: &str) -> Result<File, SceneError> {
    File::open(path).map_err(|reason| SceneError::Unreadable { name: name.to_owned(), reason })
}
