//! Scenes: the files that say what to compute.

mod error;
mod names;
mod overrides;
mod places;
mod suspension;

pub use error::SceneError;
use error::{Explain, Fault};
use places::Places;
use std::path::Path;
pub use suspension::{
    Axis, Evaluation, Flow, Hydrodynamics, Lattice, Multipoles, Output, Repulsion, Species, Start, Statistics,
    SuspensionScene, Time,
};

/// A scene that has been checked: every number is in its range, and whatever the file left out has its default. Only
/// [`Scene::read`] and [`Scene::parse`] make one.
#[derive(Debug)]
pub struct Scene {
    text: String,
    kind: Kind,
}

/// What a scene computes.
#[derive(Debug)]
#[non_exhaustive]
pub enum Kind {
    /// Spheres in Stokes flow.
    Suspension(Box<SuspensionScene>),
}

impl Scene {
    /// Reads a scene file and sets the keys of `overrides`, each a text `key=value` such as `time.step=0.1`. Paths in
    /// the scene are relative to its folder.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let text =
            std::fs::read_to_string(path).map_err(|source| SceneError::Unreadable { name: name.clone(), source })?;
        Self::parse(&text, &name, overrides)
    }

    /// Checks the text of a scene. `name` is the file's, for messages and as the place that paths start from.
    pub fn parse(text: &str, name: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let folder = Path::new(name).parent().unwrap_or(Path::new(""));
        let written = Self::check(text, name, folder)?;
        if overrides.is_empty() {
            return Ok(written);
        }
        let text = overrides::apply(text, overrides).map_err(|message| SceneError::Override { message })?;
        let with = format!("{name} with --set {}", overrides.join(" --set "));
        Self::check(&text, &with, folder).map_err(SceneError::without_line)
    }

    fn check(text: &str, name: &str, folder: &Path) -> Result<Self, SceneError> {
        let explain = Explain { text, name };
        let places = Places::of(text).map_err(|error| explain.syntax(&error))?;
        let kind = match places.text_at("kind").as_deref() {
            None | Some("suspension") => {
                let raw = toml::from_str(text).map_err(|error| explain.structure(&places, &error))?;
                let scene = SuspensionScene::checked(raw, folder).map_err(|fault| explain.fault(&places, &fault))?;
                Kind::Suspension(Box::new(scene))
            }
            Some(other) => {
                let message = format!("is \"{other}\"; {}", names::known(other, &["suspension"]));
                return Err(explain.fault(&places, &Fault::new("kind", message)));
            }
        };
        Ok(Self { text: text.to_owned(), kind })
    }

    /// The scene as TOML, with the overrides in it: what to keep with the results.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What it computes.
    pub fn kind(&self) -> &Kind {
        &self.kind
    }
}
