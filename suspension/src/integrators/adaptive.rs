//! Adaptive steps, as long as accuracy and near pairs allow.

use crate::error::step::StepError;
use crate::evaluation::approach::{Approach, Separated};
use crate::evaluation::orders::{ErrorEstimate, USED, Weights, of_displacements, of_rotations, weights};
use crate::evaluation::{Dynamics, Outcome, StageTime};
use crate::integrators::adams_bashforth::remember;
use crate::integrators::motion;
use crate::integrators::substeps::{SHORTEST, ages, grow_older, grow_oldest, moved_apart, share};
use crate::model::Adaptive;
use domain::Particles;
use simulation::Clock;

/// Number of past velocities that are stored.
pub const PAST_VELOCITIES: usize = USED.len() - 1;

/// The highest order is used if its roughness ([`ErrorEstimate::roughness`]) is at most this fraction of the allowed
/// error.
const ROUGH: f64 = 0.05;

/// Largest ratio of a substep to the previous one.
const GROWTH: f64 = 3.0;

/// Error allowed in a gap, over the loss allowed in it.
const GAP_ERROR: f64 = 0.01;

/// Takes one step of the clock in as many substeps as needed, each by the Adams-Bashforth method of order 3 or 4 with
/// variable step lengths,
///
/// ```text
/// x(t + h) = x(t) + integral from t to t + h of the polynomial through v(t), v(t - h1), v(t - h1 - h2), ...
/// ```
///
/// The error is estimated by the difference from the method of order 2, which has a line in place of the parabola of
/// order 3. `h` is chosen such that this is at most `tolerance` radii for every sphere, also for the surface of one
/// that rotates and has an orientation, and a hundredth of `gap_fraction` of every gap, and that no gap loses more than
/// `gap_fraction` of itself. All this is known before any sphere moves: no substep is rejected, and each takes one
/// evaluation. The first substeps of a run have a shorter past and are therefore short.
///
/// Order 4 is used unless the motion of some sphere or gap is too rough for it ([`ErrorEstimate`]); where a motion is
/// smooth, its difference from order 3 counts as an error, too. For a rotating pair the error of order 3 is along the
/// line of centres and always of one sign, so that pairs would separate at smaller offsets than those at which they
/// met; the error of order 4 is perpendicular. A gap that decays at a rate `k` requires `k h < 6/11` with order 3 and
/// `k h < 3/10` with order 4, so stiff gaps use order 3.
///
/// With lubrication, a force closes a gap `g` at a rate proportional to the gap, `g' = -k g`: gaps shrink exponentially
/// and never close, and the limit of the loss, `k h < gap_fraction`, does not depend on their size; it also keeps the
/// method stable. The error in the gap of a rotating pair, however, does not shrink with the gap, and an error bound
/// proportional to the gap would shorten the substeps indefinitely although nothing changes faster. So the error bound
/// of gaps below `tolerance` radii is that of a gap of `tolerance` radii. Spheres that would come closer than the
/// minimum gap of lubrication, by this error or because the resistance does not grow below it, are moved apart to that
/// gap, also within `tolerance`.
///
/// Collective; fails on every rank or on none.
pub fn advance(
    particles: &mut Particles,
    clock: &Clock,
    control: &Adaptive,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let (mut fraction, mut outcome) = (0.0, Outcome::default());
    while fraction < 1.0 {
        dynamics.remember(particles, 0);
        let ages = ages(&particles.scalars);
        let rest = (1.0 - fraction) * clock.dt();
        let Chosen { step, weights, apart } =
            AdaptiveSubstep { particles, ages: &ages, control, clock }.choose(rest, dynamics)?;
        let end = if step >= rest { 1.0 } else { fraction + step / clock.dt() };
        motion::advance(particles, USED, weights);
        motion::move_apart(particles, apart);
        let (known, times) = smooth(&ages);
        motion::end_smooth(particles, &USED[..known], &times[..known], step);
        remember(particles, PAST_VELOCITIES);
        if end >= 1.0 {
            dynamics.reorient(particles, clock);
        }
        let moment =
            StageTime { clock: *clock, fraction: end, ages: ages.clone(), since_last_solution: step, implicit: None };
        outcome = dynamics.evaluate(particles, &moment)?;
        grow_older(&mut particles.scalars, &ages, step);
        grow_oldest(&mut particles.scalars, &ages, step);
        fraction = end;
    }
    Ok(outcome)
}

/// Number of angular velocities in [`USED`] for the change of the angular velocity in a substep, and their times.
fn smooth(ages: &[f64]) -> (usize, [f64; 3]) {
    let times = std::array::from_fn(|k| ages.get(k).map_or(0.0, |age| -age));
    (ages.len().min(times.len()), times)
}

/// A substep whose length is to be chosen.
struct AdaptiveSubstep<'a> {
    particles: &'a mut Particles,
    ages: &'a [f64],
    control: &'a Adaptive,
    clock: &'a Clock,
}

/// Length of a substep, weights of the velocities in [`USED`], and displacements that separate spheres.
struct Chosen {
    step: f64,
    weights: [f64; USED.len()],
    apart: Separated,
}

/// Properties of a trial substep: its error and roughness and the largest loss of a gap, each over the allowed value,
/// and the smallest gap before it.
struct Known {
    estimate: ErrorEstimate,
    loss: f64,
    gap: f64,
}

impl AdaptiveSubstep<'_> {
    /// Chooses the longest substep that is allowed and divides `rest` evenly, so that no small remainder is left at the
    /// end.
    fn choose(mut self, rest: f64, dynamics: &mut Dynamics) -> Result<Chosen, StepError> {
        let mut approach = dynamics.approach(self.particles, USED);
        let mut longest = self.ages.get(1).map_or(rest, |last| rest.min(GROWTH * last));
        loop {
            let step = share(rest, longest);
            let orders = weights(self.ages, step);
            let Known { estimate: ErrorEstimate { error, roughness }, loss, gap } =
                self.known(step, &orders, &mut approach, dynamics);
            let weights = orders[usize::from(roughness > ROUGH)];
            if error <= 1.0
                && loss <= 1.0
                && let Some(apart) = moved_apart(&approach, weights, dynamics)
            {
                return Ok(Chosen { step, weights, apart });
            }
            if !error.is_finite() || step < SHORTEST * self.clock.dt() {
                return Err(StepError::Collision { step: self.clock.step(), gap: dynamics.gap(gap) });
            }
            let order = self.ages.len().min(USED.len() - 1) as f64;
            longest = step * 0.9 * error.max(1e-9).powf(-1.0 / order).min(1.0 / loss.max(1e-9)).clamp(0.1, 1.0);
        }
    }

    /// Properties of a substep from the weights of all orders. Collective.
    fn known(
        &mut self,
        step: f64,
        orders: &Weights,
        approach: &mut Approach<{ USED.len() }>,
        dynamics: &Dynamics,
    ) -> Known {
        let comm = dynamics.partition().comm();
        let least = dynamics.lubrication().map_or([0.0; 2], |range| [range.minimum_gap(), self.control.tolerance]);
        let carry = dynamics.periodic_cell().advect(step, [0.0; 3]);
        let gaps = approach.advected_by(carry).after_orders(*orders, least, comm);
        let of_gaps = ErrorEstimate { error: gaps.error, roughness: gaps.roughness };
        let of_places = of_displacements(self.particles, orders, dynamics).scaled(1.0 / self.control.tolerance);
        let of_rotations = of_rotations(self.particles, orders, comm).scaled(1.0 / self.control.tolerance);
        let estimate =
            of_places.worse(of_rotations).worse(of_gaps.scaled(1.0 / (GAP_ERROR * self.control.gap_fraction)));
        Known { estimate, loss: gaps.loss / self.control.gap_fraction, gap: gaps.gap }
    }
}
