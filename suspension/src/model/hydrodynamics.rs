//! Parameters of the hydrodynamic interactions.

use crate::model::box_axes::UserAxes;
use domain::{Number, ParameterError};
use fcm::{ComputeDevice, Method, Network};

/// Parameters of the hydrodynamic interactions; those that are `None` are chosen from the tolerance.
#[derive(Debug, Clone, PartialEq)]
pub struct Hydrodynamics {
    /// Order of the multipole expansion.
    pub multipoles: MultipoleOrder,
    /// Relative error that the user accepts.
    pub tolerance: f64,
    /// Method of the far field; `None` for the fastest.
    pub method: Option<Method>,
    /// Device that evaluates the far field.
    pub device: ComputeDevice,
    /// Grid points along x, y and z.
    pub grid: Option<[usize; 3]>,
    /// Width of a stencil in grid points.
    pub support: Option<usize>,
    /// Relative residual of the iterative solve for the stresslets.
    pub iteration_tolerance: Option<f64>,
    /// Measured costs of stencils, transforms and pair sums on the machine that the run is planned for, over those on
    /// the planner's reference machine.
    pub costs: Option<[f64; 3]>,
    /// Ranks and the network between them that the run is planned for; by default those of one machine.
    pub network: Option<Network>,
    /// Whether lubrication acts between near spheres.
    pub lubrication: bool,
    /// Gap at which lubrication ends, over the larger radius of a pair; by default
    /// [`lubrication::LubricationRange::WIDE`].
    pub lubrication_cutoff: Option<f64>,
    /// Whether the solve with lubrication is preconditioned.
    pub preconditioner: bool,
}

/// Order of the multipole expansion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultipoleOrder {
    /// Forces alone.
    Monopole,
    /// Forces, torques and the stresslets of rigid spheres.
    Dipole,
}

impl Default for Hydrodynamics {
    fn default() -> Self {
        Self {
            multipoles: MultipoleOrder::Dipole,
            tolerance: 1e-3,
            method: None,
            device: ComputeDevice::Cpu,
            grid: None,
            support: None,
            iteration_tolerance: None,
            costs: None,
            network: None,
            lubrication: false,
            lubrication_cutoff: None,
            preconditioner: true,
        }
    }
}

impl Hydrodynamics {
    pub(super) fn check(&self, axes: &UserAxes) -> Result<(), ParameterError> {
        let key = |name: &str| format!("hydrodynamics.{name}");
        ParameterError::require_between(&key("tolerance"), self.tolerance, [1e-12, 0.1])?;
        if let Some(tolerance) = self.iteration_tolerance {
            ParameterError::require_between(&key("iteration_tolerance"), tolerance, [1e-14, 0.1])?;
        }
        if let Some(support) = self.support.filter(|s| !(2..=64).contains(s)) {
            let message = format!("is {support}; a stencil covers 2 to 64 grid points");
            return Err(ParameterError::new(key("support"), message));
        }
        for (axis, points) in self.grid.map(|grid| axes.list(grid)).iter().flatten().enumerate() {
            check_points(*points).map_err(|message| ParameterError::new(key(&format!("grid[{axis}]")), message))?;
        }
        for (name, cost) in ["stencils", "transforms", "pairs"].iter().zip(self.costs.iter().flatten()) {
            ParameterError::require_between(&key(&format!("costs.{name}")), *cost, [0.01, 100.0])?;
        }
        self.network.as_ref().map_or(Ok(()), check_network)?;
        self.check_lubrication()
    }

    fn check_lubrication(&self) -> Result<(), ParameterError> {
        if self.lubrication && self.multipoles == MultipoleOrder::Monopole {
            let message = "is true, but hydrodynamics.multipoles is \"monopole\"; lubrication needs \"dipole\"";
            return Err(ParameterError::new("hydrodynamics.lubrication", message));
        }
        if !self.preconditioner && !self.lubrication {
            let message =
                "is false, but only a solve with lubrication has one; write lubrication = true or leave it out";
            return Err(ParameterError::new("hydrodynamics.preconditioner", message));
        }
        match self.lubrication_cutoff {
            Some(_) if !self.lubrication => {
                let message = "is set, but there is no lubrication; write lubrication = true or leave it out";
                Err(ParameterError::new("hydrodynamics.lubrication_cutoff", message))
            }
            Some(cutoff) if !(cutoff > 1e-3 && cutoff <= 8.0) => {
                let message = format!(
                    "is {}; the gap where lubrication ends needs 0.001 < cutoff <= 8, in radii of a pair's larger \
                     sphere",
                    Number(cutoff)
                );
                Err(ParameterError::new("hydrodynamics.lubrication_cutoff", message))
            }
            _ => Ok(()),
        }
    }
}

/// Largest numbers of ranks and of their threads that a run is planned for.
const MOST_RANKS: usize = 1 << 20;

fn check_network(network: &Network) -> Result<(), ParameterError> {
    let key = |name: &str| format!("hydrodynamics.network.{name}");
    for (name, count) in [("ranks", network.ranks), ("threads", network.threads)] {
        if !(1..=MOST_RANKS).contains(&count) {
            return Err(ParameterError::new(key(name), format!("is {count}; it needs to be 1 to {MOST_RANKS}")));
        }
    }
    ParameterError::require_between(&key("bandwidth"), network.bandwidth, [1e3, 1e15])?;
    ParameterError::require_between(&key("latency"), network.latency, [0.0, 1.0])?;
    Ok(())
}

/// Largest number of grid points along an axis.
const MOST_POINTS: usize = 1 << 20;

fn check_points(points: usize) -> Result<(), String> {
    if points > MOST_POINTS {
        return Err(format!("is {points}; the transform takes up to {MOST_POINTS} points along an axis"));
    }
    if points == 0 || !points.is_multiple_of(2) {
        return Err(format!("is {points}; the transform takes even numbers of points"));
    }
    Ok(())
}
