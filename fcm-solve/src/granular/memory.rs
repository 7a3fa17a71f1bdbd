//! The memory that scenes of grains take, predicted.

use anyhow::Context;
use domain::{Bytes, Comm, Need, Process, readable_bytes};
use drivers::continuum::Problem;
use io::{ContinuumScene, GranularDisksScene, Kind, ShearCellScene};

/// What a run of a scene needs at its peak.
pub fn need(kind: &Kind) -> Need {
    let peak = match kind {
        Kind::GranularDisks(scene) => disks(scene),
        Kind::ShearCell(scene) => cell(scene),
        Kind::Continuum(scene) => continuum(scene),
        _ => Bytes::default(),
    };
    // Tables are written at once, everything else into files that stay open.
    let process = Process { writes: !matches!(kind, Kind::Continuum(_)), ..Process::ALONE };
    Need { resident: process.resident(peak.most), ..Need::default() }
}

/// Refuses a scene that there is no memory for.
pub fn check_room(kind: &Kind, comm: &Comm) -> anyhow::Result<()> {
    comm.check_room(need(kind)).with_context(|| remedy(kind))
}

/// The line of `check`, and a warning if there is not enough.
pub fn outline(kind: &Kind) -> String {
    let need = need(kind);
    let warning = Comm::check_room_of(&[need]).err();
    let warning = warning.map_or_else(String::new, |error| format!("warning: {}: {error}\n", remedy(kind)));
    format!("memory     about {} at most\n{warning}", readable_bytes(need.resident))
}

/// What a scene is, and what to change if it takes too much.
fn remedy(kind: &Kind) -> String {
    match kind {
        Kind::GranularDisks(scene) => format!(
            "the scene has {} disks and {} strips; take a smaller box.edges or particles.area_fraction, or fewer \
             output.profile_strips",
            scene.model.sizes().len(),
            scene.profile_strips
        ),
        Kind::ShearCell(scene) => format!(
            "the scene has {} grains; take fewer grains.count or a lower grains.solid_fraction, larger ones, or fewer \
             measure.layers and measure.pixels",
            scene.count
        ),
        Kind::Continuum(scene) => format!(
            "the scene has {} problems of {} heights each; list fewer cell.speeds or cell.pressures, or take fewer \
             output.points",
            scene.problems.len(),
            scene.points
        ),
        _ => String::new(),
    }
}

fn disks(scene: &GranularDisksScene) -> Bytes {
    let run = scene.model.bytes(scene.profile_strips);
    let frame = io::frame_bytes(scene.model.sizes().len() as f64, 3);
    run.then(frame)
}

fn cell(scene: &ShearCellScene) -> Bytes {
    scene.sampling.bytes(scene.count, scene.collisions).then(io::frame_bytes(scene.count as f64, 6))
}

/// A solution, or rows of the profiles of all problems and their text.
fn continuum(scene: &ContinuumScene) -> Bytes {
    let solved = scene.problems.first().map(|_| Problem::bytes()).unwrap_or_default();
    solved.or(io::Table::bytes(scene.problems.len() as f64 * scene.points as f64, ROW))
}

/// Columns of a row of the profiles: pressure and speed, and what is at a height.
const ROW: usize = 7;
