//! Scenes of spheres in Stokes flow.

mod particles;
mod raw;
mod statistics;

use super::checks::{self, positive, vector};
use super::course::{Output, Time, share};
use super::error::Fault;
use crate::Schedule;
use domain::{Number, PeriodicBox, Vector};
pub use particles::{Lattice, Species, Start};
pub use raw::{Evaluation, Multipoles};
pub use statistics::{Axis, Statistics};
use std::path::Path;

/// A checked scene of spheres in Stokes flow; only [`Scene`](super::Scene) makes one.
#[derive(Debug)]
#[non_exhaustive]
pub struct SuspensionScene {
    /// What the scene is called in plots and files.
    pub title: String,
    /// Where random numbers start.
    pub seed: u64,
    /// The box, not sheared yet.
    pub cell: PeriodicBox,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Acceleration of gravity.
    pub gravity: Vector,
    /// The kinds of spheres.
    pub species: Vec<Species>,
    /// Where the spheres are at first.
    pub start: Start,
    /// The background flow.
    pub flow: Flow,
    /// The barrier that keeps spheres apart.
    pub repulsion: Option<Repulsion>,
    /// How the fluid is computed.
    pub hydrodynamics: Hydrodynamics,
    /// Time step and number of steps.
    pub time: Time,
    /// How a step is taken.
    pub integrator: Integrator,
    /// What is written, where and when.
    pub output: Output,
    /// What is averaged.
    pub statistics: Option<Statistics>,
}

/// The flow that would be there without the spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Flow {
    /// None.
    None,
    /// `u = rate y e_x`.
    Shear {
        /// One over time.
        rate: f64,
        /// Whether the box shears with the flow, so that images of spheres move with it.
        lees_edwards: bool,
    },
}

/// The repulsion barrier.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Repulsion {
    /// Force at contact, over the `radius_power`-th power of the harmonic mean radius of the two.
    pub strength: f64,
    /// The power, 0, 1 or 2, of the harmonic mean radius with which the force grows.
    pub radius_power: u8,
    /// The gap where it starts over the mean radius of the two; the program's default where the scene has none.
    pub range: Option<f64>,
    /// Whether the strength is only where the search for the least sufficient one starts.
    pub calibrate: bool,
}

/// How the fluid is computed; what is `None` is chosen from the tolerance.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Hydrodynamics {
    /// Which multipoles the spheres have.
    pub multipoles: Multipoles,
    /// Relative error that the user wants.
    pub tolerance: f64,
    /// How the far field is evaluated.
    pub method: Evaluation,
    /// Grid points along x, y and z.
    pub grid: Option<[usize; 3]>,
    /// Grid points across a stencil.
    pub support: Option<usize>,
    /// Relative residual at which the stresslets are solved.
    pub iteration_tolerance: Option<f64>,
    /// What parts of an evaluation cost on the machine that the scene is planned for: stencils, transforms and pairs,
    /// over what they cost where the planner was made.
    pub costs: Option<[f64; 3]>,
    /// Whether near pairs feel lubrication.
    pub lubrication: bool,
    /// The gap where lubrication ends over the larger radius of the two; the program's default where the scene has
    /// none.
    pub lubrication_cutoff: Option<f64>,
    /// Whether the solve with lubrication is preconditioned.
    pub preconditioner: bool,
}

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// All steps are alike, by the Adams-Bashforth method of an order from 2 to 4.
    AdamsBashforth {
        /// Its order.
        order: u8,
    },
    /// Each in as many parts as are needed.
    Adaptive(Adaptive),
}

/// What limits the length of a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Adaptive {
    /// Largest error of a substep in a position, over the radius.
    pub tolerance: f64,
    /// Largest part of a gap between two spheres that a substep may take away.
    pub gap_fraction: f64,
}

impl Default for Adaptive {
    fn default() -> Self {
        Self { tolerance: 1e-4, gap_fraction: 0.25 }
    }
}

impl SuspensionScene {
    pub(super) fn checked(raw: raw::Raw, folder: &Path) -> Result<Self, Fault> {
        let cell = cell(&raw.cell)?;
        let gravity =
            raw.gravity.as_ref().map_or(Ok(Vector::ZERO), |g| vector("gravity.acceleration", g.acceleration))?;
        let species = particles::species(&raw, &cell)?;
        let time = time(&raw.time)?;
        let output = output(raw.output, time.steps);
        output.check(time.steps, species.iter().map(|s| s.count.unwrap_or(0) as f64).sum())?;
        Ok(Self {
            title: raw.title.unwrap_or_default(),
            seed: raw.seed,
            viscosity: positive("fluid.viscosity", raw.fluid.viscosity)?,
            start: particles::start(&raw.particles, &species, folder)?,
            flow: in_flow(for_a_time(flow(raw.flow.as_ref(), &cell)?, &time)?, &raw.hydrodynamics)?,
            repulsion: raw.repulsion.as_ref().map(repulsion).transpose()?,
            hydrodynamics: hydrodynamics(&raw.hydrodynamics)?,
            output,
            statistics: raw.statistics.as_ref().map(|s| Statistics::checked(s, &cell)).transpose()?,
            cell,
            integrator: integrator(&raw.time)?,
            gravity,
            species,
            time,
        })
    }
}

fn cell(raw: &raw::Box) -> Result<PeriodicBox, Fault> {
    for (axis, length) in raw.edges.iter().enumerate() {
        positive(&format!("box.edges[{axis}]"), *length)?;
    }
    PeriodicBox::new(Vector::from_array(raw.edges)).map_err(|e| Fault::new("box.edges", e.to_string()))
}

fn flow(raw: Option<&raw::Flow>, cell: &PeriodicBox) -> Result<Flow, Fault> {
    let Some(raw) = raw else { return Ok(Flow::None) };
    match (raw.kind, raw.rate) {
        (raw::FlowKind::None, None) => Ok(Flow::None),
        (raw::FlowKind::None, Some(_)) => {
            Err(Fault::new("flow.rate", "is set, but flow.kind is \"none\"; set flow.kind = \"shear\" or leave it out"))
        }
        (raw::FlowKind::Shear, None) => Err(Fault::new("flow.rate", "is missing; a shear flow u = rate y needs it")),
        (raw::FlowKind::Shear, Some(rate)) => {
            checks::finite("flow.rate", rate)?;
            debug_assert!(cell.strain() == 0.0, "a run starts in a straight box");
            Ok(Flow::Shear { rate, lees_edwards: raw.lees_edwards.unwrap_or(true) })
        }
    }
}

/// The largest strain of a run: beyond, the box's offset has lost more than half of its digits.
const LARGEST_STRAIN: f64 = 1e9;

/// The strain at the end of a run needs to be a number that tells where images are.
fn for_a_time(flow: Flow, time: &Time) -> Result<Flow, Fault> {
    match flow {
        Flow::Shear { rate, .. } if (rate * time.end()).abs() > LARGEST_STRAIN => {
            let (rate, end, largest) = (Number(rate), Number(time.end()), Number(LARGEST_STRAIN));
            let message = format!(
                "is {rate}; until time {end:.6} that is a strain above {largest}, the most that a run can have"
            );
            Err(Fault::new("flow.rate", message))
        }
        flow => Ok(flow),
    }
}

/// Lubrication needs a box in which the images of a sphere move with the flow.
fn in_flow(flow: Flow, hydrodynamics: &raw::Hydrodynamics) -> Result<Flow, Fault> {
    match flow {
        Flow::Shear { lees_edwards: false, .. } if hydrodynamics.lubrication => {
            let message = "is true, but with flow.lees_edwards = false the box stays straight, and spheres on either side of \
                           its y boundary would rub against images that do not move with the flow; set \
                           flow.lees_edwards = true, or lubrication = false";
            Err(Fault::new("hydrodynamics.lubrication", message))
        }
        flow => Ok(flow),
    }
}

fn repulsion(raw: &raw::Repulsion) -> Result<Repulsion, Fault> {
    if raw.strength < 0.0 || !raw.strength.is_finite() {
        let message = format!("is {}; the force at contact needs to be 0 or more", Number(raw.strength));
        return Err(Fault::new("repulsion.strength", message));
    }
    if let Some(range) = raw.range.filter(|r| !(*r > 0.0 && *r <= 1.0)) {
        let range = Number(range);
        let message = format!("is {range}; the gap where the barrier starts needs 0 < range <= 1, in mean radii");
        return Err(Fault::new("repulsion.range", message));
    }
    if raw.radius_power > 2 {
        let message = format!(
            "is {}; the force at contact grows with the 0th (the same for all, the default), 1st or 2nd power of the \
             harmonic mean radius of the two spheres",
            raw.radius_power
        );
        return Err(Fault::new("repulsion.radius_power", message));
    }
    if raw.calibrate && raw.strength == 0.0 {
        let message = "is 0, but repulsion.calibrate is true; give the strength where the search starts";
        return Err(Fault::new("repulsion.strength", message));
    }
    let raw::Repulsion { strength, range, radius_power, calibrate } = *raw;
    Ok(Repulsion { strength, radius_power, range, calibrate })
}

fn hydrodynamics(raw: &raw::Hydrodynamics) -> Result<Hydrodynamics, Fault> {
    let key = |name: &str| format!("hydrodynamics.{name}");
    checks::between(&key("tolerance"), raw.tolerance, [1e-12, 0.1])?;
    if let Some(tolerance) = raw.iteration_tolerance {
        checks::between(&key("iteration_tolerance"), tolerance, [1e-14, 0.1])?;
    }
    if let Some(support) = raw.support.filter(|s| !(2..=64).contains(s)) {
        return Err(Fault::new(key("support"), format!("is {support}; a stencil covers 2 to 64 grid points")));
    }
    for (axis, points) in raw.grid.iter().flatten().enumerate() {
        checks::grid_points(&key(&format!("grid[{axis}]")), *points)?;
    }
    let costs =
        raw.costs.map(|costs| [("stencils", costs.stencils), ("transforms", costs.transforms), ("pairs", costs.pairs)]);
    for (name, cost) in costs.iter().flatten() {
        checks::between(&key(&format!("costs.{name}")), *cost, [0.01, 100.0])?;
    }
    lubrication(raw)?;
    Ok(Hydrodynamics {
        multipoles: raw.multipoles,
        tolerance: raw.tolerance,
        method: raw.method,
        grid: raw.grid,
        support: raw.support,
        iteration_tolerance: raw.iteration_tolerance,
        costs: costs.map(|costs| costs.map(|(_, cost)| cost)),
        lubrication: raw.lubrication,
        lubrication_cutoff: raw.lubrication_cutoff,
        preconditioner: raw.preconditioner,
    })
}

fn lubrication(raw: &raw::Hydrodynamics) -> Result<(), Fault> {
    if raw.lubrication && raw.multipoles == Multipoles::Monopole {
        let message = "is true, but hydrodynamics.multipoles is \"monopole\"; lubrication needs \"dipole\"";
        return Err(Fault::new("hydrodynamics.lubrication", message));
    }
    if !raw.preconditioner && !raw.lubrication {
        let message = "is false, but only a solve with lubrication has one; write lubrication = true or leave it out";
        return Err(Fault::new("hydrodynamics.preconditioner", message));
    }
    match raw.lubrication_cutoff {
        Some(_) if !raw.lubrication => {
            let message = "is set, but there is no lubrication; write lubrication = true or leave it out";
            Err(Fault::new("hydrodynamics.lubrication_cutoff", message))
        }
        Some(cutoff) if !(cutoff > 1e-3 && cutoff <= 8.0) => {
            let message = format!(
                "is {}; the gap where lubrication ends needs 0.001 < cutoff <= 8, in radii of a pair's larger sphere",
                Number(cutoff)
            );
            Err(Fault::new("hydrodynamics.lubrication_cutoff", message))
        }
        _ => Ok(()),
    }
}

fn time(raw: &raw::Time) -> Result<Time, Fault> {
    Time::until(raw.step, raw.steps, raw.duration)
}

fn integrator(raw: &raw::Time) -> Result<Integrator, Fault> {
    let adaptive = raw.integrator == raw::Integrator::Adaptive;
    let order = raw.order.unwrap_or(4);
    if adaptive && raw.order.is_some() {
        let message = "is set, but \"adaptive\" chooses its own; leave it out";
        return Err(Fault::new("time.order", message));
    }
    if !(2..=4).contains(&order) {
        return Err(Fault::new(
            "time.order",
            format!("is {order}; the Adams-Bashforth methods here have order 2, 3 or 4"),
        ));
    }
    let mut chosen = Adaptive::default();
    for (name, given, value) in [
        ("tolerance", raw.tolerance, &mut chosen.tolerance),
        ("gap_fraction", raw.gap_fraction, &mut chosen.gap_fraction),
    ] {
        let key = format!("time.{name}");
        match given {
            Some(_) if !adaptive => {
                let message = "is set, but steps are all alike; set time.integrator = \"adaptive\" or leave it out";
                return Err(Fault::new(key, message));
            }
            Some(given) => *value = checks::between(&key, given, [1e-10, 0.9])?,
            None => {}
        }
    }
    Ok(if adaptive { Integrator::Adaptive(chosen) } else { Integrator::AdamsBashforth { order } })
}

fn output(raw: raw::Output, steps: u64) -> Output {
    Output {
        folder: raw.folder,
        trajectory: Schedule::every(raw.trajectory_every.unwrap_or(share(steps, 100))),
        observables: Schedule::every(raw.observables_every.unwrap_or(1)),
        checkpoints: Schedule::every(raw.checkpoint_every.unwrap_or(share(steps, 10))),
        fields: Schedule::every(raw.fields_every),
    }
}
