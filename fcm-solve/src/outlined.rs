//! Outline of a scene: its numbers as a run would determine them, without running it.

use crate::part_progress::PartProgress;
use crate::prepared_scene::{PreparedScene, prepared};
use domain::Comm;
use run::{RunError, Trial};
use scene::Scene;
use simulation::Outline;
use suspension::Asked;

/// A scene as a run would begin with it, its outline, and the trial of its first steps if one was made.
pub struct OutlinedScene {
    pub scene: Scene,
    pub outline: Outline,
    pub trial: Option<Trial>,
}

/// Outlines a scene and, if it `is_tried`, tries its first steps where the scene has steps. A scene that `run` would
/// refuse at its start is an error; a scene that needs too much memory, or whose first steps fail, has an outline that
/// contains the refusal. Collective.
pub fn outlined(scene: Scene, asked: Asked, is_tried: bool, comm: &Comm) -> anyhow::Result<OutlinedScene> {
    let PreparedScene { scene, notes } = prepared(scene, is_tried, comm)?;
    let placing = PartProgress::start(comm, "the particles are placed");
    let outline = run::outline(scene.kind(), asked, comm)?;
    drop(placing);
    let outline = notes.iter().fold(outline, |outline, (label, note)| outline.line(label, note));
    if !is_tried || outline.refused().is_some() {
        return Ok(OutlinedScene { scene, outline, trial: None });
    }
    let _trying = PartProgress::start_late(comm, "the first steps are tried");
    match run::trial(&scene, comm) {
        Err(RunError::Simulation(error)) => {
            let outline = outline.line("trial", "the first steps fail");
            Ok(OutlinedScene { scene, outline: outline.refusal(Some(scene::in_full(&error))), trial: None })
        }
        trial => Ok(OutlinedScene { trial: trial?, scene, outline }),
    }
}
