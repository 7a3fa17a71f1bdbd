//! Adams-Bashforth methods of variable step length: weights, and selection of the order.

use crate::columns::PAST;
use crate::columns::VELOCITY;
use crate::evaluation::Dynamics;
use crate::evaluation::extrapolation::integral;
use crate::rotation;
use domain::parallel::MeasuredLoop;
use domain::{Comm, Particles, Vector};
use fcm::{DisplacementError, DisplacementOrders};
use rayon::prelude::*;

/// Columns of the velocities that a step may use.
pub const USED: [&str; 4] = [VELOCITY, PAST[0], PAST[1], PAST[2]];

/// Highest order that is stable for any step allowed by gaps and errors.
const STABLE: usize = 3;

/// Weights of the velocities in [`USED`] for four orders: one above the stable order, the stable order, and the two
/// below.
pub type Weights = [[f64; USED.len()]; 4];

/// Weights for a step, from the `ages` of the velocities: for the stable order, the one above it if there are enough
/// velocities, and the two below.
pub fn weights(ages: &[f64], step: f64) -> Weights {
    let stable = ages.len().min(STABLE);
    let orders = [ages.len().min(STABLE + 1), stable, stable - 1, stable.saturating_sub(2)];
    orders.map(|order| {
        let times: Vec<f64> = ages[..order].iter().map(|age| -age).collect();
        let known = integral(&times, step);
        std::array::from_fn(|k| known.get(k).copied().unwrap_or_default())
    })
}

/// Error estimate, from the dependence of a displacement, a gap, or the worst of many, on the order.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorEstimate {
    /// Error of a step.
    pub error: f64,
    /// Difference between the highest order and the next, if the motion is too rough for the highest; otherwise 0.
    pub roughness: f64,
}

impl ErrorEstimate {
    /// Ratios of differences between orders up to which a motion counts as smooth. For a motion that decays or
    /// oscillates at a rate `k`, with steps `h`, successive orders differ by `1/2 (exp(k h) - 1)`,
    /// `5/12 (exp(k h) - 1)^2` and `3/8 (exp(k h) - 1)^3` of the displacement in a step. These ratios of the last
    /// difference to the previous ones ensure that `k h` is below the stability limit `3/10` of the highest order.
    pub const SMOOTH: [f64; 2] = [0.25, 0.06];

    /// Estimate from the differences between successive orders, beginning with the highest.
    ///
    /// The error is the difference of the stable order from the next lower one. If the motion is smooth, it is at least
    /// a quarter of the next order's difference, since the former alone passes through zero at the closest approach of
    /// a rotating pair.
    pub fn of([highest, stable, lower]: [f64; 3]) -> Self {
        if highest <= (Self::SMOOTH[0] * stable).max(Self::SMOOTH[1] * lower) {
            Self { error: stable.max(0.25 * highest), roughness: 0.0 }
        } else {
            Self { error: stable, roughness: highest }
        }
    }

    /// The larger error and roughness of both; NaN counts as infinite.
    pub fn worse(self, other: Self) -> Self {
        let larger = |a: f64, b: f64| if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) };
        Self { error: larger(self.error, other.error), roughness: larger(self.roughness, other.roughness) }
    }

    /// Error and roughness times a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { error: self.error * factor, roughness: self.roughness * factor }
    }
}

/// Worst estimate of all displacements over the radius. Collective.
pub fn of_displacements(particles: &mut Particles, weights: &Weights, dynamics: &Dynamics) -> ErrorEstimate {
    let orders = DisplacementOrders::Four { weights, smooth: ErrorEstimate::SMOOTH };
    if let Some(DisplacementError { error, roughness }) = dynamics.held_error(particles, USED, &orders) {
        return ErrorEstimate { error, roughness };
    }
    of_displacements_here(particles, weights, dynamics.partition().comm())
}

/// [`of_displacements`] for particles that move here. Collective.
pub fn of_displacements_here(particles: &mut Particles, weights: &Weights, comm: &Comm) -> ErrorEstimate {
    for name in USED {
        particles.vectors(name);
    }
    let find = |name| particles.columns.iter().find(|column| column.name == name).expect("made above");
    let velocities: [&[Vector]; USED.len()] = USED.map(|name| bytemuck::cast_slice(&find(name).values));
    let between: [[f64; USED.len()]; 3] =
        std::array::from_fn(|order| std::array::from_fn(|k| weights[order][k] - weights[order + 1][k]));
    let of = |(i, radius): (usize, &f64)| {
        let length = |weights: [f64; USED.len()]| {
            (0..USED.len()).map(|k| velocities[k][i] * weights[k]).sum::<Vector>().length() / radius
        };
        ErrorEstimate::of(between.map(length))
    };
    let worst =
        particles.radii.par_iter().enumerate().map(of).measured().reduce(ErrorEstimate::default, ErrorEstimate::worse);
    let mut largest = [worst.error, worst.roughness];
    comm.max(&mut largest);
    ErrorEstimate { error: largest[0], roughness: largest[1] }
}

/// Worst estimate of the rotations of all spheres with orientations, in radians; none without. Collective.
pub fn of_rotations(particles: &mut Particles, weights: &Weights, comm: &Comm) -> ErrorEstimate {
    if !rotation::is_oriented(particles) {
        return ErrorEstimate::default();
    }
    let between = std::array::from_fn(|order| {
        let difference = std::array::from_fn(|k| weights[order][k] - weights[order + 1][k]);
        rotation::largest(particles, USED, difference, comm)
    });
    ErrorEstimate::of(between)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Estimate for a motion whose velocity was `past(k)` at `k` steps ago.
    fn estimate(past: impl Fn(f64) -> f64) -> ErrorEstimate {
        let weights = weights(&[0.0, 1.0, 2.0, 3.0], 1.0);
        let moved = weights.map(|weights| (0..4).map(|k| weights[k] * past(k as f64)).sum::<f64>());
        ErrorEstimate::of(std::array::from_fn(|order| (moved[order] - moved[order + 1]).abs()))
    }

    #[test]
    fn the_highest_order_suits_decay_for_which_it_is_stable() {
        for rate in [0.01, 0.1, 0.2] {
            assert!(estimate(|k| (rate * k).exp()).roughness <= 0.0, "rate {rate}");
        }
        for rate in [0.3_f64, 0.5, 2.0] {
            assert!(estimate(|k| (rate * k).exp()).roughness > 0.0, "rate {rate}");
        }
        assert!(estimate(|k| (-1.0_f64).powf(k)).roughness > 1.0);
    }

    #[test]
    fn the_error_does_not_vanish_with_the_difference_of_one_order() {
        // A cubic whose second difference is zero at the last three steps.
        let found = estimate(|k| 1.0 + k + 0.01 * k * (k - 1.0) * (k - 2.0));
        assert!(found.error > 0.005 && found.roughness <= 0.0, "{found:?}");
    }

    #[test]
    fn a_short_past_has_the_orders_that_it_can_have() {
        let bits = |weights: [f64; USED.len()]| weights.map(f64::to_bits);
        let [one, two, three] = [&[0.0][..], &[0.0, 0.1], &[0.0, 0.1, 0.2]].map(|ages| weights(ages, 0.1).map(bits));
        let (first, none) = (bits([0.1, 0.0, 0.0, 0.0]), bits([0.0; USED.len()]));
        assert_eq!(one, [first, first, none, none]);
        assert_eq!(two[..2], [two[0]; 2]);
        assert_eq!(two[2], first);
        assert_eq!(three[0], three[1]);
        assert_ne!(three[1], three[2]);
    }

    #[test]
    fn what_is_no_number_is_the_worst() {
        let worst = ErrorEstimate::default().worse(ErrorEstimate { error: f64::NAN, roughness: 0.0 });
        assert!(worst.error.is_infinite());
    }
}
