//! Scenes that ask for the least repulsion.

use crate::streams;
use domain::{Comm, Number};
use io::{Kind, Scene};
use suspension::least_repulsion;

/// The scene with the least repulsion that keeps its spheres apart, if it asks for that by `repulsion.calibrate`.
/// Collective.
pub fn with_least_repulsion(scene: Scene, comm: &Comm) -> anyhow::Result<Scene> {
    let Kind::Suspension(checked) = scene.kind() else { return Ok(scene) };
    if !checked.model.repulsion.is_some_and(|repulsion| repulsion.calibrate) {
        return Ok(scene);
    }
    let placed = io::placed(checked, comm)?;
    let Some(strength) = least_repulsion(&checked.model, placed.as_ref(), comm)? else { return Ok(scene) };
    if comm.is_first() {
        let strength = Number(strength);
        streams::log(format_args!("repulsion  strength {strength:.5} keeps the spheres apart in a trial"));
    }
    let overrides = [format!("repulsion.strength={strength:e}"), "repulsion.calibrate=false".to_owned()];
    Ok(Scene::parse(scene.text(), "the scene with its repulsion", &overrides)?)
}
