//! Columns of the particles that hold what was computed.

/// The column of velocities that a right-hand side fills in.
pub const VELOCITY: &str = "velocity";

/// The column of stresslets; with lubrication, of the whole hydrodynamic ones.
pub const STRESSLET: &str = "stresslet";

/// The column of angular velocities.
pub const ANGULAR_VELOCITY: &str = "angular_velocity";

/// The column of shares of the first moments of forces between spheres, as tensors, where a sample needs them, and its width.
pub const PAIR_MOMENT: &str = "pair moment";
pub const PAIR_MOMENT_NUMBERS: usize = 9;

pub use hydrodynamics::brownian::BROWNIAN;
