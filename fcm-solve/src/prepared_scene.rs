//! Values of a scene that are determined when it is run.

use crate::part_progress::PartProgress;
use domain::{Comm, Number};
use scene::Scene;

/// A scene that is ready to be run, and the values determined for it: labels of at most ten letters, each with a text,
/// on the first rank.
pub struct PreparedScene {
    /// The scene.
    pub scene: Scene,
    /// Values determined for the scene, as labels and texts.
    pub notes: Vec<(&'static str, String)>,
}

/// Completes a scene with the box strain of its start file, the measured costs of this machine and, if it asks for that
/// and `is_calibrated`, a calibrated repulsion. Collective.
pub fn prepared(scene: Scene, is_calibrated: bool, comm: &Comm) -> anyhow::Result<PreparedScene> {
    let (scene, notes) = run::with_start_file(scene, comm)?;
    let scene = run::on_this_machine(scene, comm)?;
    let mut notes: Vec<_> = notes.into_iter().map(|note| ("start", note)).collect();
    if !is_calibrated {
        return Ok(PreparedScene { scene, notes });
    }
    let _calibrating = PartProgress::start(comm, "the repulsion is calibrated");
    let (scene, strength) = run::with_least_repulsion(scene, comm)?;
    if let Some(strength) = strength.filter(|_| comm.is_first()) {
        let text = format!("strength {:.5} keeps the spheres apart in a trial", Number(strength));
        notes.push(("repulsion", text));
    }
    Ok(PreparedScene { scene, notes })
}
