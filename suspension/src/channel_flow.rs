//! Flows that walls allow, and what spheres see of them.

use domain::{Boundaries, PeriodicBox, Traceless, Vector};
use fcm::Motion;
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
    /// A pressure gradient and lubrication.
    #[error("a pressure gradient and lubrication are not for one case; take a shear, or leave out one of the two")]
    Lubrication,
}

/// Refuses a linear flow that does not fit a box with walls across an axis of this name.
pub(crate) fn check_linear(cell: &PeriodicBox, flow: &BackgroundFlow, axis: char) -> Result<(), FlowRefused> {
    let mut rest = flow.gradient();
    (rest.z_axis.x, rest.z_axis.y) = (0.0, 0.0);
    let fits = cell.boundaries().walls() == 0 || rest.to_cols_array().iter().all(|&g| g == 0.0);
    if fits { Ok(()) } else { Err(FlowRefused::Linear(axis)) }
}

/// Refuses a pressure gradient that drives no flow between walls.
pub(crate) fn check_pressure(cell: &PeriodicBox, gradient: Vector, axis: char) -> Result<(), FlowRefused> {
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
/// relative to its velocity and half its vorticity at their centres: the velocity `a^2/6 u''` of Faxen's law, and the rate of
/// strain of the slope `u'`.
pub(crate) fn poiseuille(cell: &PeriodicBox, viscosity: f64, gradient: Vector, spheres: (&[Vector], &[f64])) -> Motion {
    let (positions, radii) = spheres;
    let bend = gradient / viscosity;
    let slope = |x: &Vector| -0.5 * bend * (cell.edges().z - 2.0 * x.z);
    let strain = |x: &Vector| Traceless([0.0, 0.0, 0.5 * slope(x).x, 0.0, 0.5 * slope(x).y]);
    Motion {
        velocities: radii.iter().map(|a| bend * (a * a / 6.0)).collect(),
        angular_velocities: vec![Vector::ZERO; radii.len()],
        strain_rates: positions.iter().map(strain).collect(),
    }
}
