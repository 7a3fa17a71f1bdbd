//! Names of the particles' columns.

use crate::scalars::{AGES, NEXT_SUBSTEP, OLDEST_AGE};
use domain::Particles;
use hydrodynamics::brownian::{DISPLACEMENT, DRIFT_ANGULAR_VELOCITY, DRIFT_VELOCITY};

/// Velocities.
pub const VELOCITY: &str = "velocity";

/// Stresslets; with lubrication, the total hydrodynamic stresslets.
pub const STRESSLET: &str = "stresslet";

/// Angular velocities.
pub const ANGULAR_VELOCITY: &str = "angular_velocity";

/// Contributions of the particles to the first moments of forces between spheres, as tensors, for samples that need
/// them; and the width of the column.
pub const PAIR_MOMENT: &str = "pair moment";
pub const PAIR_MOMENT_NUMBERS: usize = 9;

/// Stresslets of the far field in a coupled solve.
pub const STRESSLET_FAR: &str = "far stresslet";

/// Velocities of previous steps, the last one first.
pub const PAST: [&str; 3] = ["past velocity 1", "past velocity 2", "past velocity 3"];

/// Velocities of the stages of a Runge-Kutta step. These columns do not exist between steps.
pub const STAGES: [&str; 2] = ["stage velocity 2", "stage velocity 3"];

/// Mean velocity over the last substep, and velocity predicted for the end of the current one; the latter does not
/// exist between substeps.
pub const MEAN: &str = "mean velocity";
pub const EXPECTED: &str = "expected velocity";

/// All columns of velocities. They change with the frame of reference, for example when a particle leaves a sheared box
/// on one side and enters it on the other.
pub const VELOCITY_COLUMNS: [&str; 8] = [VELOCITY, PAST[0], PAST[1], PAST[2], STAGES[0], STAGES[1], MEAN, EXPECTED];

/// Column of a particle's bonds, in slots of three numbers: id of the other particle plus 1 (0 for an empty slot), rest
/// length, and index of the bond's kind in the model plus 1 (negative once it is broken).
pub const BONDS: &str = "bonds";
pub const BOND_NUMBERS: usize = 3;

/// Column of the ends of a particle's bonds that resist bending, in the slots of [`BONDS`]: the quaternions of the
/// beam's axes at the particle and at the other one, each in the axes of its sphere. It exists with such bonds alone.
pub const BEAM_ENDS: &str = "beam ends";
pub const BEAM_END_NUMBERS: usize = 8;

pub use hydrodynamics::brownian::BROWNIAN;

/// Orientations as quaternions `w, x, y, z` ([`domain::Quaternion`]), zeros for spheres of species without; and the
/// width of the column. It exists if some species has orientations.
pub const ORIENTATION: &str = "orientation";
pub const ORIENTATION_NUMBERS: usize = 4;

/// Vectors of the rotations since the start of a step or substep. This column does not exist between steps.
pub const ROTATION: &str = "rotation in the step";

/// Rotation vectors by the drawn motions of the fluid. This column does not exist between steps.
pub const RANDOM_ROTATION: &str = "random rotation";

/// Columns of velocities or displacements, and those of the angular velocities or rotations by which orientations
/// rotate in their place. Except for the first, they exist only with orientations.
const ANGULAR: [(&str, &str); 10] = [
    (VELOCITY, ANGULAR_VELOCITY),
    (PAST[0], "past angular velocity 1"),
    (PAST[1], "past angular velocity 2"),
    (PAST[2], "past angular velocity 3"),
    (STAGES[0], "stage angular velocity 2"),
    (STAGES[1], "stage angular velocity 3"),
    (MEAN, "mean angular velocity"),
    (EXPECTED, "expected angular velocity"),
    (DISPLACEMENT, RANDOM_ROTATION),
    (DRIFT_VELOCITY, DRIFT_ANGULAR_VELOCITY),
];

/// The column of angular velocities that belongs to one of velocities.
///
/// # Panics
///
/// If there is none, which is a mistake in the program.
pub fn angular(velocity: &str) -> &'static str {
    let found = ANGULAR.iter().find(|(name, _)| *name == velocity);
    found.map(|(_, angular)| *angular).expect("each column of velocities has one of angular velocities")
}

/// Number of the rigid body that a sphere belongs to, from 0, or -1 for none. It exists if there are bodies.
pub const BODY: &str = "body";

/// Position of a sphere in the axes of its body, from the centre. It exists if there are bodies.
pub const ARM: &str = "arm";

/// Contributions of the forces that keep bodies rigid to the stress, as tensors; and the width of the column. It exists
/// if there are bodies.
pub const CONSTRAINT_MOMENT: &str = "constraint moment";
pub const CONSTRAINT_MOMENT_NUMBERS: usize = 9;

/// Force of the constraint on a sphere and its torque about the centre of the body, whose sums over the spheres of a
/// body are the loads that its given motion takes; and the width of the column. It exists if motions are given.
pub const CONSTRAINT_LOAD: &str = "constraint load";
pub const CONSTRAINT_LOAD_NUMBERS: usize = 6;

/// Columns of velocities or displacements, and those of the centres of bodies. The latter exist only with bodies.
const CENTRES: [(&str, &str); 9] = [
    (VELOCITY, "centre velocity"),
    (PAST[0], "past centre velocity 1"),
    (PAST[1], "past centre velocity 2"),
    (PAST[2], "past centre velocity 3"),
    (STAGES[0], "stage centre velocity 2"),
    (STAGES[1], "stage centre velocity 3"),
    (MEAN, "mean centre velocity"),
    (EXPECTED, "expected centre velocity"),
    (DISPLACEMENT, "random displacement of the centre"),
];

/// The column of velocities of centres that belongs to one of velocities.
///
/// # Panics
///
/// If there is none, which is a mistake in the program.
pub fn centre(velocity: &str) -> &'static str {
    let found = CENTRES.iter().find(|(name, _)| *name == velocity);
    found.map(|(_, centre)| *centre).expect("each column of velocities has one of centres")
}

/// Whether a column has velocities, which change with the frame of reference.
pub fn are_velocities(name: &str) -> bool {
    let of_centres = || CENTRES.iter().find(|(_, centre)| *centre == name).map_or("", |(velocity, _)| *velocity);
    VELOCITY_COLUMNS.contains(&name) || VELOCITY_COLUMNS.contains(&of_centres())
}

/// Names of the columns that belong to bodies, and their widths.
pub fn of_bodies() -> impl Iterator<Item = (&'static str, usize)> {
    CENTRES.iter().map(|(_, name)| (*name, 3)).chain([
        (BODY, 1),
        (ARM, 3),
        (CONSTRAINT_MOMENT, CONSTRAINT_MOMENT_NUMBERS),
        (CONSTRAINT_LOAD, CONSTRAINT_LOAD_NUMBERS),
    ])
}

/// Whether a column has angular velocities of previous steps or substeps.
fn is_past_angular(name: &str) -> bool {
    ANGULAR.iter().skip(1).any(|(_, angular)| *angular == name)
}

/// Names of the columns that belong to orientations, and their widths.
pub fn of_orientations() -> impl Iterator<Item = (&'static str, usize)> {
    let angular = ANGULAR.iter().skip(1).map(|(_, name)| (*name, 3));
    angular.chain([(ORIENTATION, ORIENTATION_NUMBERS), (ROTATION, 3)])
}

/// Removes the history of the integrators: all velocities and angular velocities except the present ones, and the ages
/// of substeps.
pub fn clear_history(particles: &mut Particles) {
    let ages = [AGES, OLDEST_AGE, NEXT_SUBSTEP];
    let is_now = |name: &str| name == VELOCITY || name == centre(VELOCITY);
    let is_past = |name: &str| !is_now(name) && are_velocities(name) || is_past_angular(name);
    particles.remove(|name| is_past(name) || ages.contains(&name));
}
