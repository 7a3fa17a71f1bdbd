//! Loads and motions in columns of the particles, which migrate with them between ranks.

use super::Motions;
use super::bodies::BodySpheres;
use crate::solution::Solution;
use domain::{Particles, Traceless};
use fcm::Motion;

/// Names of the columns with the particles' loads and motions.
pub mod column {
    pub const FORCE: &str = "force";
    pub const TORQUE: &str = "torque";
    pub const VELOCITY: &str = "velocity";
    pub const ANGULAR_VELOCITY: &str = "angular_velocity";
    pub const STRAIN_RATE: &str = "strain_rate";
    pub const STRESSLET: &str = "stresslet";
    pub const STRESSLET_FAR: &str = "far stresslet";
}

/// Writes a solution into the particles' columns; gathering sorts them by id.
pub fn record(particles: &mut Particles, solved: &Solution) {
    record_motion(particles, &solved.motion);
    for (name, list) in [(column::STRESSLET, &solved.stresslets), (column::STRESSLET_FAR, &solved.far.stresslets)] {
        fill(traceless(particles, name), list);
    }
}

pub fn record_motion(particles: &mut Particles, motion: &Motion) {
    let Motion { velocities, angular_velocities, strain_rates } = motion;
    fill(particles.vectors(column::VELOCITY), velocities);
    fill(particles.vectors(column::ANGULAR_VELOCITY), angular_velocities);
    fill(traceless(particles, column::STRAIN_RATE), strain_rates);
}

/// The motions in the columns of gathered particles.
pub fn moved(all: &mut Particles) -> Motion {
    Motion {
        velocities: all.vectors(column::VELOCITY).to_vec(),
        angular_velocities: all.vectors(column::ANGULAR_VELOCITY).to_vec(),
        strain_rates: traceless(all, column::STRAIN_RATE).to_vec(),
    }
}

pub fn motions(mut all: Particles, solved: &Solution, bodies: &BodySpheres) -> Motions {
    Motions {
        motion: moved(&mut all),
        stresslets: traceless(&mut all, column::STRESSLET).to_vec(),
        stresslets_far: traceless(&mut all, column::STRESSLET_FAR).to_vec(),
        iterations: solved.iterations,
        residual: solved.residual,
        bodies: bodies.motions(&mut all),
        driving: bodies.driving(&mut all),
    }
}

/// Copies known values; the rest is unchanged.
pub fn fill<T: Copy>(values: &mut [T], known: &[T]) {
    values.iter_mut().zip(known).for_each(|(value, &known)| *value = known);
}

pub fn traceless<'a>(particles: &'a mut Particles, name: &str) -> &'a mut [Traceless] {
    bytemuck::cast_slice_mut(&mut particles.column(name, 5).values)
}
