//! Flows that walls allow, and what spheres see of them.

use crate::ambient::StrainRate;
use domain::{Boundaries, PeriodicBox, Traceless, Vector};
use solver::BackgroundFlow;

/// A background flow that does not fit the walls of a box.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FlowRefused {
    /// A linear flow through a wall, or along it.
    #[error(
        "the background flow moves fluid through a wall or stretches one; with walls across {0} a velocity gradient can have \
         du/d{0} of velocities along the walls alone, a shear between walls that move"
    )]
    Linear(char),
    /// A pressure gradient where there are no two walls.
    #[error("a pressure gradient drives a flow between two walls; this box has {0}")]
    Pressure(usize),
    /// A pressure gradient across the walls.
    #[error("the pressure gradient has a component across the walls, along {0}; it drives no flow: leave it out")]
    Across(char),
}

/// Refuses a linear flow that does not fit a box with walls across an axis of this name.
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

/// What spheres between walls at `z = 0` and `z = H` see of the flow that a pressure gradient `p'` drives along them,
///
/// ```text
/// u(z) = -p' z (H - z) / (2 mu),
/// ```
///
/// its rate of strain and the second derivative `u''`, by which spheres move with `a^2/6 u''` besides (Faxen).
pub fn poiseuille(cell: &PeriodicBox, viscosity: f64, gradient: Vector) -> (StrainRate, Vector) {
    let (bend, height) = (gradient / viscosity, cell.edges().z);
    let slope = [0.5 * bend.x, 0.5 * bend.y];
    let [xz, yz] = slope.map(|slope| -0.5 * slope * height);
    (StrainRate { at_zero: Traceless([0.0, 0.0, xz, 0.0, yz]), slope }, bend)
}
