//! Scenes of grains in numbers, before they are run.

use super::memory;
use crate::{ContinuumScene, GranularDisksScene, Kind, ShearCellScene};
use domain::Number;
use drivers::disks::{Sweep, outline as disks};
use drivers::shear_cell::Collisions;

/// Disks that one core moves by a step in a second: a measured order of magnitude.
const DISK_STEPS: f64 = 2.5e7;
/// Grains that one core moves by a step of time-stepped collisions in a second, likewise.
const GRAIN_STEPS: f64 = 2.5e7;

/// What a scene would be made of and cost.
pub fn outline(kind: &Kind) -> String {
    let scene = match kind {
        Kind::GranularDisks(scene) => disks_and_cost(scene),
        Kind::ShearCell(scene) => scene.experiment.outline() + &cell_cost(scene),
        Kind::Continuum(scene) => continuum(scene),
        _ => return String::new(),
    };
    scene + &memory::outline(kind)
}

fn disks_and_cost(scene: &GranularDisksScene) -> String {
    let count = scene.model.sizes().len() as f64;
    let start = scene.start.as_ref().map_or_else(String::new, |path| {
        format!("start      from {}, whose disks take the place of these\n", path.display())
    });
    let steps = match &scene.sweep {
        None => scene.time.steps as f64,
        Some(sweep) => {
            let steps = |rate: f64| sweep.strain / (rate.abs() * sweep.base.time_step);
            sweep.cases().iter().map(|case| steps(case.rate)).sum()
        }
    };
    let cost = cost(count * steps / DISK_STEPS);
    disks(&scene.model, scene.time.steps) + &start + &scene.sweep.as_ref().map_or_else(String::new, cases) + &cost
}

/// The runs of a sweep.
pub fn cases(sweep: &Sweep) -> String {
    format!(
        "sweep      {} runs: {} seeds, {} viscosities, {} rates, {} area fractions, each to strain {:.6}\n",
        sweep.cases().len(),
        sweep.seeds.len(),
        sweep.viscosities.len(),
        sweep.rates.len(),
        sweep.area_fractions.len(),
        Number(sweep.strain)
    )
}

fn cell_cost(scene: &ShearCellScene) -> String {
    let Collisions::TimeStepped { step } = scene.experiment.collisions else { return String::new() };
    let steps = scene.time.end() / step;
    cost(scene.experiment.count as f64 * steps / GRAIN_STEPS)
}

fn cost(seconds: f64) -> String {
    format!("cost       about {:.2} s of one core\n", Number(seconds))
}

/// The problems of a continuum.
pub fn continuum(scene: &ContinuumScene) -> String {
    let radial = scene.problems.first().map(|p| p.parameters().grains.radial);
    let name = radial.map(|radial| format!("{radial:?}")).unwrap_or_default();
    format!("problems   {}, radial distribution of {name}\n", scene.problems.len())
}
