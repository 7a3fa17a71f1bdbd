//! Interface of all forces.

use super::acting::{Acting, Configuration, Instant, Prediction, SolvedMotion};
use crate::error::step::StepError;
use crate::model::Model;
use crate::model::radii::Radii;
use domain::{Bytes, DomainView, ExpectedCounts, Failure, Particles, Tensor};
use fcm::Loads;

/// A contribution of a force to the stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StressName {
    /// Name; its quantity of the time series is `stress_` followed by this.
    pub name: &'static str,
    /// Whether its tensor is symmetric, as that of any force which exerts no torque on the suspension as a whole. The
    /// time series has six components of a symmetric tensor and nine of another.
    pub is_symmetric: bool,
}

impl StressName {
    /// The name of a symmetric contribution.
    pub const fn symmetric(name: &'static str) -> Self {
        Self { name, is_symmetric: true }
    }

    /// The name of a contribution that need not be symmetric.
    pub const fn general(name: &'static str) -> Self {
        Self { name, is_symmetric: false }
    }
}

/// A force on or between particles, besides those of the fluid: everything that evaluations, stresses, implicit steps
/// and predictions of memory ask of it. A force of pairs is easiest written as a [`PairLaw`](super::pairwise::PairLaw).
///
/// Methods that take particles are collective: every rank calls them for its own particles. A method that can fail
/// fails on every rank or on none.
pub trait Force {
    /// Name, different for each force of a suspension.
    fn name(&self) -> &'static str;

    /// Adds the loads at present positions. Collective.
    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads);

    /// Adds the loads for a solve, and with a [prediction](Instant::prediction) the implicit resistances; ambient
    /// motions of the fluid as well, if there are any. By default the loads at present positions, which makes steps
    /// explicit in this force. Collective.
    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        self.add_present_loads(&at.configuration(), &mut acting.loads);
        Ok(())
    }

    /// Largest distance of two centres at which it acts, for particles up to a radius: [`Configuration::near`] has all
    /// these pairs. `None` for a force that needs no pairs.
    fn range(&self, _largest_radius: f64) -> Option<f64> {
        None
    }

    /// The same in the loads of solves, [`Self::add_loads`], to which others may add the forces of pairs.
    fn range_in_solves(&self, largest_radius: f64) -> Option<f64> {
        self.range(largest_radius)
    }

    /// Contributions to the stress; none by default.
    fn stresses(&self) -> Vec<StressName> {
        Vec::new()
    }

    /// Contributions of this rank's particles to the first moments, a list for each of [`Self::stresses`]; a list may
    /// be empty for zeros. The sum of all particles over the volume is the stress. A pair at `x_i` and `x_j` with
    /// the force `F` on the first contributes `-(x_i - x_j) F`, divided between the two, and a torque `T` on a particle
    /// minus half of the tensor `A` with `A v = T x v`; the column `b` of the tensor belongs to faces normal to `b` and
    /// its entry `a` to forces along `a`. With velocities `beyond` those of a prediction, implicit forces change in
    /// proportion. Collective.
    fn moments(&self, _at: &Configuration, _beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        Vec::new()
    }

    /// The `xy` component of the sum of [`Self::moments`] of this rank's particles, at the end of the evaluation in
    /// progress. Collective.
    fn shear_moment(&self, at: &Configuration, beyond: Option<&Prediction>) -> f64 {
        let of_list = |list: &Vec<Tensor>| list.iter().map(|moment| moment.y_axis.x).sum::<f64>();
        self.moments(at, beyond).iter().map(of_list).sum()
    }

    /// Distance of two centres up to which it has implicit resistances; `None` if it has none.
    fn implicit_range(&self, _largest_radius: f64) -> Option<f64> {
        None
    }

    /// Whether it needs the motions of solutions: the [previous](Instant::previous) ones for its loads, which then are
    /// added after those of all other forces, and the new ones in [`Self::solved`].
    fn follows_motion(&self) -> bool {
        false
    }

    /// Takes note of the motions of a solution, if it [follows](Self::follows_motion) them. Collective.
    fn solved(&mut self, _particles: &mut Particles, _solved: &SolvedMotion) -> Result<(), Failure> {
        Ok(())
    }

    /// Ends a step. Collective.
    fn end_step(&mut self, _particles: &mut Particles, _domain: DomainView) -> Result<(), Failure> {
        Ok(())
    }

    /// The error of a step in which this force failed.
    fn explain(&self, step: u64, source: Failure) -> StepError {
        StepError::Applied { step, source }
    }

    /// Numbers for each particle in its columns, on a rank with expected numbers of particles.
    fn numbers(&self, _expected: &ExpectedCounts) -> usize {
        0
    }

    /// Memory of an evaluation on a rank with expected numbers of particles.
    fn bytes(&self, _expected: &ExpectedCounts) -> Bytes {
        Bytes::default()
    }

    /// Warnings about a model with this force, one sentence each.
    fn warnings(&self, _model: &Model, _radii: &Radii) -> Vec<String> {
        Vec::new()
    }
}
