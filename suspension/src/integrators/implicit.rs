//! Time stepping with implicit short-range forces, whose stiffness does not limit the step.

use crate::columns;
use crate::columns::VELOCITY;
use crate::columns::{EXPECTED, MEAN, PAST};
use crate::error::step::StepError;
use crate::evaluation::approach::{Approach, Separated};
use crate::evaluation::extrapolation;
use crate::evaluation::{Dynamics, Outcome, StageTime};
use crate::forces::contacts;
use crate::forces::tethers::MovingBonds;
use crate::integrators::adams_bashforth::{PAST_OF_ANY_LENGTH, remember};
use crate::integrators::motion;
use crate::integrators::substeps::{SHORTEST, ages, grow_older, largest_displacement, moved_apart, share};
use crate::model::Adaptive;
use crate::rotation;
use crate::scalars::NEXT_SUBSTEP;
use domain::Particles;
use simulation::Clock;

/// Columns from which the positions at the end of a substep are predicted.
const USED: [&str; 3] = [VELOCITY, PAST[0], MEAN];

/// Largest ratio of a substep to the previous one; BDF2 is stable up to `1 + sqrt(2)`.
const GROWTH: f64 = 2.0;

/// Safety factor of the step control: a substep aims at this fraction of the allowed error, whose order is 3 in the
/// step.
const SAFETY: f64 = 0.7;

/// Relative deviation of a gap from its predicted value that is allowed.
const GAP_ERROR: f64 = 0.1;

/// Displacement of the ends of a bond relative to each other, over its length, and rotation of an end of one that
/// resists bending, by which the solution may deviate from the prediction about which the bond is linearised.
const BOND_ERROR: f64 = 0.1;

/// Largest predicted change of a bond's length, over that at rest. Longer bonds than 1.25 of it are explicit.
const BOND_CHANGE: f64 = 0.2;

/// Error, over the allowed one, above which a substep is repeated.
const REDONE: f64 = 4.0;

/// Takes one step of the clock in as many substeps as needed, each by the second-order backward differentiation formula
/// (BDF2) with variable steps: for a substep `h`, `w` times as long as the previous one,
///
/// ```text
/// x(t + h) = x(t) + h [b U(t + h) + (1 - b) W],        b = (1 + w) / (1 + 2 w)
/// ```
///
/// with `W` the mean velocity over the previous substep; the first substep has `b = 1`. The velocities `U(t + h)` are
/// those of the suspension at positions `x*` that result from velocities `U*`, extrapolated from the last two steps.
/// They are solved for once, with short-range forces at `x(t + h)` linearised about `x*`,
///
/// ```text
/// F(x*) - b h K (U - U*)
/// ```
///
/// with `K` their stiffness along the lines of centres. Stiff pairs thus relax in one step, however long it is (Hairer
/// & Wanner 1996, V.1), and the error is of order 2 in the step.
///
/// The error of a substep is estimated by `b h (U - U*) / 3`. The next substep is chosen such that it is at most
/// `tolerance` radii for every sphere, and that gaps agree with their predicted values within a tenth, where gaps below
/// `tolerance` radii, or without lubrication below the range of the repulsion, count as that large; and such that no
/// gap is predicted to lose more than `gap_fraction` of itself, and no bond to change its length by more than a fifth.
/// Ends of bonds agree with their predicted places within a tenth of the length. If the error is larger, the resulting
/// positions become the new prediction and the velocities are solved for once more, so that a pair that reaches the
/// onset of a stiff force does not bounce off it. If four times the allowed error remains, a shorter substep is taken.
/// Spheres that would come closer than the minimum gap of lubrication are moved apart to that gap.
///
/// Collective; fails on every rank or on none.
pub fn advance(
    particles: &mut Particles,
    clock: &Clock,
    control: &Adaptive,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    dynamics.reorient(particles, clock);
    let (mut fraction, mut outcome) = (0.0, Outcome::default());
    while fraction < 1.0 {
        (fraction, outcome) = Substep { particles, control, clock, fraction }.take(dynamics)?;
    }
    Ok(outcome)
}

/// A substep to be taken.
struct Substep<'a> {
    particles: &'a mut Particles,
    control: &'a Adaptive,
    clock: &'a Clock,
    /// Elapsed fraction of the clock's step.
    fraction: f64,
}

/// Ages of the past velocities, and length of a substep.
struct Length {
    ages: Vec<f64>,
    step: f64,
    /// Whether velocities vary smoothly, so that errors can be estimated and limited.
    is_smooth: bool,
}

impl Length {
    /// `b`
    fn implicit(&self) -> f64 {
        let ratio = self.ages.get(1).map_or(0.0, |last| self.step / last);
        (1.0 + ratio) / (1.0 + 2.0 * ratio)
    }

    /// Weights of the last two velocities in the extrapolated velocity at the end; if velocities may jump, the last one
    /// is kept.
    fn extrapolation(&self) -> [f64; 2] {
        let times: Vec<f64> = self.ages.iter().take(1 + usize::from(self.is_smooth)).map(|age| -age).collect();
        std::array::from_fn(|k| if k < times.len() { extrapolation::weight(&times, k, self.step) } else { 0.0 })
    }

    /// Weights of the columns in [`USED`] in the predicted displacement.
    fn expected(&self) -> [f64; 3] {
        let (b, [now, past]) = (self.implicit(), self.extrapolation());
        [b * now, b * past, 1.0 - b].map(|weight| weight * self.step)
    }

    /// Weights of the solved and of the predicted velocities in the correction of displacements.
    fn correction(&self) -> [f64; 2] {
        [1.0, -1.0].map(|sign| sign * self.implicit() * self.step)
    }
}

impl Substep<'_> {
    /// Takes the longest substep that is allowed. Returns the elapsed fraction of the clock's step and the statistics
    /// of the solve.
    fn take(self, dynamics: &mut Dynamics) -> Result<(f64, Outcome), StepError> {
        let Self { particles, control, clock, fraction } = self;
        dynamics.remember(particles, 0);
        let (ages, rest) = (ages(&particles.scalars), (1.0 - fraction) * clock.dt());
        let mut longest =
            proposed(particles, &ages, control, dynamics).min(dynamics.periodic_cell().longest_substep()).min(rest);
        let before = (particles.copied(), dynamics.periodic_cell().clone());
        loop {
            let mut approach = dynamics.approach(particles, USED);
            let bonds = dynamics.moving_bonds(particles, USED, control.tolerance).unwrap_or(MovingBonds::NONE);
            let bounds = LengthBounds { rest, longest, control, clock };
            let length = choose(&mut approach, &bonds, &ages, bounds, dynamics)?;
            let step = length.step;
            let end = if step >= rest { 1.0 } else { fraction + step / clock.dt() };
            let implicit = Some(length.implicit() * step);
            let moment =
                StageTime { clock: *clock, fraction: end, ages: ages.clone(), since_last_solution: step, implicit };
            predict(particles, &length, approach, dynamics);
            let mut outcome = dynamics.evaluate(particles, &moment)?;
            let mut error = correct(particles, &length, control, dynamics);
            if error > 1.0 && error.is_finite() {
                motion::copy(particles, VELOCITY, EXPECTED);
                outcome = dynamics.evaluate(particles, &moment)?;
                error = correct(particles, &length, control, dynamics);
            }
            let factor = (SAFETY / error.max(1e-9)).cbrt();
            if error <= REDONE {
                dynamics.wrap_and_migrate(particles, &moment)?;
                dynamics.end_flow(length.implicit());
                grow_older(&mut particles.scalars, &ages, step);
                finish(particles, &length, step * factor.min(GROWTH), dynamics);
                dynamics.adapt_stiffness(particles, step);
                return Ok((end, outcome));
            }
            (*particles, longest) = (before.0.copied(), step * if error.is_finite() { factor } else { 0.1 });
            dynamics.go_back(before.1.clone());
        }
    }
}

/// Length of a substep by its error; the first substep moves no sphere by more than the tolerance. Collective.
fn proposed(particles: &mut Particles, ages: &[f64], control: &Adaptive, dynamics: &Dynamics) -> f64 {
    if ages.len() < 2 {
        return control.tolerance / largest_displacement(particles, [VELOCITY], [1.0], dynamics);
    }
    particles.scalars.numbers(NEXT_SUBSTEP).map_or(0.0, |[next]| next)
}

/// Bounds of the length of a substep.
struct LengthBounds<'a> {
    /// Rest of the clock's step.
    rest: f64,
    /// Longest substep that the error allows.
    longest: f64,
    control: &'a Adaptive,
    clock: &'a Clock,
}

/// Length of a substep: `rest` divided evenly into parts not longer than `longest`, in which no gap is predicted to
/// lose more than allowed, and no bond to change more. Collective.
fn choose(
    approach: &mut Approach<3>,
    bonds: &MovingBonds<3>,
    ages: &[f64],
    LengthBounds { rest, mut longest, control, clock }: LengthBounds,
    dynamics: &Dynamics,
) -> Result<Length, StepError> {
    let comm = dynamics.partition().comm();
    loop {
        let is_smooth = control.tolerance.is_finite();
        let length = Length { ages: ages.to_vec(), step: share(rest, longest), is_smooth };
        let least = dynamics.least_gaps(control.tolerance);
        let sheared = approach.advected_by(dynamics.periodic_cell().advect(length.step, length.expected()));
        let change = sheared.after([length.expected(), [0.0; 3]], least, comm);
        if length.step < SHORTEST * clock.dt() {
            return Err(StepError::Collision { step: clock.step(), gap: dynamics.gap(change.gap) });
        }
        let stretch = bonds.stretch(length.expected(), comm);
        if change.loss <= control.gap_fraction && stretch <= BOND_CHANGE {
            return Ok(length);
        }
        // A NaN shortens the substep too, so the loop ends.
        let by_gaps = (0.9 * control.gap_fraction / change.loss).max(0.1);
        longest = length.step * by_gaps.min((0.9 * BOND_CHANGE / stretch).max(0.1));
    }
}

/// Moves the particles to their predicted positions at the end of a substep. Collective.
fn predict(particles: &mut Particles, length: &Length, mut approach: Approach<3>, dynamics: &mut Dynamics) {
    motion::combine(particles, [VELOCITY, PAST[0]], length.extrapolation(), EXPECTED, dynamics);
    let sheared = approach.advected_by(dynamics.periodic_cell().advect(length.step, length.expected()));
    let apart = moved_apart(sheared, length.expected(), dynamics).unwrap_or(Separated::Apart);
    motion::advance(particles, USED, length.expected());
    motion::move_apart(particles, apart);
    remember(particles, PAST_OF_ANY_LENGTH);
    dynamics.predict_flow(length.extrapolation(), length.expected());
}

/// Moves the particles from their predicted positions to those that result from the solved velocities. Returns the
/// error over the allowed one: the larger of the error of the substep and the deviation of gaps from their predicted
/// values. Collective.
fn correct(particles: &mut Particles, length: &Length, control: &Adaptive, dynamics: &mut Dynamics) -> f64 {
    let missing = dynamics.correct_flow(length.correction()[0]);
    let (columns, weights, comm) = ([VELOCITY, EXPECTED], length.correction(), dynamics.partition().comm().clone());
    let share = if length.ages.len() < 2 { 1.0 / 2.0 } else { 1.0 / 3.0 };
    let [now, past] = length.extrapolation().map(|weight| -weight * weights[0]);
    let (last, difference) = ([VELOCITY, PAST[0], PAST[1]], [weights[0], now, past]);
    let moved = largest_displacement(particles, last, difference, dynamics);
    let moved = moved.max(rotation::largest(particles, last, difference, &comm));
    let error = share * moved / control.tolerance;
    let mut approach = dynamics.approach(particles, columns);
    let sheared = approach.advected_by(dynamics.periodic_cell().deformation(missing));
    let change = sheared.after([weights, [0.0; 2]], dynamics.least_gaps(control.tolerance), &comm);
    let Some(apart) = moved_apart(sheared, weights, dynamics) else { return f64::INFINITY };
    let Some(bonds) = dynamics.moving_bonds(particles, columns, control.tolerance) else { return f64::INFINITY };
    let of_bonds = bonds.displacement(weights, &comm) / BOND_ERROR;
    motion::advance(particles, columns, weights);
    motion::move_apart(particles, apart);
    error.max(change.error / GAP_ERROR).max(of_bonds)
}

/// Stores the data from which the next substep starts.
fn finish(particles: &mut Particles, length: &Length, next: f64, dynamics: &Dynamics) {
    let b = length.implicit();
    motion::combine(particles, [VELOCITY, MEAN], [b, 1.0 - b], MEAN, dynamics);
    motion::end(particles);
    particles.scalars.set(NEXT_SUBSTEP, &[next]);
    contacts::keep(particles);
    let expected = [EXPECTED, columns::angular(EXPECTED), columns::centre(EXPECTED)];
    particles.columns.retain(|column| !expected.contains(&column.name.as_str()));
}
