//! Scenes of grains in numbers, before they are run.

use super::memory;
use domain::Number;
use drivers::disks::{Model, Sweep, estimated_free_path, viscous_length};
use drivers::shear_cell::Collisions;
use io::{ContinuumScene, GranularDisksScene, Kind, ShearCellScene, Time};

/// Disks that one core moves by a step in a second: a measured order of magnitude.
const DISK_STEPS: f64 = 2.5e7;
/// Grains that one core moves by a step of time-stepped collisions in a second, likewise.
const GRAIN_STEPS: f64 = 2.5e7;

/// What a scene would be made of and cost.
pub fn outline(kind: &Kind) -> String {
    let scene = match kind {
        Kind::GranularDisks(scene) => disks_and_cost(scene),
        Kind::ShearCell(scene) => cell(scene) + &cell_cost(scene),
        Kind::Continuum(scene) => continuum(scene),
        _ => return String::new(),
    };
    scene + &memory::outline(kind)
}

/// A system of disks.
pub fn disks(model: &Model, time: &Time) -> String {
    let (p, sizes) = (model.parameters(), model.sizes());
    let (zeta, path) = (viscous_length(model), estimated_free_path(model.area_fraction()));
    let viscous =
        if zeta.is_finite() { format!("viscous length {:.4}", Number(zeta)) } else { "no viscous length".into() };
    let strain = p.flow.rate(p.edges[1]).abs() * time.step * time.steps as f64;
    format!(
        "disks      {}, radii {:.4} to {:.4}, {:.4}% of the area\n\
         lengths    {viscous}, estimated mean free path {:.4}\n\
         steps      {}, until time {:.6} and strain {:.6}\n",
        sizes.len(),
        Number(model.smallest()),
        Number(model.largest()),
        Number(100.0 * model.area_fraction()),
        Number(path),
        time.steps,
        Number(time.end()),
        Number(strain),
    )
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
    disks(&scene.model, &scene.time) + &start + &scene.sweep.as_ref().map_or_else(String::new, cases) + &cost
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

/// A shear cell.
pub fn cell(scene: &ShearCellScene) -> String {
    let (p, model) = (scene.model.parameters(), &scene.model);
    let volume = std::f64::consts::PI / 6.0 * p.diameter.powi(3);
    let fraction = scene.count as f64 * volume / model.edges().element_product();
    let engine = match scene.collisions {
        Collisions::EventDriven => "at their exact times".to_owned(),
        Collisions::TimeStepped { step } => format!("on a time step of {:.6}", Number(step)),
    };
    format!(
        "grains     {}, solid fraction {:.4}\n\
         top        {}\n\
         collisions {engine}\n\
         steps      {}, until time {:.6}; measured from time {:.6}\n",
        scene.count,
        Number(fraction),
        if model.is_lid_free() { "free under its load" } else { "fixed" },
        scene.time.steps,
        Number(scene.time.end()),
        Number(scene.settle as f64 * scene.time.step),
    )
}

fn cell_cost(scene: &ShearCellScene) -> String {
    let Collisions::TimeStepped { step } = scene.collisions else { return String::new() };
    let steps = scene.time.end() / step;
    cost(scene.count as f64 * steps / GRAIN_STEPS)
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
