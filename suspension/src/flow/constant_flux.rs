//! State of the constant-flux constraint, a scalar of the state for restarts.

use crate::scalars::CONSTANT_FLUX;
use domain::Scalars;

/// Change of the pressure-driven flow that keeps the flux in the presence of the particles: the curvature `-u''` of the
/// latest solution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ConstantFluxState {
    curvature: f64,
}

impl ConstantFluxState {
    /// Restores the state from scalars, if they have it.
    pub fn restored(scalars: &Scalars) -> Self {
        Self { curvature: scalars.numbers(CONSTANT_FLUX).map_or(0.0, |[curvature]| curvature) }
    }

    /// Stores the state.
    pub fn store(self, scalars: &mut Scalars) {
        scalars.set(CONSTANT_FLUX, &[self.curvature]);
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
