//! Dynamics in a fluid that fluctuates.

use super::{Dynamics, Moment, Outcome};
use crate::hydrodynamics::Guess;
use crate::integrator::PAST;
use crate::step_error::StepError;
use domain::{Interrupted, Particles, Traceless, Vector};
use fcm::{Motion, Stream};

/// The column of how the fluid moves at each particle besides, and its width; there is none between steps.
const AMBIENT: &str = "ambient motion";
pub const AMBIENT_NUMBERS: usize = 11;

/// Error of random motions over the tolerance.
const ROOT: f64 = 0.3;

impl Dynamics {
    /// Draws how the fluid moves at each particle, by an amplitude; the first column of past velocities has these velocities and
    /// those of the background flow. Collective.
    pub fn fluctuate(&mut self, particles: &mut Particles, (amplitude, stream): (f64, Stream)) {
        let (cell, tolerance) = (*self.moving.cell(), ROOT * self.tolerance);
        let (motion, drawn) = self.hydrodynamics.noise(&cell, particles, (tolerance, stream));
        self.clipped = self.clipped.max(drawn.clipped);
        let places = particles.positions.iter().zip(&particles.radii);
        let carried = motion.velocities.iter().zip(places);
        let velocities: Vec<Vector> =
            carried.map(|(&v, (&x, &a))| v * amplitude + self.moving.carried_velocity_of(x, a)).collect();
        particles.vectors(PAST[0]).copy_from_slice(&velocities);
        let values = &mut particles.column(AMBIENT, AMBIENT_NUMBERS).values;
        for (row, values) in values.chunks_exact_mut(AMBIENT_NUMBERS).enumerate() {
            let turning = motion.angular_velocities.get(row).copied().unwrap_or_default();
            let strain = motion.strain_rates.get(row).copied().unwrap_or_default();
            values[..3].copy_from_slice(&motion.velocities[row].to_array());
            values[3..6].copy_from_slice(&turning.to_array());
            values[6..].copy_from_slice(&strain.0);
            for value in values {
                *value *= amplitude;
            }
        }
    }

    /// As [`Self::evaluate`], with the fluid moving as it was drawn, and noise of lubrication by the same random numbers.
    /// Collective; fails on every rank or on none.
    pub fn evaluate_fluctuating(
        &mut self,
        particles: &mut Particles,
        moment: &Moment,
        (amplitude, stream): (f64, Stream),
    ) -> Result<Outcome, StepError> {
        if self.partition.comm().any(self.hydrodynamics.interrupt().is_requested()) {
            return Err(Interrupted.into());
        }
        self.place(particles, moment)?;
        let cell = *self.moving.cell();
        let (mut loads, tethers) = self.loads_at(particles, moment, None)?;
        let noise = self.hydrodynamics.pair_noise(&cell, particles, stream);
        for (loads, noise) in [(&mut loads.forces, noise.forces), (&mut loads.torques, noise.torques)] {
            loads.resize(particles.len(), Vector::ZERO);
            loads.iter_mut().zip(noise).for_each(|(load, noise)| *load += noise * amplitude);
        }
        let ambient = ambient(particles);
        let guess = Guess {
            induced_velocities: ambient.velocities.clone(),
            induced_angular_velocities: ambient.angular_velocities.clone(),
            ..Guess::default()
        };
        self.solve((particles, &cell), (&loads, (&[], &tethers), &ambient), &guess, moment)
    }

    /// Forgets how the fluid moved.
    pub fn calm(particles: &mut Particles) {
        particles.columns.retain(|column| column.name != AMBIENT);
    }
}

/// How the fluid moves at each particle.
fn ambient(particles: &mut Particles) -> Motion {
    let mut motion = Motion::default();
    for values in particles.column(AMBIENT, AMBIENT_NUMBERS).values.chunks_exact(AMBIENT_NUMBERS) {
        motion.velocities.push(Vector::from_slice(values));
        motion.angular_velocities.push(Vector::from_slice(&values[3..]));
        motion.strain_rates.push(Traceless(std::array::from_fn(|k| values[6 + k])));
    }
    motion
}
