//! Steps as long as accuracy and near pairs allow.

use crate::columns::VELOCITY;
use crate::dynamics::{Dynamics, Moment, Outcome};
use crate::extrapolation::integral;
use crate::integrator::{PAST, PAST_OF_ANY_LENGTH, move_by, remember};
use crate::model::Adaptive;
use crate::step_error::StepError;
use crate::substeps::{SHORTEST, ages, grow_older, largest_displacement, moved_apart, share};
use domain::{Particles, Vector};
use simulation::Clock;

/// Velocities that a substep may use.
const USED: [&str; 3] = [VELOCITY, PAST[0], PAST[1]];

/// A substep may be this many times as long as the last one.
const GROWTH: f64 = 3.0;

/// A gap's error may be this part of what it may lose.
const GAP_ERROR: f64 = 0.01;

/// Takes one step of the clock in as many substeps as are needed, each by the Adams-Bashforth method of order 3 for
/// steps of any length,
///
/// ```text
/// x(t + h) = x(t) + integral from t to t + h of the parabola through v(t), v(t - h1), v(t - h1 - h2).
/// ```
///
/// The method of order 2, with a line in place of the parabola, differs from it by the error that it makes; `h` is such
/// that this is at most `tolerance` radii for every sphere and a hundredth of `gap_fraction` of every gap, and that no
/// gap loses more than `gap_fraction` of itself. All this is known before anything moves: no substep is ever taken
/// back, and each takes one evaluation. The first substeps of a run have less of a past and are short for it.
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
        dynamics.remember(particles);
        let ages = ages(particles, &comm);
        let rest = (1.0 - fraction) * clock.dt();
        let Chosen { step, apart } = Substep { particles, ages: &ages, control, clock }.choose(rest, dynamics)?;
        let end = if step >= rest { 1.0 } else { fraction + step / clock.dt() };
        move_by(particles, USED, weights(&ages, step));
        particles.positions.iter_mut().zip(&apart).for_each(|(position, &apart)| *position += apart);
        remember(particles, PAST_OF_ANY_LENGTH);
        let moment = Moment { clock: *clock, fraction: end, ages: ages.clone(), ahead: step, implicit: None };
        outcome = dynamics.evaluate(particles, &moment)?;
        grow_older(particles, &ages, step);
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

/// How long a substep is, and how spheres are moved apart in it; no displacements stand for none.
struct Chosen {
    step: f64,
    apart: Vec<Vector>,
}

impl Substep<'_> {
    /// The longest substep that is allowed, one of equal shares of `rest`, so that the last one is not a small
    /// remainder.
    fn choose(self, rest: f64, dynamics: &Dynamics) -> Result<Chosen, StepError> {
        let comm = dynamics.partition().comm();
        let mut approach = dynamics.approach(self.particles, USED);
        let mut longest = self.ages.get(1).map_or(rest, |last| rest.min(GROWTH * last));
        loop {
            let step = share(rest, longest);
            let both = [weights(self.ages, step), lower_weights(self.ages, step)];
            let least = dynamics.lubrication().map_or([0.0; 2], |range| [range.closest(), self.control.tolerance]);
            let gaps = approach.carried_by(dynamics.moving_box().carry(step, [0.0; 3])).after(both, least, comm);
            let difference = std::array::from_fn(|k| both[0][k] - both[1][k]);
            let error = largest_displacement(self.particles, (USED, difference), comm) / self.control.tolerance;
            let error = error.max(gaps.error / (GAP_ERROR * self.control.gap_fraction));
            let loss = gaps.loss / self.control.gap_fraction;
            if error <= 1.0
                && loss <= 1.0
                && let Some(apart) = moved_apart(&approach, both[0], dynamics)
            {
                return Ok(Chosen { step, apart });
            }
            if !error.is_finite() || step < SHORTEST * self.clock.dt() {
                return Err(StepError::Collision { step: self.clock.step(), gap: dynamics.gap(gaps.gap) });
            }
            let order = self.ages.len() as f64;
            longest = step * 0.9 * error.max(1e-9).powf(-1.0 / order).min(1.0 / loss.max(1e-9)).clamp(0.1, 1.0);
        }
    }
}

/// Weights of the velocities in [`USED`] for a substep.
fn weights(ages: &[f64], step: f64) -> [f64; 3] {
    let times: Vec<f64> = ages.iter().take(USED.len()).map(|age| -age).collect();
    let known = integral(&times, step);
    std::array::from_fn(|k| known.get(k).copied().unwrap_or_default())
}

/// Weights of one order less; of order 0 nothing moves.
fn lower_weights(ages: &[f64], step: f64) -> [f64; 3] {
    if ages.len() > 1 { weights(&ages[..ages.len() - 1], step) } else { [0.0; 3] }
}
