//! Scenes with the values that are determined when they are run.

use crate::streams;
use domain::{Comm, Number};
use io::Scene;

/// The scene with the strain of the box in the file that it starts from, the costs of this machine, and with a calibrated
/// repulsion if it asks for that. Collective.
pub fn prepared(scene: Scene, comm: &Comm) -> anyhow::Result<Scene> {
    let (scene, notes) = io::with_start_file(scene, comm)?;
    for note in notes {
        streams::inform(format_args!("start      {note}"));
    }
    let (scene, strength) = io::with_least_repulsion(io::on_this_machine(scene, comm)?, comm)?;
    if let Some(strength) = strength.filter(|_| comm.is_first()) {
        let strength = Number(strength);
        streams::inform(format_args!("repulsion  strength {strength:.5} keeps the spheres apart in a trial"));
    }
    Ok(scene)
}
