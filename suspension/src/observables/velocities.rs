//! Mean and variance of the velocities of each species.

use super::observable::{Observable, measure};
use crate::model::box_axes::UserAxes;
use crate::suspension::Suspension;
use domain::Vector;
use simulation::Quantity;

/// Mean velocity and velocity variance, relative to the background flow and component by component.
pub fn velocities(species: &[String], axes: UserAxes) -> [Box<dyn Observable>; 2] {
    let mean = Quantity::vectors("mean_velocity", "length/time", species);
    let variance = Quantity::vectors("velocity_variance", "length^2/time^2", species);
    [
        measure(mean, move |present| {
            present.velocities().means.iter().flat_map(|&mean| axes.vector(mean).to_array()).collect()
        }),
        measure(variance, move |present| {
            present.velocities().variances.iter().flat_map(|squares| axes.list(squares.to_array())).collect()
        }),
    ]
}

/// Moments of the velocities of each species, relative to the background flow.
pub struct VelocityMoments {
    means: Vec<Vector>,
    variances: Vec<Vector>,
}

impl VelocityMoments {
    /// The moments of a number of species. Collective.
    pub fn of(suspension: &Suspension, species: usize) -> Self {
        let velocities = suspension.velocities_in_flow();
        let kinds = &suspension.particles().species;
        let mean_of = |value: &dyn Fn(usize) -> Vector| {
            let mut sums = vec![0.0; 4 * species];
            for (i, &kind) in kinds.iter().enumerate() {
                let sum = &mut sums[4 * kind as usize..][..4];
                for (component, add) in sum.iter_mut().zip(value(i).to_array().into_iter().chain([1.0])) {
                    *component += add;
                }
            }
            suspension.comm().sum(&mut sums);
            sums.chunks_exact(4).map(|s| Vector::from_slice(s) / s[3]).collect::<Vec<_>>()
        };
        let means = mean_of(&|i| velocities[i]);
        let fluctuation = |i: usize| velocities[i] - means[kinds[i] as usize];
        let variances = mean_of(&|i| fluctuation(i) * fluctuation(i));
        Self { means, variances }
    }
}
