//! Scenes: the input files of runs.

mod answers;
mod changes;
mod checks;
mod differences;
mod error;
mod family;
mod granular_disks;
mod kept_paths;
mod overrides;
mod schema;
mod shear_cell;
mod shear_cell_continuum;
mod start_box;
mod suspension;
mod template;
mod text_size;
mod time_and_output;

pub use self::suspension::SuspensionScene;
use crate::document::{Node, excerpt, known};
pub(crate) use changes::{Rule, is_none, rule};
pub use changes::{SceneChange, check_accepted, some_of};
pub use differences::Difference;
pub(crate) use differences::differences_of;
pub use error::SceneError;
use error::{Explain, Fault};
pub use family::{Convergence, Family, Member, SceneFile};
pub use granular_disks::GranularDisksScene;
pub use schema::scene_schema;
pub use shear_cell::ShearCellScene;
pub use shear_cell_continuum::ContinuumScene;
use std::io::Read;
use std::path::{Path, PathBuf};
pub use template::{TEMPLATES, Template};
pub use time_and_output::{Output, Time};

/// A checked scene: every number is in its range, and every missing key has its default. Created by [`Scene::read`]
/// and [`Scene::parse`] only.
#[derive(Debug)]
pub struct Scene {
    text: String,
    folder: PathBuf,
    kind: Kind,
}

/// Kind of a computation, with its checked parameters.
#[derive(Debug)]
#[non_exhaustive]
pub enum Kind {
    /// Spheres in Stokes flow.
    Suspension(Box<SuspensionScene>),
    /// Disks that collide in a sheared liquid.
    GranularDisks(Box<GranularDisksScene>),
    /// Grains in a shear cell.
    ShearCell(Box<ShearCellScene>),
    /// The kinetic theory of a shear cell.
    Continuum(Box<ContinuumScene>),
}

/// Names of the kinds.
const KINDS: [&str; 4] = ["suspension", "granular-disks", "shear-cell", "shear-cell-continuum"];

impl Scene {
    /// Reads a scene file and sets the keys of `overrides`, each a text `key=value` such as `time.step=0.1`. Paths in
    /// the scene are relative to its folder.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path).map_err(|reason| SceneError::Unreadable { name: name.clone(), reason })?;
        Self::read_from(file, &name, overrides)
    }

    /// Like [`Scene::read`], from any source; `name` identifies it in messages, and paths are relative to its folder.
    pub fn read_from(from: impl Read, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        Self::parse(&text_size::read(from, name)?, name, overrides)
    }

    /// Checks the text of a scene. `name` is the file's, for messages, and paths are relative to its folder.
    pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        Self::parse_in(Path::new(name).parent().unwrap_or(Path::new("")), text, name, (overrides, &[]))
    }

    /// The same scene with some keys set; `purpose` describes them in messages. Paths are still
    /// relative to the original folder.
    pub fn with(&self, purpose: &str, overrides: &[String]) -> Result<Self, SceneError> {
        Self::parse_in(&self.folder, &self.text, &format!("the scene with {purpose}"), (overrides, &[]))
    }

    /// Scene of a member of a family with this text.
    fn parse_member(folder: &Path, text: &str, name: &str, settings: &[String]) -> Result<Self, SceneError> {
        Self::parse_in(folder, text, name, (settings, &family::SECTIONS))
    }

    /// Checks a text with the keys of `overrides` set, and without some sections.
    fn parse_in(
        folder: &Path,
        text: &str,
        name: &str,
        (overrides, without): (&[String], &[&str]),
    ) -> Result<Self, SceneError> {
        let explain = Explain { text, written: None, name, overrides: &[] };
        let written = Node::of_toml(text).map_err(|error| explain.syntax(&error))?;
        let explain = Explain { written: Some(&written), overrides, ..explain };
        let set = |text: &str, keys: &[String]| {
            let text = overrides::apply(text, keys, without).map_err(|message| SceneError::Override { message })?;
            let document = Node::of_toml(&text).map_err(|error| explain.syntax(&error))?;
            Ok((text, document))
        };
        let is_as_written = overrides.is_empty() && without.is_empty();
        let mut changed = if is_as_written { None } else { Some(set(text, overrides)?) };
        let document = changed.as_ref().map_or(&written, |(_, document)| document);
        if let Some(edges) = start_box::missing_edges(document, folder).map_err(|fault| explain.fault(&fault))? {
            changed = Some(set(changed.as_ref().map_or(text, |(text, _)| text), &[edges])?);
        }
        let (text, document) = changed.as_ref().map_or((text, &written), |(text, document)| (text.as_str(), document));
        Reading { document, folder, explain }.scene(text)
    }

    /// The scene as TOML including the overrides, as stored with the results.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Kind of the scene, with its parameters.
    pub fn kind(&self) -> &Kind {
        &self.kind
    }
}

/// A parsed document to be converted to a scene.
struct Reading<'a> {
    document: &'a Node,
    folder: &'a Path,
    explain: Explain<'a>,
}

impl Reading<'_> {
    /// The scene with this text.
    fn scene(&self, text: &str) -> Result<Scene, SceneError> {
        if let Some(section) = family::section_of(self.document, text) {
            let message = "makes a family of many runs, which `fcm-solve run`, `check` and `resume` take, but which \
                is no scene of one";
            return Err(self.explain.fault(&Fault::new(section, message)));
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
                return Err(self.explain.fault(&Fault::new("kind", message)));
            }
        };
        let text = kept_paths::with_absolute_paths(text, self.folder).unwrap_or_else(|| text.to_owned());
        Ok(Scene { text, folder: self.folder.to_owned(), kind })
    }

    /// Reads the keys of the file, then checks their values.
    fn check<Raw: serde::de::DeserializeOwned, Checked>(
        &self,
        checked: impl FnOnce(Raw, &Path) -> Result<Checked, Fault>,
    ) -> Result<Box<Checked>, SceneError> {
        let raw = self.document.read().map_err(|misfit| self.explain.structure(&misfit))?;
        let scene = checked(raw, self.folder).map_err(|fault| self.explain.fault(&fault))?;
        Ok(Box::new(scene))
    }
}

impl Kind {
    /// Name of the kind in scenes.
    pub fn name(&self) -> &'static str {
        let place = match self {
            Self::Suspension(_) => 0,
            Self::GranularDisks(_) => 1,
            Self::ShearCell(_) => 2,
            Self::Continuum(_) => 3,
        };
        KINDS[place]
    }

    /// Output schedules and folder. `None` for a continuum, which is written once, when it is solved.
    pub fn output(&self) -> Option<&Output> {
        match self {
            Self::Suspension(scene) => Some(&scene.output),
            Self::GranularDisks(scene) => Some(&scene.output),
            Self::ShearCell(scene) => Some(&scene.output),
            Self::Continuum(_) => None,
        }
    }

    /// Results folder that the scene sets.
    pub fn folder(&self) -> Option<&Path> {
        match self {
            Self::Continuum(scene) => scene.folder.as_deref(),
            _ => self.output().and_then(|output| output.folder.as_deref()),
        }
    }

    /// The time from which the answers take their means, if the scene says it.
    pub fn answers_from(&self) -> Option<f64> {
        match self {
            Self::Suspension(scene) => scene.answers_from,
            Self::GranularDisks(scene) => scene.answers_from,
            Self::ShearCell(scene) => scene.answers_from,
            Self::Continuum(_) => None,
        }
    }

    /// Seed of the random numbers.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Suspension(scene) => scene.model.seed,
            Self::GranularDisks(scene) => scene.model.parameters().seed,
            Self::ShearCell(scene) => scene.experiment.seed,
            Self::Continuum(_) => 0,
        }
    }

    /// Whether random numbers are used.
    pub fn has_seed(&self) -> bool {
        !matches!(self, Self::Continuum(_))
    }

    /// Last step.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Suspension(scene) => scene.time.steps,
            Self::GranularDisks(scene) => scene.time.steps,
            Self::ShearCell(scene) => scene.time.steps,
            Self::Continuum(_) => 0,
        }
    }
}
