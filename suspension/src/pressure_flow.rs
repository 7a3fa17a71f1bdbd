//! What particles remember of a flow whose flux is kept.

use domain::{Comm, Particles};

/// The column that says what curvature keeps the flux, the same for all particles.
pub const CURVATURE: &str = "curvature of the flow";

/// The flow by a pressure gradient, besides that of the fluid alone, which keeps the flux with the particles as they are: its curvature
/// `-u''` as it was found last.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PressureFlow {
    curvature: f64,
}

impl PressureFlow {
    /// As particles remember it, which are on the first rank, if they do. Collective.
    pub fn recalled(particles: &Particles, comm: &Comm) -> Self {
        let column = particles.columns.iter().find(|column| column.name == CURVATURE);
        let mut known: Vec<f64> = column.and_then(|column| column.values.first()).copied().into_iter().collect();
        comm.broadcast(&mut known);
        Self { curvature: known.first().copied().unwrap_or_default() }
    }

    /// Lets particles remember it.
    pub fn note(self, particles: &mut Particles) {
        particles.column(CURVATURE, 1).values.fill(self.curvature);
    }

    /// The curvature, one over time and length.
    pub fn curvature(self) -> f64 {
        self.curvature
    }

    /// Goes on with a curvature that was found.
    pub fn set_curvature(&mut self, curvature: f64) {
        self.curvature = curvature;
    }
}
