//! Calibration of the repulsion: the least strength that keeps spheres apart.

use crate::error::StartError;
use crate::error::step::StepError;
use crate::model::{Model, Parameters, Repulsion};
use crate::suspension::Suspension;
use domain::{Comm, GivenPositions, Number, ParameterError};

/// Steps of a trial, unless the model has fewer.
const TRIAL: u64 = 200;
/// Ratio of a sufficient and an insufficient strength at which the search ends.
const CLOSE: f64 = 1.1;
/// Largest factor between the initial strength and those that are tried.
const FARTHEST: f64 = 1e6;

/// Error of the calibration.
#[derive(Debug, thiserror::Error)]
pub enum LeastRepulsionError {
    /// No strength suffices.
    #[error(
        "no repulsion.strength up to {:.2} keeps the spheres apart; try a smaller time.step, or time.integrator = \
         \"adaptive\"",
        Number(*.0)
    )]
    NoneSuffices(f64),
    /// A strength out of its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A trial could not be started.
    #[error("in a trial with repulsion.strength = {}", Number(*strength))]
    Start {
        /// Strength of the trial.
        strength: f64,
        /// Cause.
        source: Box<StartError>,
    },
    /// A trial failed for a reason other than its strength.
    #[error("in a trial with repulsion.strength = {}", Number(*strength))]
    Step {
        /// Strength of the trial.
        strength: f64,
        /// Cause.
        source: Box<StepError>,
    },
}

/// Least `repulsion.strength`, to 10%, with which no spheres overlap in the first 200 steps, if the model asks for it
/// by `repulsion.calibrate`. The strength is doubled or halved until one value fails and one suffices, then the bracket
/// is bisected at the geometric mean. Collective.
pub fn least_repulsion(
    model: &Model,
    placed: Option<&GivenPositions>,
    comm: &Comm,
) -> Result<Option<f64>, LeastRepulsionError> {
    let Some(repulsion) = model.repulsion.filter(|repulsion| repulsion.calibrate) else { return Ok(None) };
    let suffices = |strength: f64| {
        let repulsion = Some(Repulsion { strength, calibrate: false, ..repulsion });
        let trial = Model::new(Parameters { repulsion, ..Parameters::clone(model) })?;
        keeps_apart(&trial, placed.cloned(), comm, strength)
    };
    least(repulsion.strength, suffices).map(Some)
}

/// Least strength that suffices, approximately.
fn least(start: f64, suffices: impl Fn(f64) -> Result<bool, LeastRepulsionError>) -> Result<f64, LeastRepulsionError> {
    let (mut enough, mut less) = (start, start);
    while !suffices(enough)? {
        (less, enough) = (enough, 2.0 * enough);
        if enough >= FARTHEST * start {
            return Err(LeastRepulsionError::NoneSuffices(enough));
        }
    }
    while less >= enough && enough > start / FARTHEST {
        less = 0.5 * enough;
        if suffices(less)? {
            enough = less;
        }
    }
    while enough > CLOSE * less {
        let between = (less * enough).sqrt();
        if suffices(between)? {
            enough = between;
        } else {
            less = between;
        }
    }
    Ok(enough)
}

/// Whether no spheres overlap in a trial. Collective.
fn keeps_apart(
    model: &Model,
    placed: Option<GivenPositions>,
    comm: &Comm,
    strength: f64,
) -> Result<bool, LeastRepulsionError> {
    let started = Suspension::start_with(model, placed, comm);
    let mut suspension = started.map_err(|source| LeastRepulsionError::Start { strength, source: Box::new(source) })?;
    for _ in 0..model.steps.min(TRIAL) {
        match suspension.step() {
            Ok(()) if suspension.report().smallest_gap > 0.0 => {}
            Ok(()) | Err(StepError::Collision { .. } | StepError::NotFinite(_)) => return Ok(false),
            Err(source) => return Err(LeastRepulsionError::Step { strength, source: Box::new(source) }),
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Hydrodynamics, Species, Start};
    use domain::{PeriodicBox, Vector};

    /// Two spheres pushed together by forces of 10 need a repulsive force of 10 at contact.
    #[test]
    fn two_spheres_need_as_much_as_pushes_them() {
        let pushed = |name, force| Species { force: Vector::X * force, ..Species::new(name, 1.0, 1) };
        let species = vec![pushed("right", 10.0), pushed("left", -10.0)];
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
        let model = Model::new(Parameters {
            start: Start::Positions(vec![Vector::new(4.9, 6.0, 6.0), Vector::new(7.0, 6.0, 6.0)]),
            hydrodynamics: Hydrodynamics { tolerance: 1e-2, ..Hydrodynamics::default() },
            repulsion: Some(Repulsion { calibrate: true, ..Repulsion::new(2.0) }),
            ..Parameters::new(cell, 1.0, species, 0.04, 150)
        });
        let strength = least_repulsion(&model.unwrap(), None, &Comm::alone()).unwrap().unwrap();
        assert!((9.9..11.1).contains(&strength), "{strength}");
    }

    #[test]
    fn the_search_meets_in_the_middle_from_either_side() {
        for start in [0.01, 7.0, 4e3] {
            let found = least(start, |strength| Ok(strength >= 5.0)).unwrap();
            assert!((5.0..5.0 * CLOSE).contains(&found), "from {start}: {found}");
        }
        assert!(least(1.0, |_| Ok(false)).unwrap_err().to_string().contains("smaller time.step"));
    }
}
