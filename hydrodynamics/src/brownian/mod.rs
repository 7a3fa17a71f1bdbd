//! Random motions, stored in columns of the particles, and their finite differences.

mod held;

pub use held::{store_held_drift, store_held_solution};

use crate::ambient::StrainRate;
use crate::coupled_solver::{CoupledSolver, DisplacedSpheres};
use crate::solution::{Guess, Solution, SolveInput, StoredSolution};
use domain::parallel::{FusedLoops, change, change_rows, copied, mapped};
use domain::{Particles, PeriodicBox, Traceless, Vector};
use fcm::{Loads, Motion, SolveError};

/// Column of the ambient motion of the fluid at each particle, and its width. This column and the following ones do not
/// exist between steps.
pub const AMBIENT: &str = "ambient motion";
/// Numbers of a particle in that column.
pub const AMBIENT_NUMBERS: usize = 11;

/// Columns of random motions, loads and stresslets (first the far-field part).
const RANDOM: [&str; 2] = ["random velocity", "random angular velocity"];
const LOADS: [&str; 2] = ["random force", "random torque"];
const STRESSLETS: [&str; 2] = ["random far stresslet", "random stresslet"];

/// Column of Brownian stresslets of the last step, if they are separated from the random stresslets.
pub const BROWNIAN: &str = "brownian stresslet";

/// Columns of the Brownian drift; each draw is a random estimate of its mean.
pub const DRIFT_VELOCITY: &str = "drift velocity";
/// Angular velocities of the drift.
pub const DRIFT_ANGULAR_VELOCITY: &str = "drift angular velocity";
const DRIFT: [&str; 2] = [DRIFT_VELOCITY, DRIFT_ANGULAR_VELOCITY];

/// Column of displacements that are taken back.
pub const DISPLACEMENT: &str = "random displacement";

/// Numbers per particle in all of these and in [`BROWNIAN`].
pub const RANDOM_NUMBERS: usize = 3 * 7 + 5 * 3;

/// Largest drift of a sphere in a step, over its radius; usually the drift is some thousandths.
pub const FARTHEST: f64 = 0.05;

/// Relative error of the finite difference of random motions; the statistical error of a mean is much larger.
pub const CHANGE: f64 = 0.03;

/// Solves for the motions of rigid particles under random loads in the given ambient motions, and stores the result and
/// the ambient motions for which it is exact. Collective; fails on every rank or on none.
pub fn solve(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &mut Particles,
    loads: &Loads,
    fluid: &Motion,
) -> Result<Solution, SolveError> {
    let acting = SolveInput { ambient: fluid, ..SolveInput::new(loads, StrainRate::default()) };
    let solved = hydrodynamics.solve(cell, particles, &acting, Guess::induced_by(fluid))?;
    store_solution(hydrodynamics, cell, particles, loads, &solved)?;
    Ok(solved)
}

/// Stores a solution under loads, and the ambient motions for which it is exact. Collective; fails on every rank or on
/// none.
pub fn store_solution(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &mut Particles,
    loads: &Loads,
    solved: &Solution,
) -> Result<(), SolveError> {
    let (exact, found) = hydrodynamics.equivalent_ambient(cell, particles, loads, solved)?;
    set_ambient(particles, &exact, 1.0);
    store_in_columns(particles, loads, &found);
    Ok(())
}

/// Parameters of the finite difference of random motions.
#[derive(Debug, Clone, Copy)]
pub struct FiniteDifference {
    /// Divisor of the difference.
    pub over: f64,
    /// Thermal energy.
    pub energy: f64,
    /// Relative error of the difference.
    pub tolerance: f64,
}

/// Stores the Brownian drift and stresslets: the change of the stored random motions and stresslets from the positions
/// where they were solved for to the present ones, with the same fluid and loads, divided by `over`. Collective; fails
/// on every rank or on none.
///
/// Let the displacement be `h v` with the former velocities of the fluid, whose covariance with its motions `(v, w, e)`
/// is `2 kT / dt` times the mobility of the method. With `over = 2 h / dt`, the means are `kT div M` for the mobility
/// `M` of rigid, lubricated spheres, and `-kT div D` for the first moments caused by forces. Near walls, where the
/// divergence of the method's mobility is nonzero, `over` times `kT` times this divergence is added to the motion of
/// the fluid.
pub fn store_drift(
    hydrodynamics: &mut CoupledSolver,
    cell: &PeriodicBox,
    particles: &mut Particles,
    FiniteDifference { over, energy, tolerance }: FiniteDifference,
) -> Result<(), SolveError> {
    let (mut fluid, loads, found) = (ambient(particles), loads(particles), load_from_columns(particles));
    hydrodynamics.add_divergence(cell, particles, over * energy, &mut fluid);
    let moved = DisplacedSpheres { cell, particles, loads: &loads, ambient: &fluid };
    let (mut motion, stresslets) = hydrodynamics.perturbed_solution(&moved, &found, tolerance)?;
    motion.add(-1.0, &found.motion);
    for (name, list) in DRIFT.into_iter().zip([motion.velocities, motion.angular_velocities]) {
        change(particles.vectors(name), &list, |drift, &change| *drift = change * (1.0 / over));
    }
    let of_row = |row: usize| (stresslets[row] - found.stresslets[row]) * (1.0 / over);
    change_rows(tensors(particles, BROWNIAN), |row, stresslet| *stresslet = of_row(row));
    Ok(())
}

/// Stores the Brownian drift of particles without resistance to strain: the thermal energy times the divergence of the
/// method's mobility.
pub fn store_divergence(hydrodynamics: &mut CoupledSolver, cell: &PeriodicBox, particles: &mut Particles, energy: f64) {
    let mut motion = Motion { velocities: vec![Vector::ZERO; particles.len()], ..Motion::default() };
    hydrodynamics.add_divergence(cell, particles, energy, &mut motion);
    particles.vectors(DRIFT_VELOCITY).copy_from_slice(&motion.velocities);
}

/// The stored drift and Brownian stresslets.
pub fn drift(particles: &mut Particles) -> (Motion, Vec<Traceless>) {
    let [velocities, angular_velocities] = DRIFT.map(|name| copied(particles.vectors(name)));
    (Motion { velocities, angular_velocities, strain_rates: Vec::new() }, tensors(particles, BROWNIAN).to_vec())
}

/// Limits drift velocities to a displacement of a twentieth of the radius in a time. Larger values result from the
/// change of random loads alone, where a gap almost vanishes and the displacement of the finite difference does not.
pub fn limit_drift(particles: &mut Particles, time: f64) {
    let most = mapped(&particles.radii, |radius| FARTHEST * radius / time);
    change(particles.vectors(DRIFT_VELOCITY), &most, |velocity, &most| *velocity = velocity.clamp_length_max(most));
}

/// Limits angular drift velocities in the same way, to a rotation by a twentieth of a radian in a time.
pub fn limit_angular_drift(particles: &mut Particles, time: f64) {
    let limited = |_, velocity: &mut Vector| *velocity = velocity.clamp_length_max(FARTHEST / time);
    change_rows(particles.vectors(DRIFT_ANGULAR_VELOCITY), limited);
}

/// Stores displacements by the drawn velocities of the fluid over a time.
pub fn displace(particles: &mut Particles, time: f64) {
    let velocities = ambient(particles).velocities;
    change(particles.vectors(DISPLACEMENT), &velocities, |displacement, &v| *displacement = v * time);
}

/// Removes the columns of random motions.
pub fn clear_history(particles: &mut Particles) {
    let names = [RANDOM, LOADS, STRESSLETS, DRIFT].concat();
    let is_random = |name: &str| name == AMBIENT || name == DISPLACEMENT || names.contains(&name);
    particles.columns.retain(|column| !is_random(&column.name));
}

/// Stores `amplitude` times a motion as the ambient motion of the fluid.
pub fn set_ambient(particles: &mut Particles, motion: &Motion, amplitude: f64) {
    let Motion { velocities, angular_velocities, strain_rates } = motion;
    let values = particles.column(AMBIENT, AMBIENT_NUMBERS).values.as_chunks_mut::<AMBIENT_NUMBERS>().0;
    change_rows(values, |row, values| {
        let turning = angular_velocities.get(row).copied().unwrap_or_default();
        let strain = strain_rates.get(row).copied().unwrap_or_default();
        values[..3].copy_from_slice(&velocities[row].to_array());
        values[3..6].copy_from_slice(&turning.to_array());
        values[6..].copy_from_slice(&strain.0);
        *values = values.map(|value| value * amplitude);
    });
}

/// The stored ambient motion of the fluid.
pub fn ambient(particles: &mut Particles) -> Motion {
    let values = particles.column(AMBIENT, AMBIENT_NUMBERS).values.as_chunks::<AMBIENT_NUMBERS>().0;
    let (mut motion, mut loops) = (Motion::default(), FusedLoops::default());
    loops.mapped(&mut motion.velocities, values, |of_one| Vector::from_slice(of_one));
    loops.mapped(&mut motion.angular_velocities, values, |of_one| Vector::from_slice(&of_one[3..]));
    loops.mapped(&mut motion.strain_rates, values, |&[_, _, _, _, _, _, strain @ ..]| Traceless(strain));
    loops.run();
    motion
}

/// Stores loads and the solution under them.
fn store_in_columns(particles: &mut Particles, loads: &Loads, found: &StoredSolution) {
    let Motion { velocities, angular_velocities, .. } = &found.motion;
    let vectors = RANDOM.into_iter().zip([velocities, angular_velocities]);
    for (name, list) in vectors.chain(LOADS.into_iter().zip([&loads.forces, &loads.torques])) {
        change(particles.vectors(name), list, |value, &noted| *value = noted);
    }
    for (name, list) in STRESSLETS.into_iter().zip([&found.stresslets_far, &found.stresslets]) {
        change(tensors(particles, name), list, |value, &noted| *value = noted);
    }
}

fn loads(particles: &mut Particles) -> Loads {
    let [forces, torques] = LOADS.map(|name| copied(particles.vectors(name)));
    Loads { forces, torques, stresslets: Vec::new() }
}

fn load_from_columns(particles: &mut Particles) -> StoredSolution {
    let [velocities, angular_velocities] = RANDOM.map(|name| copied(particles.vectors(name)));
    let [stresslets_far, stresslets] = STRESSLETS.map(|name| copied(tensors(particles, name)));
    StoredSolution {
        motion: Motion { velocities, angular_velocities, strain_rates: Vec::new() },
        stresslets_far,
        stresslets,
    }
}

fn tensors<'a>(particles: &'a mut Particles, name: &str) -> &'a mut [Traceless] {
    bytemuck::cast_slice_mut(&mut particles.column(name, 5).values)
}

#[cfg(test)]
mod tests;
