//! Scenes of disks that collide in a sheared liquid.

mod raw;

use crate::StartSource;
use crate::answers::AnswersSection;
use crate::checks::rows;
use crate::key_error::KeyError;
use crate::time_and_output::{OutputSchedules, Time, steps_in};
use domain::Number;
use granular::disks::{DiskFlow, DiskModel, DiskParameters, DiskSpecies, Preparation, Sizes};
pub(super) use raw::DisksSections;
use std::path::Path;

/// A checked scene of granular disks; only [`Scene`](crate::Scene) makes one.
#[derive(Debug)]
#[non_exhaustive]
pub struct GranularDisksScene {
    /// Title in plots and files.
    pub title: String,
    /// The disks, their flow and their seed. Disks from a file have their own radii.
    pub model: DiskModel,
    /// File of the disks' positions; `None` for a random start.
    pub start: Option<StartSource>,
    /// Strain of the box at the start, if the scene sets it; by default that of the file's box.
    pub strain: Option<f64>,
    /// Strips over the height in the profile.
    pub profile_strips: usize,
    /// Time step and number of steps.
    pub time: Time,
    /// The time from which the answers take their means; the transient is left out that is found where there is none.
    pub answers_from: Option<f64>,
    /// Schedules and files of the output.
    pub output: OutputSchedules,
}

/// Default number of rows of the time series.
const ROWS: u64 = 500;
/// Strips of the profile by default.
const STRIPS: usize = 50;

impl GranularDisksScene {
    pub(super) fn checked(raw: &DisksSections, folder: &Path) -> Result<Self, KeyError> {
        let parameters = parameters(raw)?;
        let model = DiskModel::new(parameters)?;
        let time = time(raw, model.parameters())?;
        let output = raw.output.schedules().checked(time.steps, ROWS);
        output.check(time.steps, model.sizes().len() as f64)?;
        let profile_strips = rows("output.profile_strips", raw.output.profile_strips.unwrap_or(STRIPS))?;
        if profile_strips == 0 {
            return Err(KeyError::new("output.profile_strips", "is 0; a profile needs at least one strip"));
        }
        Ok(Self {
            title: raw.title.clone().unwrap_or_default(),
            start: start(&raw.particles, folder)?,
            strain: strain(raw)?,
            model,
            profile_strips,
            answers_from: AnswersSection::start(raw.answers, &time)?,
            time,
            output,
        })
    }
}

/// File that the disks come from.
fn start(raw: &raw::DiskParticlesSection, folder: &Path) -> Result<Option<StartSource>, KeyError> {
    for (name, is_set) in [("frame", raw.frame.is_some()), ("group", raw.group.is_some())] {
        if is_set && raw.path.is_none() {
            let message = "goes with particles.path only; leave it out, or name a file";
            return Err(KeyError::new(format!("particles.{name}"), message));
        }
    }
    let source = |path| StartSource { path: folder.join(path), frame: raw.frame, group: raw.group.clone() };
    Ok(raw.path.as_ref().map(source))
}

/// Strain of the box set in the scene.
fn strain(raw: &DisksSections) -> Result<Option<f64>, KeyError> {
    match raw.cell.strain {
        Some(_) if raw.particles.path.is_none() => {
            let message =
                "is that of a box that disks of a file were in; name that file by particles.path, or leave it out";
            Err(KeyError::new("box.strain", message))
        }
        strain => Ok(strain),
    }
}

fn parameters(raw: &DisksSections) -> Result<DiskParameters, KeyError> {
    let usual = DiskParameters::default();
    Ok(DiskParameters {
        edges: raw.cell.edges,
        strain: raw.cell.strain.unwrap_or(usual.strain),
        area_fraction: area_fraction(raw)?,
        sizes: sizes(raw)?,
        length_unit: raw.particles.length_unit.map_or(usual.length_unit, Into::into),
        mass_exponent: raw.particles.mass_exponent.unwrap_or(usual.mass_exponent),
        restitution: raw.contact.restitution.unwrap_or(usual.restitution),
        clip_attraction: raw.contact.suppress_attraction,
        viscosity: raw.fluid.viscosity,
        flow: flow(&raw.flow)?,
        gear: raw.time.integrator.map_or(usual.gear, Into::into),
        time_step: raw.time.step.unwrap_or(usual.time_step),
        preparation: preparation(&raw.preparation, usual.preparation),
        seed: raw.seed.unwrap_or(usual.seed),
        measure_every: raw.output.measure_every.unwrap_or(usual.measure_every),
    })
}

fn preparation(raw: &raw::PreparationSection, usual: Preparation) -> Preparation {
    Preparation {
        restitution: raw.restitution.unwrap_or(usual.restitution),
        settled: raw.inelastic_until.unwrap_or(usual.settled),
        mixed: raw.elastic_until.unwrap_or(usual.mixed),
        gear: raw.integrator.map_or(usual.gear, Into::into),
        time_step: raw.time_step.unwrap_or(usual.time_step),
    }
}

fn area_fraction(raw: &DisksSections) -> Result<f64, KeyError> {
    let key = "particles.area_fraction";
    match (raw.particles.area_fraction, &raw.particles.path) {
        (Some(_), Some(_)) => {
            Err(KeyError::new(key, "is set, but particles.path brings the disks; leave one of them out"))
        }
        (None, None) => {
            Err(KeyError::new(key, "is missing; say how much of the area disks cover, or name a particles.path"))
        }
        (fraction, _) => Ok(fraction.unwrap_or(DiskParameters::default().area_fraction)),
    }
}

fn sizes(raw: &DisksSections) -> Result<Sizes, KeyError> {
    let species = |s: &raw::DiskSpeciesSection| DiskSpecies { radius: s.radius, share: s.number_fraction };
    match (&raw.particles.spread, raw.species.is_empty(), &raw.particles.path) {
        (Some(_), false, _) => {
            Err(KeyError::new("particles.spread", "is set, and [[species]] too; leave one of them out"))
        }
        (Some(s), true, _) => Ok(Sizes::Spread { smallest: s.smallest, largest: s.largest, exponent: s.exponent }),
        (None, true, None) => Err(KeyError::new(
            "species",
            "is missing; write [[species]] sections with radius and number_fraction, or particles.spread",
        )),
        (None, true, Some(_)) => Ok(Sizes::monodisperse()),
        (None, false, _) => Ok(Sizes::DiskSpecies(raw.species.iter().map(species).collect())),
    }
}

fn flow(raw: &raw::DiskFlowSection) -> Result<DiskFlow, KeyError> {
    use raw::DiskFlowKind::{None as Still, Poiseuille, Shear};
    for (key, is_set, kind, name) in
        [("flow.rate", raw.rate.is_some(), Shear, "shear"), ("flow.peak", raw.peak.is_some(), Poiseuille, "poiseuille")]
    {
        if is_set != (raw.kind == kind) {
            let message = if is_set {
                format!("goes with flow.kind = \"{name}\" only; leave it out or change that")
            } else {
                format!("is missing; a flow of kind \"{name}\" needs it")
            };
            return Err(KeyError::new(key, message));
        }
    }
    Ok(match raw.kind {
        Still => DiskFlow::Still,
        Shear => DiskFlow::Shear { rate: raw.rate.unwrap_or_default() },
        Poiseuille => DiskFlow::Poiseuille { peak: raw.peak.unwrap_or_default() },
    })
}

fn time(raw: &DisksSections, parameters: &DiskParameters) -> Result<Time, KeyError> {
    let (time, step) = (&raw.time, parameters.time_step);
    let Some(strain) = time.strain else { return Time::until(step, time.steps, time.duration) };
    if time.steps.is_some() || time.duration.is_some() {
        return Err(KeyError::new("time.strain", "is set, and steps or duration too; leave all but one of them out"));
    }
    let rate = parameters.flow.rate(parameters.edges[1]).abs();
    let possible = rate > 0.0 && strain > 0.0 && strain.is_finite();
    if !possible {
        let message = format!("is {}; it needs to be above 0, in a flow that shears", Number(strain));
        return Err(KeyError::new("time.strain", message));
    }
    Time::of_steps(step, steps_in(strain / rate, step), "time.strain")
}
