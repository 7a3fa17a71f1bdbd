//! Background flows that are compatible with walls.

use crate::ambient::StrainRate;
use domain::{Boundaries, PeriodicBox, Traceless, Vector};
use solver::BackgroundFlow;

/// Error: a background flow that is incompatible with the walls of a box.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FlowRefused {
    /// A linear flow through a wall, or one that stretches a wall.
    #[error(
        "the background flow moves fluid through a wall or stretches one; with walls across {0} a velocity gradient \
         can have du/d{0} of velocities along the walls alone, a shear between walls that move"
    )]
    Linear(char),
    /// A pressure gradient in a box without two walls.
    #[error("a pressure gradient drives a flow between two walls; this box has {0}")]
    Pressure(usize),
    /// A pressure gradient across the walls.
    #[error("the pressure gradient has a component across the walls, along {0}; it drives no flow: leave it out")]
    Across(char),
}

/// Refuses a linear flow that is incompatible with the box; walls are across the user's axis of the given name.
pub fn check_linear(cell: &PeriodicBox, flow: &BackgroundFlow, axis: char) -> Result<(), FlowRefused> {
    let mut rest = flow.gradient();
    (rest.z_axis.x, rest.z_axis.y) = (0.0, 0.0);
    let fits = cell.boundaries().walls() == 0 || rest.to_cols_array().iter().all(|&g| g == 0.0);
    if fits { Ok(()) } else { Err(FlowRefused::Linear(axis)) }
}

/// Refuses a pressure gradient that drives no flow between walls.
pub fn check_pressure(cell: &PeriodicBox, gradient: Vector, axis: char) -> Result<(), FlowRefused> {
    match cell.boundaries() {
        _ if gradient == Vector::ZERO => Ok(()),
        Boundaries::Walls if gradient.z == 0.0 => Ok(()),
        Boundaries::Walls => Err(FlowRefused::Across(axis)),
        others => Err(FlowRefused::Pressure(others.walls())),
    }
}

/// Flow driven along walls at `z = 0` and `z = H` by a pressure gradient `p'`,
///
/// ```text
/// u(z) = -p' z (H - z) / (2 mu).
/// ```
///
/// Returns its strain rate and its second derivative `u''`, which adds `a^2/6 u''` to the velocity of a sphere (Faxen).
pub fn poiseuille(cell: &PeriodicBox, viscosity: f64, gradient: Vector) -> (StrainRate, Vector) {
    let (bend, height) = (gradient / viscosity, cell.edges().z);
    let slope = [0.5 * bend.x, 0.5 * bend.y];
    let [xz, yz] = slope.map(|slope| -0.5 * slope * height);
    (StrainRate { at_zero: Traceless([0.0, 0.0, xz, 0.0, yz]), slope }, bend)
}
