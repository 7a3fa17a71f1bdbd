//! Names of the particles' columns with results.

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

pub use hydrodynamics::brownian::BROWNIAN;
