//! Scenes of grains in a shear cell.

mod raw;

use crate::answers::AnswersSection;
use crate::checks::{few_enough, rows};
use crate::key_error::KeyError;
use crate::time_and_output::{OutputSchedules, Time};
use domain::{Number, ParameterError};
use granular::shear_cell::{
    CellModel, CellParameters, CollisionDetection, CollisionRule, Experiment, FrictionLaw, Sampling, Top,
};
pub(super) use raw::ShearCellSections;
use suspension::MAX_SPHERES;

/// A checked scene of grains in a shear cell; only [`Scene`](crate::Scene) makes one.
#[derive(Debug)]
#[non_exhaustive]
pub struct ShearCellScene {
    /// Title in plots and files.
    pub title: String,
    /// The cell, its grains, and the parameters of the run.
    pub experiment: Experiment,
    /// Interval of observation, and number of these.
    pub time: Time,
    /// The time from which the answers take their means; the transient is left out that is found where there is none.
    pub answers_from: Option<f64>,
    /// Schedules and files of the output.
    pub output: OutputSchedules,
}

/// Default contact time, over the time in which a grain crosses a diameter.
const CONTACT: f64 = 2e-4;
/// Default initial standard deviation of the velocities, over the speed of the walls.
const AGITATION: f64 = 0.05;

impl ShearCellScene {
    pub(super) fn checked(raw: ShearCellSections) -> Result<Self, KeyError> {
        let time = Time::until(raw.time.step, raw.time.steps, raw.time.duration)?;
        let agitation = agitation(&raw)?;
        let model = CellModel::new(parameters(&raw, agitation)?)?;
        let collisions = collisions(&raw)?;
        let sampling = sampling(&raw, collisions)?;
        let count = count(&raw.grains, &model)?;
        let output = raw.output.checked(time.steps, time.steps);
        output.check(time.steps, count as f64)?;
        let transient = whole("time.transient", raw.time.transient, "time.step", raw.time.step)?;
        let (seed, time_step, steps) = (raw.seed, time.step, time.steps);
        let experiment =
            Experiment { model, seed, count, agitation, collisions, sampling, transient, time_step, steps };
        let answers_from = AnswersSection::start(raw.answers, &time)?;
        Ok(Self { title: raw.title.unwrap_or_default(), experiment, time, answers_from, output })
    }
}

fn agitation(raw: &ShearCellSections) -> Result<f64, KeyError> {
    let agitation = raw.grains.initial_velocity_deviation.unwrap_or(AGITATION * raw.cell.speed);
    // Its square is part of the energy.
    if (0.0..=1e70).contains(&agitation) {
        return Ok(agitation);
    }
    let message = format!("is {}; it needs to be a speed from 0 to 1e70", Number(agitation));
    Err(KeyError::new("grains.initial_velocity_deviation", message))
}

/// Default time within which two collisions count as one contact: a small fraction of the time in which a grain crosses
/// a diameter, at the speed of the walls plus its own, or from rest under gravity and the load of the top wall.
fn contact_time(raw: &ShearCellSections, agitation: f64) -> f64 {
    let fall = raw.cell.gravity + raw.top.pressure.zip(raw.top.mass_per_area).map_or(0.0, |(p, m)| p / m);
    let crossings = (raw.cell.speed + agitation) / raw.grains.diameter + (fall / raw.grains.diameter).sqrt();
    // If nothing moves, any time will do.
    if crossings > 0.0 { CONTACT / crossings } else { CONTACT * raw.time.step }
}

fn parameters(raw: &ShearCellSections, agitation: f64) -> Result<CellParameters, KeyError> {
    let (cell, grains, walls) = (&raw.cell, &raw.grains, &raw.walls);
    let law = match walls.friction_law {
        raw::FrictionLawKind::Box => FrictionLaw::Box,
        raw::FrictionLawKind::Cone => FrictionLaw::Cone,
    };
    Ok(CellParameters {
        length: cell.length,
        height: cell.height,
        width: cell.width,
        diameter: grains.diameter,
        density: grains.density,
        grain_contact: CollisionRule { restitution: grains.restitution, friction: grains.friction, law },
        wall_contact: CollisionRule { restitution: walls.restitution, friction: walls.friction, law },
        speed: cell.speed,
        top: top(&raw.top)?,
        gravity: cell.gravity,
        circumference: cell.circumference,
        coriolis: cell.coriolis,
        contact_time: grains.contact_time.unwrap_or_else(|| contact_time(raw, agitation)),
    })
}

fn top(raw: &raw::TopSection) -> Result<Top, KeyError> {
    match (raw.kind, raw.pressure, raw.mass_per_area) {
        (raw::TopKind::Fixed, None, None) => Ok(Top::Fixed),
        (raw::TopKind::Fixed, ..) => Err(KeyError::new(
            "top",
            "is fixed, but has a pressure or a mass; set top.kind = \"free\" or leave them out",
        )),
        (raw::TopKind::Free, Some(pressure), Some(mass_per_area)) => Ok(Top::Free { pressure, mass_per_area }),
        (raw::TopKind::Free, ..) => {
            Err(KeyError::new("top", "is free, so it needs both a pressure that loads it and a mass_per_area"))
        }
    }
}

fn collisions(raw: &ShearCellSections) -> Result<CollisionDetection, KeyError> {
    let key = "time.collision_step";
    match (raw.collisions, raw.time.collision_step) {
        (raw::Collisions::EventDriven, None) => Ok(CollisionDetection::EventDriven),
        (raw::Collisions::EventDriven, Some(_)) => {
            Err(KeyError::new(key, "goes with collisions = \"time-stepped\" only; leave it out or change that"))
        }
        (raw::Collisions::TimeStepped, Some(step)) => Ok(CollisionDetection::TimeStepped { step }),
        (raw::Collisions::TimeStepped, None) => Err(KeyError::new(key, "is missing; time-stepped collisions need it")),
    }
}

const WINDOW: &str = "measure.window";

fn sampling(raw: &ShearCellSections, collisions: CollisionDetection) -> Result<Sampling, KeyError> {
    let usual = Sampling::default();
    let sampling = Sampling {
        window: raw.measure.window.unwrap_or(raw.time.step),
        every: 1,
        layers: raw.measure.layers.unwrap_or(usual.layers),
        pixels: raw.measure.pixels.unwrap_or(usual.pixels),
    };
    rows("measure.layers", sampling.layers)?;
    rows("measure.pixels", sampling.pixels[0].saturating_mul(sampling.pixels[1]))?;
    sampling.check(collisions).map_err(|error| match error {
        // The window is one step if the scene does not set it.
        ParameterError { key, message } if key == WINDOW && raw.measure.window.is_none() => {
            KeyError::new("time.step", message)
        }
        other => other.into(),
    })?;
    let every = whole("time.step", raw.time.step, WINDOW, sampling.window)?;
    Ok(Sampling { every, ..sampling })
}

/// Ratio of a time to a unit, which must be a whole number.
fn whole(key: &str, time: f64, unit: &str, length: f64) -> Result<u64, KeyError> {
    let times = time / length;
    let fits = time >= 0.0 && (times - times.round()).abs() <= 1e-6 * times && times < 1e15;
    let fault = || {
        let message = format!("is {}; it needs a whole number of {unit}, which is {}", Number(time), Number(length));
        KeyError::new(key, message)
    };
    if fits { Ok(times.round() as u64) } else { Err(fault()) }
}

fn count(raw: &raw::GrainsSection, model: &CellModel) -> Result<usize, KeyError> {
    match (raw.count, raw.solid_fraction) {
        (Some(count), None) => {
            let volume = std::f64::consts::PI / 6.0 * model.parameters().diameter.powi(3);
            let fraction = count as f64 * volume / model.edges().element_product();
            few_enough("grains.count", &format!("{count}"), count as f64, "grains")?;
            if count > 0 && fraction <= 0.62 {
                return Ok(count as usize);
            }
            let message =
                format!("is {count}, a solid fraction of {fraction:.3}; it needs at least 1 and at most 0.62");
            Err(KeyError::new("grains.count", message))
        }
        (None, Some(fraction)) => match model.count(fraction)? {
            count if count as f64 > MAX_SPHERES => {
                let found = format!("{}, with grains.diameter = {}", Number(fraction), Number(raw.diameter));
                few_enough("grains.solid_fraction", &found, count as f64, "grains").map(|()| count)
            }
            0 => Err(KeyError::new(
                "grains.solid_fraction",
                format!("is {}, which is less than one grain", Number(fraction)),
            )),
            count => Ok(count),
        },
        (None, None) => Err(KeyError::new("grains", "has neither count nor solid_fraction; set one of them")),
        (Some(_), Some(_)) => Err(KeyError::new("grains", "has both count and solid_fraction; leave one of them out")),
    }
}
