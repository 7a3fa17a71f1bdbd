//! Harmonic traps.

use crate::forces::Prediction;
use crate::model::Model;
use domain::{Particles, PeriodicBox, Vector};
use fcm::Loads;

/// Column of the traps: the unwrapped centre of the particle's trap, and the index of the trap's kind in the model plus
/// 1 (0 without a trap).
pub const TRAPS: &str = "traps";
pub const TRAP_NUMBERS: usize = 4;

/// The traps of a suspension.
pub struct Traps {
    stiffness: Vec<f64>,
}

impl Traps {
    pub(super) fn of(model: &Model) -> Option<Self> {
        let stiffness: Vec<f64> = model.traps.iter().map(|traps| traps.stiffness).collect();
        (!stiffness.is_empty()).then_some(Self { stiffness })
    }

    /// Stiffness of each particle's trap (0 without one), and displacement from its centre.
    fn each(&self, particles: &Particles, cell: &PeriodicBox) -> Vec<(f64, Vector)> {
        let of_one = |(row, numbers): (usize, &[f64; TRAP_NUMBERS])| {
            let place = particles.positions[row] + cell.lattice(particles.steps[row]);
            (self.stiffness_of(numbers), place - Vector::from_slice(numbers))
        };
        rows(particles).iter().enumerate().map(of_one).collect()
    }

    fn stiffness_of(&self, numbers: &[f64; TRAP_NUMBERS]) -> f64 {
        if numbers[3] > 0.0 { self.stiffness[numbers[3] as usize - 1] } else { 0.0 }
    }

    /// Adds the known part of the trap force. With `x*` and `u*` the expected positions and velocities after a time
    /// `t`, the force is `-k (x* - c) - t k (u - u*)`.
    pub(super) fn add_to(
        &self,
        loads: &mut Loads,
        particles: &Particles,
        cell: &PeriodicBox,
        ahead: Option<&Prediction>,
    ) {
        loads.forces.resize(particles.len(), Vector::ZERO);
        for (row, (stiffness, away)) in self.each(particles, cell).into_iter().enumerate() {
            let expected = ahead.map_or(Vector::ZERO, |ahead| ahead.time * ahead.velocities[row]);
            loads.forces[row] += stiffness * (expected - away);
        }
    }

    pub(super) fn resistances(&self, particles: &Particles, time: f64) -> Vec<f64> {
        rows(particles).iter().map(|numbers| time * self.stiffness_of(numbers)).collect()
    }

    pub(super) fn energy(&self, particles: &Particles, cell: &PeriodicBox) -> f64 {
        self.each(particles, cell).into_iter().map(|(k, away)| 0.5 * k * away.length_squared()).sum()
    }
}

/// The column's numbers for each particle.
fn rows(particles: &Particles) -> &[[f64; TRAP_NUMBERS]] {
    let column = particles.columns.iter().find(|column| column.name == TRAPS);
    column.map_or(&[], |column| column.values.as_chunks().0)
}
