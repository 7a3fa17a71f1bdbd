//! Length of a run of spheres: steps, a duration, or a strain.

use super::raw;
use crate::checks::positive;
use crate::key_error::KeyError;
use crate::time_and_output::{Time, steps_in};
use suspension::{Flow, Protocol, RateChange};

const KEY: &str = "time.strain";

/// Number of steps of a run in a flow, and under a given stress the strain at which it ends.
pub(super) fn time(raw: &raw::TimeSection, flow: &Flow, protocol: &Protocol) -> Result<(Time, Option<f64>), KeyError> {
    let has_other = raw.steps.is_some() || raw.duration.is_some();
    let Some(strain) = raw.strain else {
        return Ok((Time::until(raw.step, raw.steps, raw.duration)?, None));
    };
    positive(KEY, strain)?;
    match protocol {
        Protocol::Stress(_) if has_other => Ok((Time::until(raw.step, raw.steps, raw.duration)?, Some(strain))),
        Protocol::Stress(_) => Err(KeyError::new(
            KEY,
            "is set in a flow under a given stress, whose rate nobody knows before: set time.duration too, the \
             longest time that the strain may take",
        )),
        _ if has_other => Err(KeyError::new(KEY, "is set, and steps or duration too; leave all but one of them out")),
        Protocol::Oscillation { .. } => {
            Err(KeyError::new(KEY, "is set, but a strain that oscillates has no end; set time.duration or time.steps"))
        }
        Protocol::Steps(changes) => {
            let steps = steps_to(strain, rate_of(flow)?, changes, raw.step)?;
            Ok((Time::of_steps(raw.step, steps, KEY)?, None))
        }
    }
}

fn rate_of(flow: &Flow) -> Result<f64, KeyError> {
    match flow {
        Flow::Shear { rate, .. } | Flow::Extension { rate, .. } => Ok(*rate),
        _ => Err(KeyError::new(
            KEY,
            "is set, but nothing is sheared; set flow.kind = \"shear\", or time.duration or time.steps",
        )),
    }
}

/// Number of steps to reach a strain, counted as its absolute value, at a rate that changes.
fn steps_to(strain: f64, first: f64, changes: &[RateChange], step: f64) -> Result<u64, KeyError> {
    let (mut rate, mut from, mut left) = (first.abs(), 0, strain);
    for change in changes {
        let until_change = rate * step * (change.step - from) as f64;
        if left <= until_change * (1.0 + 1e-12) {
            break;
        }
        left -= until_change;
        (rate, from) = (change.rate.abs(), change.step);
    }
    if rate > 0.0 {
        Ok(from.saturating_add(steps_in(left / rate, step)))
    } else {
        Err(KeyError::new(KEY, "is never reached: the rate of the flow is 0 before; set time.duration or time.steps"))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Kind, Scene};

    /// Number of steps of a run, and the strain at which it ends.
    fn of(flow: &str, time: &str) -> (u64, Option<f64>) {
        let text = format!(
            "box.edges = [9.0, 9.0, 9.0]\nfluid.viscosity = 1.0\nflow = {{ {flow} }}\n\
             time = {{ step = 0.125, {time} }}\n[[species]]\nradius = 1.0\ncount = 4\n"
        );
        let scene = Scene::parse(&text, "scene.toml", &[]).unwrap();
        let Kind::Suspension(suspension) = scene.kind() else { panic!("a suspension") };
        (scene.kind().steps(), suspension.model.last_strain)
    }

    #[test]
    fn a_strain_is_as_many_steps_as_its_rates_make_it() {
        assert_eq!(of("kind = \"shear\", rate = -2.0", "strain = 3.0"), (12, None));
        assert_eq!(of("kind = \"planar-extension\", rate = 0.5", "strain = 1.0"), (16, None));
        assert_eq!(of("kind = \"shear\", rate = 2.0", "strain = 3.1"), (13, None));
        // Forward by 1 in 4 steps, then back by the remaining 2.
        assert_eq!(of("kind = \"shear\", rate = 2.0, reversal_at = [1.0]", "strain = 3.0"), (12, None));
        // A strain of 1 in 4 steps, and of 2 at half the rate in 16.
        assert_eq!(of("kind = \"shear\", rate = [[0.0, 2.0], [0.5, 1.0]]", "strain = 3.0"), (20, None));
        assert_eq!(of("kind = \"shear\", rate = [[0.0, 2.0], [0.5, 0.0]]", "strain = 1.0"), (4, None));
        let by_stress = "kind = \"shear\", control = \"stress\", stress = 1.0";
        assert_eq!(of(by_stress, "strain = 3.0, duration = 9.0"), (72, Some(3.0)));
    }
}
