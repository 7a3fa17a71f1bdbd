//! Outlines of scenes of grains, before they are run.

use crate::{RunError, check_ranks, memory, start, start_positions};
use domain::{Comm, Number};
use granular::shear_cell::CollisionDetection;
use scene::{ContinuumScene, GranularDisksScene, Kind, ShearCellScene};
use simulation::Outline;
use suspension::Asked;

/// Number of disks times steps that one core computes per second: a measured order of magnitude.
const DISK_STEPS: f64 = 2.5e7;
/// Number of grains times steps of time-stepped collisions that one core computes per second, likewise measured.
const GRAIN_STEPS: f64 = 2.5e7;

/// Outline of a scene: its particles, plan, memory and cost, on ranks that need not exist. Collective.
pub fn outline(kind: &Kind, asked: Asked, comm: &Comm) -> Result<Outline, RunError> {
    check_ranks(kind, asked.ranks.count)?;
    let outline = match kind {
        Kind::Suspension(scene) => {
            return Ok(suspension::outline(&scene.model, start_positions(scene, comm)?, asked, comm)?
                .value("kind", kind.name()));
        }
        Kind::GranularDisks(scene) => {
            // A file that cannot be read is reported here as at the start of a run.
            start::disk_positions(scene, comm)?;
            of_disks(scene)
        }
        Kind::ShearCell(scene) => with_cost(scene.experiment.outline(), cell_seconds(scene)),
        Kind::Continuum(scene) => continuum(scene),
    };
    Ok(memory::add_to(outline, kind, comm).value("kind", kind.name()))
}

fn of_disks(scene: &GranularDisksScene) -> Outline {
    let mut outline = granular::disks::outline(&scene.model, scene.time.steps);
    if let Some(start) = &scene.start {
        outline =
            outline.line("start", format_args!("from {}, whose disks take the place of these", start.path.display()));
    }
    with_cost(outline, Some(scene.model.sizes().len() as f64 * scene.time.steps as f64 / DISK_STEPS))
}

/// Estimated seconds of a run of the cell, if its collisions are time-stepped.
fn cell_seconds(scene: &ShearCellScene) -> Option<f64> {
    let CollisionDetection::TimeStepped { step } = scene.experiment.collisions else { return None };
    Some(scene.experiment.count as f64 * scene.time.end() / step / GRAIN_STEPS)
}

fn with_cost(outline: Outline, seconds: Option<f64>) -> Outline {
    let outline = match seconds {
        Some(seconds) => outline.line("cost", format_args!("about {:.2} s of one core", Number(seconds))),
        None => outline,
    };
    outline.value("seconds", seconds)
}

/// Outline of a continuum.
pub fn continuum(scene: &ContinuumScene) -> Outline {
    let radial = scene.problems.first().map(|p| p.parameters().grains.radial);
    let name = radial.map(|radial| format!("{radial:?}")).unwrap_or_default();
    Outline::default()
        .line("problems", format_args!("{}, radial distribution of {name}", scene.problems.len()))
        .value("problems", scene.problems.len())
}
