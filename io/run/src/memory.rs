//! Predicted memory of scenes of grains.

use crate::RunError;
use domain::{Bytes, Comm, MemoryNeed, Process, readable_bytes};
use granular::disks::run_bytes;
use granular::kinetic_theory::ContinuumProblem;
use granular::shear_cell::Experiment;
use scene::{ContinuumScene, GranularDisksScene, Kind, ShearCellScene};
use simulation::{Frame, Outline, Table};
use suspension::Ranks;

/// Memory of a run at its peak.
pub fn need(kind: &Kind) -> MemoryNeed {
    let peak = match kind {
        Kind::GranularDisks(scene) => disks(scene),
        Kind::ShearCell(scene) => cell(scene),
        Kind::Continuum(scene) => continuum(scene),
        Kind::Suspension(_) => Bytes::default(),
    };
    // Tables are written at once, all other output to files that stay open.
    let process = Process { writes: !matches!(kind, Kind::Continuum(_)), ..Process::ALONE };
    MemoryNeed { resident: process.resident(peak.most), ..MemoryNeed::default() }
}

/// Bytes that a run in one process takes at its peak, as far as they are known before its particles are placed.
pub fn predicted_memory(kind: &Kind, threads: usize) -> Result<Option<f64>, RunError> {
    match kind {
        Kind::Suspension(scene) => Ok(suspension::predicted_memory(&scene.model, Ranks { count: 1, threads })?),
        other => Ok(Some(need(other).resident)),
    }
}

/// Refuses a scene of grains if memory is insufficient; suspensions are checked when they are planned.
pub fn check_memory(kind: &Kind, comm: &Comm) -> Result<(), RunError> {
    if let Kind::Suspension(_) = kind {
        return Ok(());
    }
    comm.check_memory(need(kind)).map_err(|missing| RunError::Memory { remedy: remedy(kind), missing })
}

/// Adds the memory of a scene to its outline, and the refusal of its run if it is insufficient.
pub fn add_to(outline: Outline, kind: &Kind, comm: &Comm) -> Outline {
    let need = need(kind);
    outline
        .line("memory", format_args!("about {} at most", readable_bytes(need.resident)))
        .value("memory_bytes", vec![need.resident.ceil() as u64])
        .refusal(check_memory(kind, comm).err().map(|error| error.to_string()))
}

/// Description of a scene, and advice for reducing its memory.
fn remedy(kind: &Kind) -> String {
    match kind {
        Kind::GranularDisks(scene) => remedy_of_disks(scene),
        Kind::ShearCell(scene) => format!(
            "the scene has {} grains; take fewer grains.count or a lower grains.solid_fraction, larger ones, or fewer \
             measure.layers and measure.pixels",
            scene.experiment.count
        ),
        Kind::Continuum(scene) => format!(
            "the scene has {} problems of {} heights each; list fewer cell.speeds or cell.pressures, or take fewer \
             output.points",
            scene.problems.len(),
            scene.points
        ),
        Kind::Suspension(_) => String::new(),
    }
}

fn remedy_of_disks(scene: &GranularDisksScene) -> String {
    let disks = scene.model.sizes().len();
    format!(
        "the scene has {disks} disks and {} strips; take a smaller box.edges or particles.area_fraction, or fewer \
         output.profile_strips",
        scene.profile_strips
    )
}

fn disks(scene: &GranularDisksScene) -> Bytes {
    run_bytes(&scene.model, scene.profile_strips)
}

fn cell(scene: &ShearCellScene) -> Bytes {
    let Experiment { model, sampling, count, collisions, .. } = &scene.experiment;
    sampling.bytes(model, *count, *collisions).then(Frame::bytes(*count as f64, 6))
}

/// Memory of a solution, or of rows of the profiles of all problems and their text.
fn continuum(scene: &ContinuumScene) -> Bytes {
    let solved = scene.problems.first().map(|_| ContinuumProblem::bytes()).unwrap_or_default();
    solved.or(Table::bytes(scene.problems.len() as f64 * scene.points as f64, ROW))
}

/// Columns of a row of the profiles: pressure and speed, and the quantities at a height.
const ROW: usize = 7;
