//! Models from the text of scenes, and their runs.

pub mod ended;
pub mod resumed;

use scene::{Kind, Scene};
use suspension::Model;

/// The model of a scene, with overrides of keys.
pub fn model_of(text: &str, overrides: &[&str]) -> Model {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let scene = Scene::parse(text, "scene.toml", &overrides).unwrap();
    let Kind::Suspension(scene) = scene.kind() else { panic!("a suspension") };
    scene.model.clone()
}
