//! Rank-one correction of the mobility by a flow whose amplitude follows from the loads.

use crate::mobility::loads::{Loads, Motion};
use domain::Comm;

/// A flow in which particles have the motions `m` at unit amplitude. Under loads `f` its amplitude is
///
/// ```text
/// c = -m . f / alpha,        m . f = sum (F . U + T . Omega - S : E).
/// ```
///
/// An example is the flow that keeps the flux between walls what it is without loads. The mobility `M` becomes
/// `M - m m^T / alpha`: symmetric, and positive definite if no flow can have an amplitude without the loads doing
/// work.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// `m`, of the particles that the rank owns.
    pub response: Motion,
    /// `1 / alpha`, positive.
    pub compliance: f64,
}

impl Constraint {
    /// Amplitude of the flow under loads. Collective.
    pub fn amplitude(&self, loads: &Loads, comm: &Comm) -> f64 {
        let mut power = [self.response.power(loads)];
        comm.sum(&mut power);
        -self.compliance * power[0]
    }

    /// Adds the flow to the motion that the loads cause. Collective.
    pub(crate) fn add_to(&self, motion: &mut Motion, loads: &Loads, comm: &Comm) {
        motion.add(self.amplitude(loads, comm), &self.response);
    }
}
