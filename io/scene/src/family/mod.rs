//! Families: scenes that stand for many runs, one for each seed of `[ensemble]` at each point of `[sweep]`.

mod convergence;
mod former_lists;
mod lists;
mod member;
mod swept_paths;
#[cfg(test)]
mod tests;

use crate::document::{Node, excerpt};
use crate::error::ErrorContext;
use crate::family_sections::{SECTIONS, has_sections, is_of_family};
use crate::key_error::KeyError;
use crate::scene::SceneText;
use crate::start_box::EdgesOfStartFile;
use crate::written_names::FormerNames;
use crate::{Scene, SceneError, kept_paths, overrides};
pub use convergence::Convergence;
use former_lists::Renamed;
use lists::Lists;
pub use member::Member;
use std::path::PathBuf;
use toml::{Table, Value};

/// Members of a family at most.
const MOST: usize = 10_000;

/// A scene file as a user gives it: a scene, or a family of scenes.
#[derive(Debug)]
pub enum SceneFile {
    /// One run.
    Scene(Box<Scene>),
    /// Many.
    Family(Family),
}

/// A family of scenes of which every member has been checked.
#[derive(Debug)]
pub struct Family {
    text: String,
    name: String,
    folder: PathBuf,
    keys: Vec<String>,
    members: Vec<Member>,
    warnings: Vec<String>,
    /// Whether the text is that of the file.
    is_as_written: bool,
    edges_of: EdgesOfStartFile,
}

impl SceneFile {
    /// Checks a text, which is that of a family if it has one of its sections once the overrides are set.
    pub(crate) fn of_text(source: SceneText) -> Result<Self, SceneError> {
        let SceneText { text, overrides, .. } = source;
        let may_become_one = overrides.iter().any(|set| is_of_family(&overrides::key_of(set)));
        let changed = if may_become_one { overrides::apply(text, overrides, &[]).ok() } else { None };
        if has_sections(changed.as_deref().unwrap_or(text)) {
            return Family::of_text(source).map(Self::Family);
        }
        Ok(Self::Scene(Box::new(Scene::of_text(source)?)))
    }
}

impl Family {
    /// Checks the text of a family, and each of its members.
    fn of_text(source: SceneText) -> Result<Self, SceneError> {
        let SceneText { text, name, folder, overrides, edges_of, .. } = source;
        let none = FormerNames::default();
        let context = ErrorContext { text, written: None, name, overrides, former: &none };
        let written = Node::of_toml(text).map_err(|error| context.syntax(&error))?;
        let context = ErrorContext { written: Some(&written), ..context };
        let former = FormerNames::of(&written, overrides).map_err(|fault| context.fault(&fault))?;
        let given = text;
        let text = match overrides {
            [] => text.to_owned(),
            set => overrides::apply(text, set, &[]).map_err(|message| SceneError::Override { message })?,
        };
        let folder = folder.to_owned();
        let text = kept_paths::with_absolute_paths(&text, &folder).unwrap_or(text);
        let renamed = Renamed::of(text).map_err(|fault| context.fault(&fault))?;
        let explain_lists = |fault| context.fault(&renamed.as_written(fault));
        let text = swept_paths::with_absolute_paths(renamed.text.clone(), &folder);
        let lists = Lists::read(&text).map_err(explain_lists)?;
        let (name, keys, warnings) = (name.to_owned(), lists.keys.clone(), renamed.warnings());
        let warnings = warnings.into_iter().chain(former.warnings().iter().cloned()).collect();
        let is_as_written = text == given;
        let mut family = Self { text, name, folder, keys, members: Vec::new(), warnings, is_as_written, edges_of };
        family.members = family.members_of(lists, &explain_lists)?;
        for member in &family.members {
            let scene = family.scene(member)?;
            let new = scene.warnings().iter().filter(|warning| !family.warnings.contains(warning)).cloned();
            let new: Vec<String> = new.collect();
            family.warnings.extend(new);
        }
        Ok(family)
    }

    /// One for each seed at each point, those of a point one after another.
    fn members_of(
        &self,
        Lists { seeds, points, keys }: Lists,
        context: &impl Fn(KeyError) -> SceneError,
    ) -> Result<Vec<Member>, SceneError> {
        let first = Member::new(0, &keys, &points[0], None);
        let scene = self.scene(&first)?;
        let seeds = match seeds {
            Some(_) if !scene.kind().has_seed() => {
                let message = format!(
                    "goes with scenes that have random numbers; one of kind \"{}\" has none",
                    scene.kind().name()
                );
                return Err(context(KeyError::new("ensemble", message)));
            }
            Some(seeds) => seeds.from(scene.kind().seed()).map_err(context)?.into_iter().map(Some).collect(),
            None => vec![scene.kind().has_seed().then(|| scene.kind().seed())],
        };
        let count = points.len().saturating_mul(seeds.len());
        if count > MOST {
            let message = format!("makes {count} runs; a family has at most {MOST}: list fewer values or seeds");
            return Err(context(KeyError::new(if points.len() > 1 { "sweep" } else { "ensemble" }, message)));
        }
        let of_point = |(place, values): (usize, &Vec<Value>)| {
            seeds.iter().map(|seed| Member::new(place, &keys, values, *seed)).collect::<Vec<_>>()
        };
        Ok(points.iter().enumerate().flat_map(of_point).collect())
    }

    /// Whether a text is that of a family, right or wrong.
    pub fn is_text_of_one(text: &str) -> bool {
        has_sections(text)
    }

    /// The family as TOML, with the overrides in it: what to keep with the results.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The swept keys, in the order in which they are written.
    pub fn keys(&self) -> &[String] {
        &self.keys
    }

    /// Warnings about the way in which the family is written.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The members: those of a point follow each other.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// The members of each point.
    pub fn points(&self) -> impl Iterator<Item = &[Member]> {
        self.members.chunk_by(|one, other| one.point == other.point)
    }

    /// The scene of a member.
    pub fn scene(&self, member: &Member) -> Result<Scene, SceneError> {
        let source = SceneText {
            text: &self.text,
            name: &self.name,
            folder: &self.folder,
            overrides: member.settings(),
            without: &SECTIONS,
            edges_of: self.edges_of,
        };
        Scene::of_text(source).map_err(|e| e.of_member(&self.name, member, self.is_as_written))
    }

    /// The folder that the family names for its results.
    pub fn output_folder(&self) -> Option<PathBuf> {
        let table = toml::from_str::<Table>(&self.text).ok()?;
        table.get("output")?.get("folder")?.as_str().map(PathBuf::from)
    }
}

/// A value in messages and names.
fn shown(value: &Value) -> String {
    excerpt(&value.to_string())
}
