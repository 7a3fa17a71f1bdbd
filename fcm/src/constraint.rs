//! A flow besides whose amplitude follows from the loads.

use crate::loads::{Loads, Motion};
use domain::Comm;

/// A flow in which particles have the motions `m` at unit amplitude, and whose amplitude under loads `f` is
///
/// ```text
/// c = -m . f / alpha,        m . f = sum (F . U + T . Omega - S : E),
/// ```
///
/// such as that which leaves the flux between walls what it is without loads. The mobility `M` is `M - m m^T / alpha` with it: symmetric,
/// and positive definite as long as no flow can have an amplitude that loads do not pay for.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// `m`, of the particles that the rank owns.
    pub response: Motion,
    /// `1 / alpha`, positive.
    pub compliance: f64,
}

impl Constraint {
    /// The amplitude under loads. Collective.
    pub fn amplitude(&self, loads: &Loads, comm: &Comm) -> f64 {
        let mut power = [self.response.power(loads)];
        comm.sum(&mut power);
        -self.compliance * power[0]
    }

    /// Adds the flow under loads to a motion that they cause. Collective.
    pub(crate) fn add_to(&self, motion: &mut Motion, loads: &Loads, comm: &Comm) {
        motion.add(self.amplitude(loads, comm), &self.response);
    }
}
