//! Names of the particles' columns.

use crate::scalars::{AGES, NEXT_SUBSTEP, OLDEST_AGE};
use domain::Particles;

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

pub use hydrodynamics::brownian::BROWNIAN;

/// Removes the history of the integrators: all velocities except the present ones, and the ages of substeps.
pub fn clear_history(particles: &mut Particles) {
    let ages = [AGES, OLDEST_AGE, NEXT_SUBSTEP];
    particles.remove(|name| name != VELOCITY && VELOCITY_COLUMNS.contains(&name) || ages.contains(&name));
}
