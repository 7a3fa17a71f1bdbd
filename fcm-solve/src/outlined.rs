//! A scene in numbers before it is run, by the decisions of a run.

use crate::part_progress::PartProgress;
use crate::prepared_scene::{Prepared, prepared};
use domain::Comm;
use io::{RunError, Scene, Trial};
use simulation::Outline;
use suspension::Asked;

/// A scene as a run of it would begin, its outline, and the trial of its first steps where one was made.
pub struct Outlined {
    pub scene: Scene,
    pub outline: Outline,
    pub trial: Option<Trial>,
}

/// The outline of a scene and, if it `is_tried`, the trial of its first steps, where one is possible. A scene that `run` would
/// refuse at its start is an error; one that has too little memory, or whose first steps fail, has an outline with that refusal.
/// Collective.
pub fn outlined(scene: Scene, asked: Asked, is_tried: bool, comm: &Comm) -> anyhow::Result<Outlined> {
    let Prepared { scene, notes } = prepared(scene, is_tried, comm)?;
    let placing = PartProgress::start(comm, "the particles are placed");
    let outline = io::outline(scene.kind(), asked, comm)?;
    drop(placing);
    let outline = notes.iter().fold(outline, |outline, (label, note)| outline.line(label, note));
    if !is_tried || outline.refused().is_some() {
        return Ok(Outlined { scene, outline, trial: None });
    }
    let _trying = PartProgress::start_late(comm, "the first steps are tried");
    match io::trial(&scene, comm) {
        Err(RunError::Simulation(error)) => {
            let outline = outline.line("trial", "the first steps fail");
            Ok(Outlined { scene, outline: outline.refusal(Some(io::in_full(&error))), trial: None })
        }
        trial => Ok(Outlined { trial: trial?, scene, outline }),
    }
}
