//! Scenes with the values that are determined when they are run.

use crate::part_progress::PartProgress;
use domain::{Comm, Number};
use io::Scene;

/// A scene that is ready to be run, and what was found for it: labels of at most ten letters with a text, on the first rank.
pub struct Prepared {
    /// The scene.
    pub scene: Scene,
    /// What was found.
    pub notes: Vec<(&'static str, String)>,
}

/// The scene with the strain of the box in the file that it starts from, the costs of this machine, and with a calibrated
/// repulsion if it asks for that and it `is_calibrated`. Collective.
pub fn prepared(scene: Scene, is_calibrated: bool, comm: &Comm) -> anyhow::Result<Prepared> {
    let (scene, notes) = io::with_start_file(scene, comm)?;
    let scene = io::on_this_machine(scene, comm)?;
    let mut notes: Vec<_> = notes.into_iter().map(|note| ("start", note)).collect();
    if !is_calibrated {
        return Ok(Prepared { scene, notes });
    }
    let _calibrating = PartProgress::start(comm, "the repulsion is calibrated");
    let (scene, strength) = io::with_least_repulsion(scene, comm)?;
    if let Some(strength) = strength.filter(|_| comm.is_first()) {
        let text = format!("strength {:.5} keeps the spheres apart in a trial", Number(strength));
        notes.push(("repulsion", text));
    }
    Ok(Prepared { scene, notes })
}
