//! A stencil along one axis.

use crate::exponential::exponential;
use crate::shape::Sources;
use solver::Real;

/// The points of a stencil along one axis: their distances from the particle, and the Gaussians
/// `exp(-distance^2 / (2 width^2))` of the monopole and of the dipole.
#[derive(Default)]
pub(crate) struct Axis<T> {
    pub distances: Vec<f64>,
    /// The distances in the grid's precision.
    pub rounded: Vec<T>,
    pub gaussians: [Vec<f64>; 2],
    /// The Gaussians in the grid's precision.
    pub rounded_gaussians: [Vec<T>; 2],
}

impl<T: Real> Axis<T> {
    /// `count` points, `spacing` apart, from the distance `offset` on. Distances are `stretch` times as long for the
    /// Gaussians.
    #[inline(always)]
    pub fn fill(&mut self, count: usize, (offset, spacing): (f64, f64), sources: &Sources, stretch: f64) {
        self.distances.resize(count, 0.0);
        self.rounded.resize(count, T::default());
        for (point, (distance, rounded)) in self.distances.iter_mut().zip(&mut self.rounded).enumerate() {
            *distance = (point as f64).mul_add(spacing, offset);
            *rounded = T::from_f64(*distance);
        }
        let [monopole, dipole] = &mut self.gaussians;
        monopole.resize(count, 0.0);
        dipole.resize(count, 0.0);
        gaussians(&self.distances, stretch / sources.monopole.width, monopole);
        if sources.dipole.width.to_bits() == sources.monopole.width.to_bits() {
            dipole.copy_from_slice(monopole);
        } else {
            gaussians(&self.distances, stretch / sources.dipole.width, dipole);
        }
        for (exact, rounded) in self.gaussians.iter().zip(&mut self.rounded_gaussians) {
            rounded.resize(count, T::default());
            for (rounded, &exact) in rounded.iter_mut().zip(exact) {
                *rounded = T::from_f64(exact);
            }
        }
    }

    /// The Gaussians of one point.
    #[inline(always)]
    pub fn gaussian(&self, point: usize) -> [f64; 2] {
        [self.gaussians[0][point], self.gaussians[1][point]]
    }
}

/// A loop of its own, without branches, so that it is vectorised.
#[inline(always)]
fn gaussians(distances: &[f64], inverse_width: f64, values: &mut [f64]) {
    let factor = -0.5 * inverse_width * inverse_width;
    for (value, &distance) in values.iter_mut().zip(distances) {
        *value = exponential(factor * distance * distance);
    }
}
