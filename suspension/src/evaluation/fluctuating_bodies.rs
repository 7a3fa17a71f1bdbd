//! Random motions of rigid bodies.
//!
//! With the motions `v` of the fluid at the spheres, whose covariance is `2 kT / dt` times the mobility `M` of the
//! method, the rigid motions `G v` of bodies are the means over their spheres, `G K = 1` for the `K` of all rigid
//! motions. By `G v` bodies are displaced to the midpoint of a step. For the mobility `N` of bodies the mean of their
//! velocities there is
//!
//! ```text
//! kT div N - kT P div (M G^T)
//! ```
//!
//! with the operator `P` from motions of the fluid to those of bodies, since `N = P M G^T`. For spheres without bodies,
//! `G = 1`, the last term vanishes, except near walls. For bodies `kT div (M G^T)` is added to the motions of the
//! fluid, as a random finite difference: with normal numbers `W` for each body, `M G^T W` at positions displaced by `W`
//! both ways. It contains that of the images of their spheres in walls; free spheres have the divergence of their own.
//! `K`, `G`, `W` and the displacements leave out given components of the motions of bodies.

use super::fluctuating::Noise;
use super::{Dynamics, StageTime};
use crate::bodies;
use crate::columns::{self, PAST};
use crate::error::step::StepError;
use domain::parallel::{copied, greatest};
use domain::{Particles, Random, Vector};
use fcm::{Loads, Motion, Output};
use hydrodynamics::RigidBodies;
use hydrodynamics::brownian::{DISPLACEMENT, ambient, set_ambient};

/// Columns of the loads of the finite difference. They do not exist between steps.
const LOADS: [&str; 2] = ["body force", "body torque"];

/// Displacement of the finite difference, over the smallest radius, at the ends of bodies.
const DISPLACED: f64 = 0.1;

/// Kind of the random numbers of bodies.
const OF_BODIES: u64 = 5;

impl Dynamics {
    /// The motions of the fluid in which spheres of bodies have the mean of their body.
    pub(super) fn rigid_means(&self, particles: &mut Particles, mut drawn: Motion) -> Motion {
        let Some(rigid) = self.bodies(particles) else { return drawn };
        let means = rigid.sphere_motions(&rigid.with_given(rigid.body_motions(&drawn)));
        for row in (0..particles.len()).filter(|&row| rigid.body(row).is_some()) {
            drawn.velocities[row] = means.velocities[row];
            drawn.angular_velocities[row] = means.angular_velocities[row];
        }
        drawn
    }

    /// Stores the velocities of centres that belong to given motions of spheres and the background flow as the first
    /// past ones.
    pub(super) fn note_centres(&self, particles: &mut Particles, own: &Motion) {
        let arms = bodies::arms(particles);
        let Some([past]) = bodies::centres(particles, [PAST[0]]) else { return };
        let members = bodies::members(particles);
        let of_row = |row: usize| {
            let centre = particles.positions[row] - arms[row];
            // Spheres of different radii have the same centre.
            let radius = if members[row].is_some() { 0.0 } else { particles.radii[row] };
            let flow = self.moving.carried_velocity_of(centre, radius);
            own.velocities[row] - own.angular_velocities[row].cross(arms[row]) + flow
        };
        let centres: Vec<Vector> = (0..arms.len()).map(of_row).collect();
        particles.vectors(past).copy_from_slice(&centres);
    }

    /// Draws displacements of bodies, in the columns that belong to [`DISPLACEMENT`], and the loads of the finite
    /// difference. Returns the divisor of the difference. Collective.
    pub fn draw_displacements(&self, particles: &mut Particles, noise: Noise) -> f64 {
        let step = DISPLACED * self.smallest_radius;
        self.draw_loads(particles, noise, step);
        step
    }

    /// Adds `times` the motions that the drawn loads cause at the present positions to those of the fluid. Collective;
    /// fails on every rank or on none.
    pub fn add_caused(&mut self, particles: &mut Particles, moment: &StageTime, times: f64) -> Result<(), StepError> {
        self.wrap_and_migrate(particles, moment)?;
        let [forces, torques] = LOADS.map(|name| copied(particles.vectors(name)));
        let mobility = self.hydrodynamics.mobility();
        mobility.follow(self.moving.cell(), particles);
        let caused = mobility.apply(&Loads { forces, torques, stresslets: Vec::new() }, Output::All);
        let mut fluid = ambient(particles);
        fluid.add(times, &caused);
        set_ambient(particles, &fluid, 1.0);
        Ok(())
    }

    /// Stores random displacements of bodies, of the size of `step`, in the columns of displacements, and the
    /// loads `G^T W` of their spheres.
    fn draw_loads(&self, particles: &mut Particles, noise: Noise, step: f64) {
        let (comm, arms) = (self.partition.comm(), bodies::arms(particles));
        let Some(rigid) = self.bodies(particles) else { return };
        let mut longest = [greatest(&arms, |arm| arm.length()).max(self.smallest_radius)];
        comm.max(&mut longest);
        let counts = counts(&rigid, arms.len());
        let mut rows = vec![[Vector::ZERO; 4]; arms.len()];
        for (row, values) in rows.iter_mut().enumerate() {
            let (Some(body), Some(place)) = (rigid.body(row), rigid.members().place(row)) else { continue };
            let [force, torque] = rigid.free_part(place, normal(&mut noise.stream.of(OF_BODIES, u64::from(body))));
            let (share, arm) = (1.0 / counts[row], arms[row]);
            *values = [
                force * step,
                torque * (step / longest[0]),
                force * share,
                (torque * longest[0] - arm.cross(force)) * share,
            ];
        }
        let names = [columns::centre(DISPLACEMENT), columns::angular(DISPLACEMENT), LOADS[0], LOADS[1]];
        for (k, name) in names.into_iter().enumerate() {
            particles.vectors(name).iter_mut().zip(&rows).for_each(|(value, row)| *value = row[k]);
        }
    }
}

impl Dynamics {
    /// Adds `energy` times the divergence of the mobility with respect to the positions of free spheres to motions of
    /// the fluid; that with respect to the positions of bodies is in the finite difference. Collective.
    pub(super) fn add_divergence_of_free(&mut self, particles: &Particles, energy: f64, motion: &mut Motion) {
        let members = bodies::members(particles);
        let mut with_all = motion.clone();
        self.hydrodynamics.add_divergence(self.moving.cell(), particles, energy, &mut with_all);
        for row in (0..members.len()).filter(|&row| members[row].is_some()) {
            with_all.velocities[row] = motion.velocities[row];
            with_all.angular_velocities[row] = motion.angular_velocities[row];
            with_all.strain_rates[row] = motion.strain_rates[row];
        }
        *motion = with_all;
    }
}

/// Removes the columns of the finite difference.
pub fn clear_displacements(particles: &mut Particles) {
    let passing = [LOADS[0], LOADS[1], DISPLACEMENT, columns::angular(DISPLACEMENT), columns::centre(DISPLACEMENT)];
    particles.columns.retain(|column| !passing.contains(&column.name.as_str()));
}

/// Number of spheres of the body of each row. Collective.
fn counts(rigid: &RigidBodies, rows: usize) -> Vec<f64> {
    let unit = |row: usize| if rigid.body(row).is_some() { Vector::X } else { Vector::ZERO };
    let totals = rigid.total_loads(&Loads { forces: (0..rows).map(unit).collect(), ..Loads::default() });
    let of_row = |row: usize| {
        let place = rigid.numbers().binary_search(&rigid.body(row)?).ok()?;
        Some(totals.forces[place].x)
    };
    (0..rows).map(|row| of_row(row).unwrap_or(1.0)).collect()
}

/// Six normal numbers.
fn normal(random: &mut Random) -> [Vector; 2] {
    let [[a, b], [c, d], [e, f]] = std::array::from_fn(|_| random.normal());
    [Vector::new(a, b, c), Vector::new(d, e, f)]
}
