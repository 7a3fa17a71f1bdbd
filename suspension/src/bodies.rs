//! Motion of rigid bodies, whose spheres are particles like all others.
//!
//! A sphere of a body knows its place in the axes of the body, its arm `a`, and the orientation `q` of the body, so
//! that the centre of the body is at
//!
//! ```text
//! c = x - q a
//! ```
//!
//! Beside each column of velocities is one of the velocities of centres, `V = U - Omega x q a`, by which centres move
//! in all integrators, while orientations rotate as those of spheres do. Spheres follow, `x = c + q a`, so that bodies
//! stay rigid to round-off, however long a step is, and no rank needs to know the other spheres of a body. For spheres
//! that belong to none, the arm is zero: the centre is that of the sphere.

use crate::columns::{
    self, ANGULAR_VELOCITY, ARM, BODY, CONSTRAINT_LOAD, CONSTRAINT_LOAD_NUMBERS, CONSTRAINT_MOMENT,
    CONSTRAINT_MOMENT_NUMBERS, VELOCITY,
};
use crate::rotation;
use domain::parallel::{change, change_rows, copied, mapped, of_rows, overwrite};
use domain::{Comm, Halo, Particles, Tensor, Vector};
use fcm::Loads;
use hydrodynamics::RigidBodies;

/// Whether some particles may belong to bodies.
pub fn exist(particles: &Particles) -> bool {
    particles.columns.iter().any(|column| column.name == BODY)
}

/// Columns of the velocities of centres that belong to columns of velocities; `None` without bodies.
pub fn centres<const N: usize>(particles: &Particles, velocities: [&str; N]) -> Option<[&'static str; N]> {
    exist(particles).then(|| velocities.map(columns::centre))
}

/// The number of the body of each particle, -1 for those that belong to none; empty without bodies.
pub fn numbers(particles: &Particles) -> &[f64] {
    particles.columns.iter().find(|column| column.name == BODY).map_or(&[], |column| &column.values)
}

/// [`members`] of particles and ghosts; empty without bodies. Collective.
pub fn with_ghosts(particles: &Particles, halo: &Halo) -> Vec<Option<u32>> {
    let mut all = copied(numbers(particles));
    if exist(particles) {
        halo.extend(&mut all);
    }
    mapped(&all, |&number| member(number))
}

fn member(number: f64) -> Option<u32> {
    (number >= 0.0).then_some(number as u32)
}

/// The number of the body of each particle, `None` for those that belong to none.
pub fn members(particles: &Particles) -> Vec<Option<u32>> {
    mapped(numbers(particles), |&number| member(number))
}

/// The bodies of a rank's particles, for a solve; `None` without bodies. Collective.
pub fn of(particles: &mut Particles, comm: &Comm) -> Option<RigidBodies> {
    let arms = arms(particles);
    exist(particles).then(|| RigidBodies::new(comm, &members(particles), &arms))
}

/// Vectors from the centres of bodies to their spheres, zero for particles that belong to none; empty without bodies.
pub fn arms(particles: &mut Particles) -> Vec<Vector> {
    if !exist(particles) {
        return Vec::new();
    }
    let fixed = copied(particles.vectors(ARM));
    let orientations = rotation::orientations(particles);
    of_rows(
        fixed.len(),
        |row| if fixed[row] == Vector::ZERO { Vector::ZERO } else { orientations[row].rotate(fixed[row]) },
    )
}

/// Moves spheres with the rotation of their bodies, given the [`arms`] before it.
pub fn swing(particles: &mut Particles, before: &[Vector]) {
    if before.is_empty() {
        return;
    }
    let now = arms(particles);
    change_rows(&mut particles.positions, |row, position| *position += now[row] - before[row]);
}

/// Stores the velocities of centres and the parts of the stress that belong to a solution with these constraint forces
/// on spheres, see [`store_centres`].
pub fn record(particles: &mut Particles, forces: &[Vector], gradient: Option<Tensor>) {
    store_centres(particles, gradient);
    store_moments(particles, forces);
}

/// Stores the velocities of the centres that belong to the present velocities. While particles move relative to a flow
/// with a `gradient`, these are relative to the flow at the centres.
pub fn store_centres(particles: &mut Particles, gradient: Option<Tensor>) {
    if !exist(particles) {
        return;
    }
    let arms = arms(particles);
    let (mut velocities, turning) = (copied(particles.vectors(VELOCITY)), copied(particles.vectors(ANGULAR_VELOCITY)));
    change_rows(&mut velocities, |row, velocity| {
        let in_flow = gradient.map_or(Vector::ZERO, |gradient| gradient * arms[row]);
        *velocity += in_flow - turning[row].cross(arms[row]);
    });
    overwrite(particles.vectors(columns::centre(VELOCITY)), &velocities);
}

/// Stores the contributions `-sym(s C)` of the constraint forces `C` on spheres at the arms `s` to the stress.
fn store_moments(particles: &mut Particles, forces: &[Vector]) {
    if !exist(particles) {
        return;
    }
    let arms = arms(particles);
    let force = |row: usize| forces.get(row).copied().unwrap_or_default();
    let moment = |row: usize| {
        let (arm, force) = (arms[row], force(row));
        let outer = Tensor::from_cols(force * arm.x, force * arm.y, force * arm.z);
        (outer + outer.transpose()) * -0.5
    };
    let moments: Vec<Tensor> = of_rows(arms.len(), moment);
    let column = particles.column(CONSTRAINT_MOMENT, CONSTRAINT_MOMENT_NUMBERS);
    overwrite(&mut column.values, bytemuck::cast_slice(&moments));
}

/// Sum of the xy components of the stored contributions of constraint forces to the stress; 0 without bodies.
pub fn shear_moment(particles: &Particles) -> f64 {
    let moments = particles.rows::<CONSTRAINT_MOMENT_NUMBERS>(CONSTRAINT_MOMENT).unwrap_or_default();
    moments.iter().map(|moment| moment[1]).sum()
}

/// Stores the constraint forces on spheres, and their torques about the centres of the bodies.
pub fn store_loads(particles: &mut Particles, constraint: &Loads) {
    let arms = arms(particles);
    let at = |list: &[Vector], row: usize| list.get(row).copied().unwrap_or_default();
    let load = |row: usize| {
        let force = at(&constraint.forces, row);
        [force, at(&constraint.torques, row) + arms[row].cross(force)]
    };
    let loads: Vec<[Vector; 2]> = of_rows(arms.len(), load);
    let column = particles.column(CONSTRAINT_LOAD, CONSTRAINT_LOAD_NUMBERS);
    overwrite(&mut column.values, bytemuck::cast_slice(&loads));
}

/// Adds a function of the position to the present velocities of centres.
pub fn add_at_centres(particles: &mut Particles, flow: impl Fn(Vector) -> Vector + Sync + Send) {
    if !exist(particles) {
        return;
    }
    let arms = arms(particles);
    let added = of_rows(arms.len(), |row| flow(particles.positions[row] - arms[row]));
    change(particles.vectors(columns::centre(VELOCITY)), &added, |velocity, &added| *velocity += added);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_bodies_nothing_is_stored() {
        let mut particles = Particles::default();
        particles.push(0, Vector::X, 1.0, 0);
        store_centres(&mut particles, None);
        add_at_centres(&mut particles, |_| Vector::X);
        let before = arms(&mut particles);
        swing(&mut particles, &before);
        assert!(particles.columns.is_empty() && before.is_empty() && numbers(&particles).is_empty());
        assert_eq!(centres(&particles, [VELOCITY]), None);
    }
}
