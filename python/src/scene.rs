//! Reading and checking scenes, as the program does.

use crate::error::{input_error, of_scene};
use files::SCENES;
use pyo3::prelude::*;
use run::WholeScene;
use scene::{Scene, TEMPLATES, Template};
use std::path::Path;

/// The text of a scene that comes with the program.
#[pyfunction]
pub fn template(name: &str) -> PyResult<&'static str> {
    let found = Template::named(name).map(|template| template.text);
    found.ok_or_else(|| {
        let names: Vec<&str> = TEMPLATES.iter().map(|template| template.name).collect();
        input_error(format!("no scene is called \"{name}\"; there are {}", names.join(", ")))
    })
}

/// Reads and checks a scene file.
#[pyfunction]
pub fn read(path: &str) -> PyResult<String> {
    Ok(SCENES.read(Path::new(path), &[]).map_err(|cause| of_scene(&cause))?.text().to_owned())
}

/// Checks the text of a scene with some keys set, each `key=value`. Returns the new text, whether the scene is carried
/// out as a whole, and warnings about the way in which it is written.
#[pyfunction]
pub fn check(text: &str, name: &str, overrides: Vec<String>) -> PyResult<(String, bool, Vec<String>)> {
    let scene = parsed(text, name, &overrides)?;
    Ok((scene.text().to_owned(), WholeScene::of(&scene).is_some(), scene.warnings().to_vec()))
}

/// Parses the text of a scene.
pub fn parsed(text: &str, name: &str, overrides: &[String]) -> PyResult<Scene> {
    SCENES.parse(text, name, overrides).map_err(|cause| of_scene(&cause))
}
