//! How near pairs move relative to each other.

use super::moving_box::MovingBox;
use super::near::Near;
use domain::{Comm, Particles, Partition, Vector};

/// Pairs are watched up to this gap over the largest radius.
const WATCHED: f64 = 1.0;

/// The relative motion of near pairs, as `N` velocities of each: of now, and of the past.
pub struct Approach<const N: usize> {
    pairs: Vec<MovingPair<N>>,
}

struct MovingPair<const N: usize> {
    separation: Vector,
    velocities: [Vector; N],
    contact: f64,
}

impl<const N: usize> Approach<N> {
    /// The near pairs of particles whose columns of these names hold velocities. Collective.
    pub fn find(particles: &mut Particles, moving: &MovingBox, partition: &Partition, columns: [&str; N]) -> Self {
        let mut largest = [particles.radii.iter().copied().fold(0.0, f64::max)];
        partition.comm().max(&mut largest);
        let near = Near::find(particles, moving.cell(), partition, (2.0 + WATCHED) * largest[0]);
        let velocities = columns.map(|name| near.differences(particles.vectors(name)));
        let pair = |(k, (separation, radii, steps)): (usize, (Vector, [f64; 2], [i32; 3]))| {
            let image = moving.velocity_of_image(steps);
            let velocities = std::array::from_fn(|n| velocities[n][k] + image);
            MovingPair { separation, velocities, contact: radii[0] + radii[1] }
        };
        Self { pairs: near.pairs().enumerate().map(pair).collect() }
    }

    /// What the displacements `sum of weights[k] * velocity k` do to gaps, and how far they are from those with the weights `lower`.
    /// Collective.
    pub fn after(&self, weights: [f64; N], lower: [f64; N], comm: &Comm) -> Change {
        let mut change = Change { gap: f64::INFINITY, loss: 0.0, error: 0.0 };
        for pair in &self.pairs {
            let gap = pair.separation.length() - pair.contact;
            change.gap = change.gap.min(gap);
            if gap > 0.0 {
                let [after, other] = [weights, lower].map(|weights| pair.gap_after(weights));
                change.loss = change.loss.max((gap - after) / gap);
                change.error = change.error.max((after - other).abs() / gap);
            }
        }
        let mut least = [change.gap, -change.loss, -change.error];
        comm.min(&mut least);
        Change { gap: least[0], loss: -least[1], error: -least[2] }
    }
}

/// What happens to the gaps of pairs that do not overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The smallest gap before.
    pub gap: f64,
    /// The largest part that a gap loses.
    pub loss: f64,
    /// The largest error of a gap, over the gap.
    pub error: f64,
}

impl<const N: usize> MovingPair<N> {
    fn gap_after(&self, weights: [f64; N]) -> f64 {
        let moved: Vector = self.velocities.iter().zip(weights).map(|(&v, w)| v * w).sum();
        (self.separation + moved).length() - self.contact
    }
}
