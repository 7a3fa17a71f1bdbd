//! The background flow of a scene.

use super::raw;
use crate::checks::positive;
use crate::document::NumberOr;
use crate::key_error::KeyError;
use domain::Number;
use suspension::{Extension, Flow, Protocol, RateChange};

/// Relative deviation of a time from a whole number of steps that counts as round-off.
const ROUND_OFF: f64 = 1e-6;

/// The initial flow, and the changes of its rate, in steps of the given length. The box shears with the flow if
/// `shears`, unless the scene says otherwise.
pub fn flow(
    raw: Option<&raw::FlowSection>,
    viscosity: f64,
    time_step: f64,
    shears: bool,
) -> Result<(Flow, Protocol), KeyError> {
    let Some(raw) = raw else { return Ok((Flow::None, Protocol::STEADY)) };
    if let raw::FlowKind::None | raw::FlowKind::Poiseuille = raw.kind {
        let keys = [
            ("flow.rate", raw.rate.is_some()),
            ("flow.reversal_at", raw.reversal_at.is_some()),
            ("flow.oscillation", raw.oscillation.is_some()),
            ("flow.control", raw.control.is_some()),
            ("flow.stress", raw.stress.is_some()),
        ];
        return match keys.into_iter().find(|(_, is_set)| *is_set) {
            None => without_rate(raw),
            Some((key, _)) => {
                let kind = name(raw.kind);
                let message = format!("is set, but flow.kind is \"{kind}\"; set flow.kind = \"shear\" or leave it out");
                Err(KeyError::new(key, message))
            }
        };
    }
    unless_poiseuille(raw)?;
    let (rate, protocol) = match (raw.control, raw.stress) {
        (Some(raw::Control::Stress), Some(stress)) => driven(raw, stress, viscosity)?,
        (Some(raw::Control::Stress), None) => {
            return Err(KeyError::new("flow.stress", "is missing; flow.control = \"stress\" needs it"));
        }
        (_, Some(_)) => {
            let message = "is set, but the rate is given; set flow.control = \"stress\" or leave it out";
            return Err(KeyError::new("flow.stress", message));
        }
        _ => rates(raw, time_step)?,
    };
    let Some(kind) = extension(raw.kind) else {
        return Ok((Flow::Shear { rate, lees_edwards: raw.lees_edwards.unwrap_or(shears) }, protocol));
    };
    let message = match raw.lees_edwards {
        Some(false) if shears => "is false, but in an extension the box is stretched with the flow; leave it out",
        Some(_) if !shears => {
            "is set, but in unbounded fluid there is no box that could go with the flow; leave it out"
        }
        _ => return Ok((Flow::Extension { kind, rate }, protocol)),
    };
    Err(KeyError::new("flow.lees_edwards", message))
}

fn without_rate(raw: &raw::FlowSection) -> Result<(Flow, Protocol), KeyError> {
    let error = |key: &str, message: &str| Err(KeyError::new(key, message));
    if raw.kind != raw::FlowKind::Poiseuille {
        return unless_poiseuille(raw).map(|()| (Flow::None, Protocol::STEADY));
    }
    match (raw.pressure_gradient, raw.mean_velocity) {
        (Some(pressure_gradient), None) => Ok((Flow::Poiseuille { pressure_gradient }, Protocol::STEADY)),
        (None, Some(mean_velocity)) => Ok((Flow::ConstantFlux { mean_velocity }, Protocol::STEADY)),
        (None, None) => {
            error("flow.pressure_gradient", "is missing; flow.kind = \"poiseuille\" needs it, or flow.mean_velocity")
        }
        (Some(_), Some(_)) => error(
            "flow.mean_velocity",
            "is set beside flow.pressure_gradient, which follows from it; leave one of the two out",
        ),
    }
}

/// Refuses keys of a pressure-driven flow.
fn unless_poiseuille(raw: &raw::FlowSection) -> Result<(), KeyError> {
    let keys = [
        ("flow.pressure_gradient", raw.pressure_gradient.is_some()),
        ("flow.mean_velocity", raw.mean_velocity.is_some()),
    ];
    let kind = name(raw.kind);
    keys.into_iter().find(|(_, is_set)| *is_set).map_or(Ok(()), |(key, _)| {
        let message = format!("is set, but flow.kind is \"{kind}\"; set flow.kind = \"poiseuille\" or leave it out");
        Err(KeyError::new(key, message))
    })
}

/// The kind of extension, if the flow is one.
pub fn extension(kind: raw::FlowKind) -> Option<Extension> {
    match kind {
        raw::FlowKind::None | raw::FlowKind::Shear | raw::FlowKind::Poiseuille => None,
        raw::FlowKind::PlanarExtension => Some(Extension::Planar),
        raw::FlowKind::UniaxialExtension => Some(Extension::Uniaxial),
        raw::FlowKind::BiaxialExtension => Some(Extension::Biaxial),
    }
}

/// Name in scenes.
fn name(kind: raw::FlowKind) -> &'static str {
    match kind {
        raw::FlowKind::None => "none",
        raw::FlowKind::Shear => "shear",
        raw::FlowKind::Poiseuille => "poiseuille",
        raw::FlowKind::PlanarExtension => "planar-extension",
        raw::FlowKind::UniaxialExtension => "uniaxial-extension",
        raw::FlowKind::BiaxialExtension => "biaxial-extension",
    }
}

fn rates(raw: &raw::FlowSection, time_step: f64) -> Result<(f64, Protocol), KeyError> {
    match (&raw.rate, &raw.reversal_at, &raw.oscillation) {
        (None, None, Some(oscillation)) => oscillating(oscillation),
        (rate, _, Some(_)) => {
            let key = if rate.is_some() { "flow.rate" } else { "flow.reversal_at" };
            Err(KeyError::new(
                key,
                "is set beside flow.oscillation, which says the whole strain; leave one of them out",
            ))
        }
        (None, _, None) => {
            let flow = if extension(raw.kind).is_some() { "an extension" } else { "a shear flow u = rate y" };
            Err(KeyError::new("flow.rate", format!("is missing; {flow} needs it")))
        }
        (Some(NumberOr::Number(rate)), None, _) => Ok((*rate, Protocol::STEADY)),
        (Some(NumberOr::Number(rate)), Some(strains), _) => {
            Ok((*rate, Protocol::Steps(reversals(*rate, strains, time_step)?)))
        }
        (Some(NumberOr::Other(table)), None, _) => from_table(table, time_step),
        (Some(NumberOr::Other(_)), Some(_), _) => {
            let message = "goes with one flow.rate; with a table of rates give the reversals there";
            Err(KeyError::new("flow.reversal_at", message))
        }
    }
}

fn driven(raw: &raw::FlowSection, stress: f64, viscosity: f64) -> Result<(f64, Protocol), KeyError> {
    let is_table = matches!(raw.rate, Some(NumberOr::Other(_)));
    let keys = [
        ("flow.oscillation", raw.oscillation.is_some()),
        ("flow.reversal_at", raw.reversal_at.is_some()),
        ("flow.rate", is_table),
    ];
    if let Some((key, _)) = keys.into_iter().find(|(_, is_set)| *is_set) {
        let message = "can't be with flow.control = \"stress\", where the rate is what the stress makes it; leave one \
            of them out";
        return Err(KeyError::new(key, message));
    }
    if !stress.is_finite() {
        return Err(KeyError::new("flow.stress", format!("is {}; it needs to be a finite number", Number(stress))));
    }
    positive("fluid.viscosity", viscosity)?;
    let rate = if let Some(NumberOr::Number(rate)) = raw.rate { rate } else { stress / viscosity };
    Ok((rate, Protocol::Stress(stress)))
}

fn oscillating(raw: &raw::OscillationSection) -> Result<(f64, Protocol), KeyError> {
    let frequency = positive("flow.oscillation.frequency", raw.frequency)?;
    let amplitude = positive("flow.oscillation.amplitude", raw.amplitude)?;
    let rate = amplitude * frequency;
    if !rate.is_finite() {
        let message = "has a largest rate, amplitude times frequency, beyond the range of numbers; take smaller ones";
        return Err(KeyError::new("flow.oscillation", message));
    }
    Ok((rate, Protocol::Oscillation { frequency }))
}

fn reversals(rate: f64, strains: &[f64], time_step: f64) -> Result<Vec<RateChange>, KeyError> {
    let mut sign = 1.0;
    let mut reverse = |(k, strain): (usize, &f64)| {
        sign = -sign;
        let step = step_at(strain / rate.abs(), time_step, &format!("flow.reversal_at[{k}]"), *strain)?;
        Ok(RateChange { step, rate: sign * rate })
    };
    strains.iter().enumerate().map(&mut reverse).collect()
}

fn from_table(table: &[[f64; 2]], time_step: f64) -> Result<(f64, Protocol), KeyError> {
    let [[0.0, first], later @ ..] = table else {
        return Err(KeyError::new("flow.rate", "is a table that does not start at time 0; begin it with [0.0, rate]"));
    };
    let change = |(k, &[time, rate]): (usize, &[f64; 2])| {
        Ok(RateChange { step: step_at(time, time_step, &format!("flow.rate[{}]", k + 1), time)?, rate })
    };
    Ok((*first, Protocol::Steps(later.iter().enumerate().map(change).collect::<Result<_, KeyError>>()?)))
}

/// The step that begins at a time; `key` and `said` are the key and its value in the scene.
fn step_at(time: f64, time_step: f64, key: &str, said: f64) -> Result<u64, KeyError> {
    let steps = time / time_step;
    let whole = steps.round();
    if whole >= 1.0 && (steps - whole).abs() <= ROUND_OFF * whole.max(1.0) && whole < 1e15 {
        return Ok(whole as u64);
    }
    let [said, step] = [said, time_step].map(Number);
    let message =
        format!("is {said}, where no step begins; steps of time.step = {step} need to begin where the rate changes");
    Err(KeyError::new(key, message))
}
