//! Advection of particles by the flow in which a box moves.

use super::{CellMotion, PeriodicCell, velocities};
use crate::bodies;
use crate::flow::deformation::Deformation;
use domain::parallel::change_rows;
use domain::{Particles, Tensor, Vector};

impl PeriodicCell {
    /// Whether velocities are relative to the flow while particles move.
    pub fn advects(&self) -> bool {
        self.rates.frequency().is_some()
            || self.driven.is_some()
            || matches!(self.motion, CellMotion::Stretching(_) | CellMotion::Open(_))
    }

    /// Velocity gradient of the flow relative to which velocities are while particles move, if they are.
    pub fn advecting_gradient(&self) -> Option<Tensor> {
        self.advects().then(|| self.flow.gradient())
    }

    /// Deformation of the box that advects the particles, over a coming time; under stress control, `weights` are those
    /// of the present and past rates and of the mean over the last substep.
    pub fn advect(&self, duration: f64, weights: [f64; 3]) -> Deformation {
        match &self.driven {
            Some(driven) => self.deformation(driven.advect(weights)),
            None => self.deformation_to(self.time + duration),
        }
    }

    /// Deformation by the flow over a strain.
    pub fn deformation(&self, strain: f64) -> Deformation {
        match &self.motion {
            CellMotion::Stretching(lattice) => Deformation::Stretch(lattice.kind().stretch(strain)),
            CellMotion::Open(extension) => Deformation::Stretch(extension.stretch(strain)),
            CellMotion::Still | CellMotion::Shearing => {
                Deformation::Shear(Vector::AXES[self.start.gradient_axis()] * strain)
            }
        }
    }

    /// Deformation by the flow, if it advects the particles, from the present to a time, at given rates.
    pub(super) fn deformation_to(&self, time: f64) -> Deformation {
        let is_advecting = self.advects();
        self.deformation(if is_advecting { self.rates.strain(time) - self.rates.strain(self.time) } else { 0.0 })
    }

    /// Continues with the rate at a time, if it varies continuously.
    pub(super) fn set_rate_at(&mut self, time: f64) {
        if self.rates.frequency().is_some() {
            self.set_rate(self.rates.before_time(time));
        }
    }
}

/// Advects particles with a flow, together with their velocities relative to it. Bodies are advected with their centres
/// and not deformed.
pub(super) fn carry_by(deformation: Deformation, particles: &mut Particles) {
    let carry = |vectors: &mut [Vector]| change_rows(vectors, |_, vector| *vector = deformation.of(*vector));
    let arms = bodies::arms(particles);
    if arms.is_empty() {
        carry(&mut particles.positions);
    } else {
        let carry = |row: usize, place: Vector| deformation.of(place - arms[row]) + arms[row];
        change_rows(&mut particles.positions, |row, place| *place = carry(row, *place));
    }
    velocities(particles).for_each(carry);
}
