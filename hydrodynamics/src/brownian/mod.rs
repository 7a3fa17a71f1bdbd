//! Random motions of the particles, in their columns, and how these change with their places.

use crate::ambient::StrainRate;
use crate::coupled_solver::{Acting, Found, Guess, Hydrodynamics, Solved};
use domain::{Particles, PeriodicBox, Traceless, Vector};
use fcm::{Loads, Motion, SolveError};

/// The column of how the fluid moves at each particle besides, and its width. There is no such column between steps, nor any of
/// the following.
const AMBIENT: &str = "ambient motion";
/// Numbers of a particle in that column.
pub const AMBIENT_NUMBERS: usize = 11;

/// Columns of random motions, loads and stresslets, the far field's part of these first.
const RANDOM: [&str; 2] = ["random velocity", "random angular velocity"];
const LOADS: [&str; 2] = ["random force", "random torque"];
const STRESSLETS: [&str; 2] = ["random far stresslet", "random stresslet"];

/// The column of stresslets by heat of the last step, where they are told apart from random ones.
pub const BROWNIAN: &str = "brownian stresslet";

/// Columns of mean motions by heat, of which one draw is a random part.
pub const DRIFT_VELOCITY: &str = "drift velocity";
const DRIFT: [&str; 2] = [DRIFT_VELOCITY, "drift angular velocity"];

/// The column of displacements that are taken back.
pub const DISPLACEMENT: &str = "random displacement";

/// Numbers of a particle in all of these and in [`BROWNIAN`].
pub const RANDOM_NUMBERS: usize = 3 * 7 + 5 * 3;

/// How far drift moves a sphere in a step at most, over its radius: usually it is some thousandths.
const FARTHEST: f64 = 0.05;

/// Error of the change of random motions, over it, that is small enough: noise leaves much more of a mean.
pub const CHANGE: f64 = 0.03;

/// Solves for the random motions of rigid particles under random loads in a fluid that moves at each, and notes both. The fluid
/// that is noted is the one in which they are exact. Collective; fails on every rank or on none.
pub fn solve(
    hydrodynamics: &mut Hydrodynamics,
    (cell, particles): (&PeriodicBox, &mut Particles),
    (loads, fluid): (&Loads, &Motion),
) -> Result<Solved, SolveError> {
    let acting =
        Acting { loads, strain_rate: StrainRate::default(), springs: None, ambient: fluid, constant_flux: false };
    let solved = hydrodynamics.solve(cell, particles, &acting, &Guess::induced_by(fluid))?;
    note_solved(hydrodynamics, (cell, particles), (loads, &solved))?;
    Ok(solved)
}

/// Notes motions that were solved for under loads, and the fluid in which they are exact. Collective; fails on every rank or on none.
pub fn note_solved(
    hydrodynamics: &mut Hydrodynamics,
    (cell, particles): (&PeriodicBox, &mut Particles),
    (loads, solved): (&Loads, &Solved),
) -> Result<(), SolveError> {
    let (exact, found) = hydrodynamics.fluid_around((cell, particles), loads, solved)?;
    set_ambient(particles, &exact, 1.0);
    note(particles, loads, &found);
    Ok(())
}

/// How the change of random motions is made their mean.
#[derive(Debug, Clone, Copy)]
pub struct Change {
    /// What it is divided by.
    pub over: f64,
    /// The thermal energy.
    pub energy: f64,
    /// Its error, relative to it.
    pub tolerance: f64,
}

/// Notes as mean motions and stresslets by heat what random ones that were noted are more where the particles are now, with the same
/// fluid and loads, over a factor. Collective; fails on every rank or on none.
///
/// With the displacement `h v` by the velocities of the fluid before, whose covariance with its motions `(v, w, e)` is `2 kT / dt`
/// times the mobility of the method, that factor is `2 h / dt`, and the means are `kT div M` of the mobility `M` of rigid,
/// lubricated spheres, and `-kT div D` of the first moments that forces cause. Near walls, where the mobility of the method has a
/// divergence itself, the fluid has moved by that factor of `kT` times it besides.
pub fn note_drift(
    hydrodynamics: &mut Hydrodynamics,
    (cell, particles): (&PeriodicBox, &mut Particles),
    Change { over, energy, tolerance }: Change,
) -> Result<(), SolveError> {
    let (mut fluid, loads, found) = (ambient(particles), loads(particles), found(particles));
    hydrodynamics.add_divergence((cell, particles), over * energy, &mut fluid);
    let Found { mut motion, stresslets, .. } =
        hydrodynamics.changed((cell, particles), (&loads, &fluid), &found, tolerance)?;
    motion.add(-1.0, &found.motion);
    for (name, list) in DRIFT.into_iter().zip([motion.velocities, motion.angular_velocities]) {
        particles.vectors(name).iter_mut().zip(list).for_each(|(drift, change)| *drift = change * (1.0 / over));
    }
    let changes = stresslets.iter().zip(&found.stresslets).map(|(&there, &here)| (there - here) * (1.0 / over));
    tensors(particles, BROWNIAN).iter_mut().zip(changes).for_each(|(stresslet, change)| *stresslet = change);
    Ok(())
}

/// Notes the mean motions by heat of particles that do not resist to strain: a thermal energy times the divergence of the mobility of
/// the method.
pub fn note_divergence(
    hydrodynamics: &mut Hydrodynamics,
    (cell, particles): (&PeriodicBox, &mut Particles),
    energy: f64,
) {
    let mut motion = Motion { velocities: vec![Vector::ZERO; particles.len()], ..Motion::default() };
    hydrodynamics.add_divergence((cell, particles), energy, &mut motion);
    particles.vectors(DRIFT_VELOCITY).copy_from_slice(&motion.velocities);
}

/// The mean motions and stresslets by heat that were noted.
pub fn drift(particles: &mut Particles) -> (Motion, Vec<Traceless>) {
    let [velocities, angular_velocities] = DRIFT.map(|name| particles.vectors(name).to_vec());
    (Motion { velocities, angular_velocities, strain_rates: Vec::new() }, tensors(particles, BROWNIAN).to_vec())
}

/// Shortens mean velocities by heat with which a sphere would move farther than a twentieth of its radius in a time. So far it is
/// moved by the change of random loads alone, where a gap is next to nothing and the displacement for which that is taken is not.
pub fn limit_drift(particles: &mut Particles, time: f64) {
    let most: Vec<f64> = particles.radii.iter().map(|radius| FARTHEST * radius / time).collect();
    for (velocity, most) in particles.vectors(DRIFT_VELOCITY).iter_mut().zip(most) {
        *velocity = velocity.clamp_length_max(most);
    }
}

/// Notes displacements by the velocities of the fluid as it was drawn, over a time.
pub fn displace(particles: &mut Particles, time: f64) {
    let displacements: Vec<Vector> = ambient(particles).velocities.into_iter().map(|v| v * time).collect();
    particles.vectors(DISPLACEMENT).copy_from_slice(&displacements);
}

/// Forgets random motions.
pub fn forget(particles: &mut Particles) {
    let names = [RANDOM, LOADS, STRESSLETS, DRIFT].concat();
    let is_random = |name: &str| name == AMBIENT || name == DISPLACEMENT || names.contains(&name);
    particles.columns.retain(|column| !is_random(&column.name));
}

/// Notes how the fluid moves at each particle, so many times a motion.
pub fn set_ambient(particles: &mut Particles, motion: &Motion, amplitude: f64) {
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

/// How the fluid moves at each particle.
pub fn ambient(particles: &mut Particles) -> Motion {
    let mut motion = Motion::default();
    for values in particles.column(AMBIENT, AMBIENT_NUMBERS).values.chunks_exact(AMBIENT_NUMBERS) {
        motion.velocities.push(Vector::from_slice(values));
        motion.angular_velocities.push(Vector::from_slice(&values[3..]));
        motion.strain_rates.push(Traceless(std::array::from_fn(|k| values[6 + k])));
    }
    motion
}

/// Notes loads, and what they and the fluid do.
fn note(particles: &mut Particles, loads: &Loads, found: &Found) {
    let Motion { velocities, angular_velocities, .. } = &found.motion;
    let vectors = RANDOM.into_iter().zip([velocities, angular_velocities]);
    for (name, list) in vectors.chain(LOADS.into_iter().zip([&loads.forces, &loads.torques])) {
        particles.vectors(name).iter_mut().zip(list).for_each(|(value, &noted)| *value = noted);
    }
    for (name, list) in STRESSLETS.into_iter().zip([&found.stresslets_far, &found.stresslets]) {
        tensors(particles, name).iter_mut().zip(list).for_each(|(value, &noted)| *value = noted);
    }
}

fn loads(particles: &mut Particles) -> Loads {
    let [forces, torques] = LOADS.map(|name| particles.vectors(name).to_vec());
    Loads { forces, torques, stresslets: Vec::new() }
}

fn found(particles: &mut Particles) -> Found {
    let [velocities, angular_velocities] = RANDOM.map(|name| particles.vectors(name).to_vec());
    let [stresslets_far, stresslets] = STRESSLETS.map(|name| tensors(particles, name).to_vec());
    Found { motion: Motion { velocities, angular_velocities, strain_rates: Vec::new() }, stresslets_far, stresslets }
}

fn tensors<'a>(particles: &'a mut Particles, name: &str) -> &'a mut [Traceless] {
    bytemuck::cast_slice_mut(&mut particles.column(name, 5).values)
}

#[cfg(test)]
mod tests;
