//! Calibration of the repulsion of a scene.

use crate::{RunError, start_positions};
use domain::Comm;
use scene::{Kind, Scene};
use suspension::least_repulsion;

/// The scene with the smallest strength of repulsion that prevents overlaps in a trial, and that strength, if
/// `repulsion.calibrate` is set. Collective.
pub fn with_least_repulsion(scene: Scene, comm: &Comm) -> Result<(Scene, Option<f64>), RunError> {
    let Kind::Suspension(checked) = scene.kind() else { return Ok((scene, None)) };
    if !checked.model.repulsion.is_some_and(|repulsion| repulsion.calibrate) {
        return Ok((scene, None));
    }
    let places = start_positions(checked, comm)?;
    let Some(strength) = least_repulsion(&checked.model, places.as_ref(), comm)? else { return Ok((scene, None)) };
    let overrides = [format!("repulsion.strength={strength:e}"), "repulsion.calibrate=false".to_owned()];
    Ok((scene.with("its repulsion", &overrides)?, Some(strength)))
}
