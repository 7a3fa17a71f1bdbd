//! Steps as long as accuracy and near pairs allow.

use crate::dynamics::{Dynamics, Moment, Outcome};
use crate::integrator::{move_by, remember};
use crate::model::Adaptive;
use crate::orders::{Estimate, USED, Weights, of_displacements, weights};
use crate::relative_motion::RelativeMotion;
use crate::step_error::StepError;
use crate::substeps::{SHORTEST, ages, grow_older, grow_oldest, moved_apart, share};
use domain::{Particles, Vector};
use simulation::Clock;

/// Past velocities that are kept.
pub const PAST_VELOCITIES: usize = USED.len() - 1;

/// The highest order is taken where it makes differences of up to this part of what is allowed that it is not known to be better for.
const ROUGH: f64 = 0.05;

/// A substep may be this many times as long as the last one.
const GROWTH: f64 = 3.0;

/// A gap's error may be this part of what it may lose.
const GAP_ERROR: f64 = 0.01;

/// Takes one step of the clock in as many substeps as are needed, each by the Adams-Bashforth method of order 3 or 4 for
/// steps of any length,
///
/// ```text
/// x(t + h) = x(t) + integral from t to t + h of the polynomial through v(t), v(t - h1), v(t - h1 - h2), ...
/// ```
///
/// The method of order 2, with a line in place of the parabola of order 3, differs from that by the error that it makes; `h` is
/// such that this is at most `tolerance` radii for every sphere and a hundredth of `gap_fraction` of every gap, and that no
/// gap loses more than `gap_fraction` of itself. All this is known before anything moves: no substep is ever taken
/// back, and each takes one evaluation. The first substeps of a run have less of a past and are short for it.
///
/// Order 4 is taken unless some sphere or gap moves too roughly for it ([`Estimate`]), and where a motion is smooth its difference from
/// order 3 counts as an error likewise. The error of order 3 of a pair that turns is along the line of centres, and always of one sign, so
/// that pairs would part at smaller offsets than they came at; that of order 4 is across. A gap that decays at a rate `k` needs
/// `k h < 6/11` with order 3 and `k h < 3/10` with order 4, so that stiff ones have order 3.
///
/// With lubrication a force closes a gap `g` at a rate in proportion to the gap, `g' = -k g`: gaps shrink exponentially
/// and never close, and the limit on losses, `k h < gap_fraction`, is the same however small they are; it keeps the
/// method stable too. But the error by which a turning pair misses its gap does not shrink with it, and substeps that
/// kept it in proportion would become ever shorter while nothing changes faster. So there gaps below `tolerance` radii
/// count as so large as far as errors go. Spheres that would come nearer than the closest gap that lubrication knows,
/// by that error or since nothing resists more below it, are moved apart to that gap, within `tolerance` too.
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
        let comm = dynamics.partition().comm().clone();
        dynamics.remember(particles, 0);
        let ages = ages(particles, &comm);
        let rest = (1.0 - fraction) * clock.dt();
        let Chosen { step, weights, apart } =
            Substep { particles, ages: &ages, control, clock }.choose(rest, dynamics)?;
        let end = if step >= rest { 1.0 } else { fraction + step / clock.dt() };
        move_by(particles, USED, weights);
        particles.positions.iter_mut().zip(&apart).for_each(|(position, &apart)| *position += apart);
        remember(particles, PAST_VELOCITIES);
        let moment = Moment { clock: *clock, fraction: end, ages: ages.clone(), ahead: step, implicit: None };
        outcome = dynamics.evaluate(particles, &moment)?;
        grow_older(particles, &ages, step);
        grow_oldest(particles, &ages, step);
        fraction = end;
    }
    Ok(outcome)
}

/// A substep to be chosen.
struct Substep<'a> {
    particles: &'a mut Particles,
    ages: &'a [f64],
    control: &'a Adaptive,
    clock: &'a Clock,
}

/// How long a substep is, the weights of the velocities in [`USED`], and how spheres are moved apart in it; no displacements
/// stand for none.
struct Chosen {
    step: f64,
    weights: [f64; USED.len()],
    apart: Vec<Vector>,
}

/// What is known of a substep: its error and roughness and the largest part that a gap loses, each over what is allowed, and the smallest gap
/// before it.
struct Known {
    estimate: Estimate,
    loss: f64,
    gap: f64,
}

impl Substep<'_> {
    /// The longest substep that is allowed, one of equal shares of `rest`, so that the last one is not a small
    /// remainder.
    fn choose(mut self, rest: f64, dynamics: &Dynamics) -> Result<Chosen, StepError> {
        let mut approach = dynamics.approach(self.particles, USED);
        let mut longest = self.ages.get(1).map_or(rest, |last| rest.min(GROWTH * last));
        loop {
            let step = share(rest, longest);
            let orders = weights(self.ages, step);
            let Known { estimate: Estimate { error, roughness }, loss, gap } =
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

    /// That of a substep with the weights of all orders. Collective.
    fn known(
        &mut self,
        step: f64,
        orders: &Weights,
        approach: &mut RelativeMotion<{ USED.len() }>,
        dynamics: &Dynamics,
    ) -> Known {
        let comm = dynamics.partition().comm();
        let least = dynamics.lubrication().map_or([0.0; 2], |range| [range.closest(), self.control.tolerance]);
        let carry = dynamics.moving_box().carry(step, [0.0; 3]);
        let gaps = approach.carried_by(carry).after_orders(*orders, least, comm);
        let of_gaps = Estimate { error: gaps.error, roughness: gaps.roughness };
        let of_places = of_displacements(self.particles, orders, comm).scaled(1.0 / self.control.tolerance);
        let estimate = of_places.worse(of_gaps.scaled(1.0 / (GAP_ERROR * self.control.gap_fraction)));
        Known { estimate, loss: gaps.loss / self.control.gap_fraction, gap: gaps.gap }
    }
}
