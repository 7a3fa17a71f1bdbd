//! State of the constant-flux constraint, stored with the particles for restarts.

use domain::{Comm, Particles};

/// Column of the curvature, equal for all particles.
pub const CURVATURE: &str = "curvature of the flow";

/// Change of the pressure-driven flow that keeps the flux in the presence of the particles: the curvature `-u''` of the
/// latest solution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstantFluxState {
    curvature: f64,
}

impl ConstantFluxState {
    /// Restores the state that the particles of the first rank store, if any. Collective.
    pub fn load_from_columns(particles: &Particles, comm: &Comm) -> Self {
        let column = particles.columns.iter().find(|column| column.name == CURVATURE);
        let mut known: Vec<f64> = column.and_then(|column| column.values.first()).copied().into_iter().collect();
        comm.broadcast(&mut known);
        Self { curvature: known.first().copied().unwrap_or_default() }
    }

    /// Stores the state in a column of the particles.
    pub fn store_in_columns(self, particles: &mut Particles) {
        particles.column(CURVATURE, 1).values.fill(self.curvature);
    }

    /// Curvature, one over time and length.
    pub fn curvature(self) -> f64 {
        self.curvature
    }

    /// Sets the curvature of a new solution.
    pub fn set_curvature(&mut self, curvature: f64) {
        self.curvature = curvature;
    }
}
