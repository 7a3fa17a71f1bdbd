//! A checked scene, and the reading of one.

use crate::document::{Node, excerpt, known};
use crate::error::ErrorContext;
use crate::granular_disks::GranularDisksScene;
use crate::key_error::KeyError;
use crate::kind::Kind;
use crate::kind_names::KINDS;
use crate::shear_cell::ShearCellScene;
use crate::shear_cell_continuum::ContinuumScene;
use crate::start_box::EdgesOfStartFile;
use crate::suspension::SuspensionScene;
use crate::written_names::FormerNames;
use crate::{SceneError, family_sections, kept_paths, overrides, start_box};
use std::path::{Path, PathBuf};

/// A checked scene: every number is in its range, and every missing key has its default. Created by [`Scene::read`],
/// [`Scene::parse`] and [`SceneReader`](crate::SceneReader) only.
#[derive(Debug)]
pub struct Scene {
    text: String,
    folder: PathBuf,
    kind: Kind,
    warnings: Vec<String>,
    edges_of: EdgesOfStartFile,
}

/// Text of a scene, with all that its meaning depends on.
#[derive(Clone, Copy)]
pub(crate) struct SceneText<'a> {
    /// The text.
    pub(crate) text: &'a str,
    /// Name of the text in messages.
    pub(crate) name: &'a str,
    /// Folder to which paths are relative.
    pub(crate) folder: &'a Path,
    /// Keys to set, each as `key=value`.
    pub(crate) overrides: &'a [String],
    /// Sections to leave out.
    pub(crate) without: &'a [&'a str],
    /// Reader of boxes in start files.
    pub(crate) edges_of: EdgesOfStartFile,
}

impl Scene {
    /// The same scene with some keys set; `purpose` describes them in messages. Paths are still
    /// relative to the original folder.
    pub fn with(&self, purpose: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let name = format!("the scene with {purpose}");
        let (text, folder, edges_of) = (self.text.as_str(), self.folder.as_path(), self.edges_of);
        Self::of_text(SceneText { text, name: &name, folder, overrides, without: &[], edges_of })
    }

    /// Checks a text with the keys of `overrides` set, and without some sections.
    pub(crate) fn of_text(source: SceneText) -> Result<Self, SceneError> {
        let SceneText { text, name, folder, overrides, without, edges_of } = source;
        let none = FormerNames::default();
        let context = ErrorContext { text, written: None, name, overrides: &[], former: &none };
        let written = Node::of_toml(text).map_err(|error| context.syntax(&error))?;
        let context = ErrorContext { written: Some(&written), overrides, ..context };
        let former = FormerNames::of(&written, overrides).map_err(|fault| context.fault(&fault))?;
        let context = ErrorContext { former: &former, ..context };
        let set = |text: &str, keys: &[String]| {
            let text = overrides::apply(text, keys, without).map_err(|message| SceneError::Override { message })?;
            let document = Node::of_toml(&text).map_err(|error| context.syntax(&error))?;
            Ok((text, document))
        };
        let is_as_written = overrides.is_empty() && without.is_empty();
        let mut changed = if is_as_written { None } else { Some(set(text, overrides)?) };
        let renamed = former.renamed(&written);
        let as_given = renamed.as_ref().unwrap_or(&written);
        let document = changed.as_ref().map_or(as_given, |(_, document)| document);
        let missing_edges = start_box::missing_edges(document, folder, edges_of);
        if let Some(edges) = missing_edges.map_err(|fault| context.fault(&fault))? {
            changed = Some(set(changed.as_ref().map_or(text, |(text, _)| text), &[edges])?);
        }
        let (text, document) = changed.as_ref().map_or((text, as_given), |(text, document)| (text.as_str(), document));
        Reading { document, folder, context, edges_of }.scene(text)
    }

    /// The scene as TOML including the overrides, as stored with the results.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Kind of the scene, with its parameters.
    pub fn kind(&self) -> &Kind {
        &self.kind
    }

    /// Warnings about the way in which the scene is written: names of former versions.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Reader of boxes in start files with which the scene was read.
    pub(crate) fn edges_of(&self) -> EdgesOfStartFile {
        self.edges_of
    }
}

/// A parsed document to be converted to a scene.
struct Reading<'a> {
    document: &'a Node,
    folder: &'a Path,
    context: ErrorContext<'a>,
    edges_of: EdgesOfStartFile,
}

impl Reading<'_> {
    /// The scene with this text.
    fn scene(&self, text: &str) -> Result<Scene, SceneError> {
        if let Some(section) = family_sections::section_of(self.document, text) {
            let message = "makes a family of many runs, which `fcm-solve run`, `check` and `resume` take, but which \
                is no scene of one";
            return Err(self.context.fault(&KeyError::new(section, message)));
        }
        let kind = match self.document.get("kind").and_then(Node::text).unwrap_or(KINDS[0]) {
            "suspension" => Kind::Suspension(self.check(SuspensionScene::checked)?),
            "granular-disks" => {
                Kind::GranularDisks(self.check(|raw, folder| GranularDisksScene::checked(&raw, folder))?)
            }
            "shear-cell" => Kind::ShearCell(self.check(|raw, _| ShearCellScene::checked(raw))?),
            "shear-cell-continuum" => Kind::Continuum(self.check(|raw, _| ContinuumScene::checked(raw))?),
            other => {
                let message = format!("is \"{}\"; {}", excerpt(other), known(other, &KINDS));
                return Err(self.context.fault(&KeyError::new("kind", message)));
            }
        };
        let warnings = self.context.former.warnings().to_vec();
        let text = kept_paths::with_absolute_paths(text, self.folder).unwrap_or_else(|| text.to_owned());
        Ok(Scene { text, folder: self.folder.to_owned(), kind, warnings, edges_of: self.edges_of })
    }

    /// Reads the keys of the file, then checks their values.
    fn check<Raw: serde::de::DeserializeOwned, Checked>(
        &self,
        checked: impl FnOnce(Raw, &Path) -> Result<Checked, KeyError>,
    ) -> Result<Box<Checked>, SceneError> {
        let raw = self.document.read().map_err(|mismatch| self.context.structure(&mismatch))?;
        let scene = checked(raw, self.folder).map_err(|fault| self.context.fault(&fault))?;
        Ok(Box::new(scene))
    }
}
