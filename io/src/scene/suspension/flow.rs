//! The background flow of a scene.

use super::raw;
use crate::scene::error::Fault;
use domain::Number;
use suspension::{Flow, RateChange};

/// A time may be off a step by this part of it.
const ROUND_OFF: f64 = 1e-6;

/// The flow at first, and the changes of its rate, in steps of a length.
pub fn flow(raw: Option<&raw::Flow>, time_step: f64) -> Result<(Flow, Vec<RateChange>), Fault> {
    let Some(raw) = raw else { return Ok((Flow::None, Vec::new())) };
    if let raw::FlowKind::None = raw.kind {
        let keys = [("flow.rate", raw.rate.is_some()), ("flow.reversal_at", raw.reversal_at.is_some())];
        return match keys.into_iter().find(|(_, is_set)| *is_set) {
            None => Ok((Flow::None, Vec::new())),
            Some((key, _)) => {
                let message = "is set, but flow.kind is \"none\"; set flow.kind = \"shear\" or leave it out";
                Err(Fault::new(key, message))
            }
        };
    }
    let Some(rate) = &raw.rate else {
        return Err(Fault::new("flow.rate", "is missing; a shear flow u = rate y needs it"));
    };
    let (rate, changes) = match (rate, &raw.reversal_at) {
        (raw::Rate::Number(rate), None) => (*rate, Vec::new()),
        (raw::Rate::Number(rate), Some(strains)) => (*rate, reversals(*rate, strains, time_step)?),
        (raw::Rate::Table(table), None) => from_table(table, time_step)?,
        (raw::Rate::Table(_), Some(_)) => {
            let message = "goes with one flow.rate; with a table of rates give the reversals there";
            return Err(Fault::new("flow.reversal_at", message));
        }
    };
    Ok((Flow::Shear { rate, lees_edwards: raw.lees_edwards.unwrap_or(true) }, changes))
}

fn reversals(rate: f64, strains: &[f64], time_step: f64) -> Result<Vec<RateChange>, Fault> {
    let mut sign = 1.0;
    let mut reverse = |(k, strain): (usize, &f64)| {
        sign = -sign;
        let step = step_at(strain / rate.abs(), time_step, &format!("flow.reversal_at[{k}]"), *strain)?;
        Ok(RateChange { step, rate: sign * rate })
    };
    strains.iter().enumerate().map(&mut reverse).collect()
}

fn from_table(table: &[[f64; 2]], time_step: f64) -> Result<(f64, Vec<RateChange>), Fault> {
    let [[0.0, first], later @ ..] = table else {
        return Err(Fault::new("flow.rate", "is a table that does not start at time 0; begin it with [0.0, rate]"));
    };
    let change = |(k, &[time, rate]): (usize, &[f64; 2])| {
        Ok(RateChange { step: step_at(time, time_step, &format!("flow.rate[{}]", k + 1), time)?, rate })
    };
    Ok((*first, later.iter().enumerate().map(change).collect::<Result<_, Fault>>()?))
}

/// The step that begins at a time, which a key says in some way.
fn step_at(time: f64, time_step: f64, key: &str, said: f64) -> Result<u64, Fault> {
    let steps = time / time_step;
    let whole = steps.round();
    if whole >= 1.0 && (steps - whole).abs() <= ROUND_OFF * whole.max(1.0) && whole < 1e15 {
        return Ok(whole as u64);
    }
    let [said, step] = [said, time_step].map(Number);
    let message =
        format!("is {said}, where no step begins; steps of time.step = {step} need to begin where the rate changes");
    Err(Fault::new(key, message))
}
