//! Steps whose length the stiffness of short-range forces does not limit.

use crate::columns::VELOCITY;
use crate::contacts;
use crate::dynamics::{Dynamics, Moment, Outcome};
use crate::extrapolation;
use crate::integrator::{EXPECTED, MEAN, PAST, PAST_OF_ANY_LENGTH, move_by, remember};
use crate::model::Adaptive;
use crate::relative_motion::RelativeMotion;
use crate::step_error::StepError;
use crate::substeps::{AHEAD, SHORTEST, ages, grow_older, largest_displacement, moved_apart, share};
use domain::{Comm, Particles, Vector};
use simulation::Clock;

/// Columns from which places at the end of a substep are expected.
const USED: [&str; 3] = [VELOCITY, PAST[0], MEAN];

/// A substep may be this many times as long as the last one: the method of two backward differences is stable up to
/// `1 + sqrt(2)`.
const GROWTH: f64 = 2.0;

/// Where it makes an error of the order 3 in its length, a substep is chosen for this part of what is allowed.
const SAFETY: f64 = 0.7;

/// A gap may be off what was expected by this part of it.
const GAP_ERROR: f64 = 0.1;

/// Errors more than this many times what is allowed are not put up with: the substep is taken again.
const REDONE: f64 = 4.0;

/// Takes one step of the clock in as many substeps as are needed, each by the method of two backward differences for
/// steps of any length: over a step `h`, `w` times as long as the last one,
///
/// ```text
/// x(t + h) = x(t) + h [b U(t + h) + (1 - b) W],        b = (1 + w) / (1 + 2 w)
/// ```
///
/// with `W` the mean velocity over the last step; the first one has `b = 1`. The velocities `U(t + h)` are those of the
/// suspension at places `x*` that velocities `U*` lead to, extrapolated from the last two steps. They are solved for
/// once, under short-range forces at `x(t + h)` by their linear change from `x*`,
///
/// ```text
/// F(x*) - b h K (U - U*)
/// ```
///
/// with `K` their stiffness along the lines of centres. So stiff pairs come to rest in one step, however long it is
/// (Hairer & Wanner 1996, V.1), and the error is of order 2 in the step.
///
/// A third of `b h (U - U*)` is about the error that a substep makes. The next one is such that this is `tolerance` radii
/// for no sphere, and gaps come out within a tenth of what was expected, where gaps below `tolerance` radii, or without
/// lubrication below the range of the repulsion, count as so large; and such that no gap is expected to lose more than
/// `gap_fraction` of itself. With a larger error the places found are expected in their turn and the velocities solved for
/// once more, so that a pair that meets the onset of a stiff force does not bounce off it; if that leaves four times the
/// error, a shorter substep is taken. Spheres that would come nearer than the
/// closest gap that lubrication knows are moved apart to that gap.
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
        (fraction, outcome) = Substep { particles, control, clock, fraction }.take(dynamics)?;
    }
    Ok(outcome)
}

/// A substep to be taken.
struct Substep<'a> {
    particles: &'a mut Particles,
    control: &'a Adaptive,
    clock: &'a Clock,
    /// How much of the clock's step is over.
    fraction: f64,
}

/// Ages of the past, and the length of a substep.
struct Length {
    ages: Vec<f64>,
    step: f64,
    /// Whether velocities change smoothly, so that errors can be known and limited.
    is_smooth: bool,
}

impl Length {
    /// `b`
    fn implicit(&self) -> f64 {
        let ratio = self.ages.get(1).map_or(0.0, |last| self.step / last);
        (1.0 + ratio) / (1.0 + 2.0 * ratio)
    }

    /// Weights of the last two velocities for that at the end; where they jump, the last one is expected to stay.
    fn extrapolation(&self) -> [f64; 2] {
        let times: Vec<f64> = self.ages.iter().take(1 + usize::from(self.is_smooth)).map(|age| -age).collect();
        std::array::from_fn(|k| if k < times.len() { extrapolation::weight(&times, k, self.step) } else { 0.0 })
    }

    /// Weights of the columns in [`USED`] for the displacement expected.
    fn expected(&self) -> [f64; 3] {
        let (b, [now, past]) = (self.implicit(), self.extrapolation());
        [b * now, b * past, 1.0 - b].map(|weight| weight * self.step)
    }

    /// Weights of the velocities solved for and of those expected for what displacements lack.
    fn correction(&self) -> [f64; 2] {
        [1.0, -1.0].map(|sign| sign * self.implicit() * self.step)
    }
}

impl Substep<'_> {
    /// Takes the longest substep that is allowed. How much of the clock's step is over then, and how the solve went.
    fn take(self, dynamics: &mut Dynamics) -> Result<(f64, Outcome), StepError> {
        let Self { particles, control, clock, fraction } = self;
        let comm = dynamics.partition().comm().clone();
        dynamics.remember(particles, 0);
        let (ages, rest) = (ages(particles, &comm), (1.0 - fraction) * clock.dt());
        let mut longest =
            proposed(particles, &ages, control, &comm).min(dynamics.moving_box().longest_substep()).min(rest);
        let before = (particles.clone(), dynamics.moving_box().clone());
        loop {
            let mut approach = dynamics.approach(particles, USED);
            let length = choose((&mut approach, &ages), (rest, longest), (control, clock), dynamics)?;
            let step = length.step;
            let end = if step >= rest { 1.0 } else { fraction + step / clock.dt() };
            let implicit = Some(length.implicit() * step);
            let moment = Moment { clock: *clock, fraction: end, ages: ages.clone(), ahead: step, implicit };
            expect(particles, &length, approach, dynamics);
            let mut outcome = dynamics.evaluate(particles, &moment)?;
            let mut error = correct(particles, &length, control, dynamics);
            if error > 1.0 && error.is_finite() {
                let found = particles.vectors(VELOCITY).to_vec();
                particles.vectors(EXPECTED).copy_from_slice(&found);
                outcome = dynamics.evaluate(particles, &moment)?;
                error = correct(particles, &length, control, dynamics);
            }
            let factor = (SAFETY / error.max(1e-9)).cbrt();
            if error <= REDONE {
                dynamics.place(particles, &moment)?;
                dynamics.end_flow(length.implicit());
                grow_older(particles, &ages, step);
                finish(particles, &length, step * factor.min(GROWTH));
                dynamics.settle(particles, step);
                return Ok((end, outcome));
            }
            (*particles, longest) = (before.0.clone(), step * if error.is_finite() { factor } else { 0.1 });
            dynamics.go_back(before.1.clone());
        }
    }
}

/// The length of a substep as far as errors go: of the first one, one that moves no sphere by more than the tolerance.
/// Collective.
fn proposed(particles: &mut Particles, ages: &[f64], control: &Adaptive, comm: &Comm) -> f64 {
    if ages.len() < 2 {
        return control.tolerance / largest_displacement(particles, ([VELOCITY], [1.0]), comm);
    }
    let mut known = [particles.column(AHEAD, 1).values.first().copied().unwrap_or_default()];
    comm.max(&mut known);
    known[0]
}

/// A share of `rest`, not longer than `longest`, in which gaps are expected not to lose more than they may. Collective.
fn choose(
    (approach, ages): (&mut RelativeMotion<3>, &[f64]),
    (rest, mut longest): (f64, f64),
    (control, clock): (&Adaptive, &Clock),
    dynamics: &Dynamics,
) -> Result<Length, StepError> {
    let comm = dynamics.partition().comm();
    loop {
        let is_smooth = control.tolerance.is_finite();
        let length = Length { ages: ages.to_vec(), step: share(rest, longest), is_smooth };
        let least = dynamics.least_gaps(control.tolerance);
        let sheared = approach.carried_by(dynamics.moving_box().carry(length.step, length.expected()));
        let change = sheared.after([length.expected(), [0.0; 3]], least, comm);
        if length.step < SHORTEST * clock.dt() {
            return Err(StepError::Collision { step: clock.step(), gap: dynamics.gap(change.gap) });
        }
        if change.loss <= control.gap_fraction {
            return Ok(length);
        }
        // A loss that is no number shortens it too, and comes to an end.
        longest = length.step * (0.9 * control.gap_fraction / change.loss).max(0.1);
    }
}

/// Moves the particles to where they are expected at the end of a substep. Collective.
fn expect(particles: &mut Particles, length: &Length, mut approach: RelativeMotion<3>, dynamics: &mut Dynamics) {
    let expected = combined(particles, [VELOCITY, PAST[0]], length.extrapolation());
    particles.vectors(EXPECTED).copy_from_slice(&expected);
    let sheared = approach.carried_by(dynamics.moving_box().carry(length.step, length.expected()));
    let apart = moved_apart(sheared, length.expected(), dynamics).unwrap_or_default();
    move_by(particles, USED, length.expected());
    displace(particles, &apart);
    remember(particles, PAST_OF_ANY_LENGTH);
    dynamics.expect_flow(length.extrapolation(), length.expected());
}

/// Moves the particles from where they were expected to where the velocities solved for lead, and says how large the error
/// is, over what is allowed: that of the substep, or by how much gaps are not those expected. Collective.
fn correct(particles: &mut Particles, length: &Length, control: &Adaptive, dynamics: &mut Dynamics) -> f64 {
    let missing = dynamics.correct_flow(length.correction()[0]);
    let (columns, weights, comm) = ([VELOCITY, EXPECTED], length.correction(), dynamics.partition().comm());
    let share = if length.ages.len() < 2 { 1.0 / 2.0 } else { 1.0 / 3.0 };
    let [now, past] = length.extrapolation().map(|weight| -weight * weights[0]);
    let difference = ([VELOCITY, PAST[0], PAST[1]], [weights[0], now, past]);
    let error = share * largest_displacement(particles, difference, comm) / control.tolerance;
    let mut approach = dynamics.approach(particles, columns);
    let sheared = approach.carried_by(dynamics.moving_box().deformation(missing));
    let change = sheared.after([weights, [0.0; 2]], dynamics.least_gaps(control.tolerance), comm);
    let Some(apart) = moved_apart(sheared, weights, dynamics) else { return f64::INFINITY };
    move_by(particles, columns, weights);
    displace(particles, &apart);
    error.max(change.error / GAP_ERROR)
}

/// Leaves behind what the next substep goes on from.
fn finish(particles: &mut Particles, length: &Length, next: f64) {
    let b = length.implicit();
    let mean = combined(particles, [VELOCITY, MEAN], [b, 1.0 - b]);
    particles.vectors(MEAN).copy_from_slice(&mean);
    particles.column(AHEAD, 1).values.fill(next);
    contacts::keep(particles);
    particles.columns.retain(|column| column.name != EXPECTED);
}

/// A weighted sum of columns of vectors.
fn combined(particles: &mut Particles, columns: [&str; 2], weights: [f64; 2]) -> Vec<Vector> {
    let [first, second] = columns.map(|name| particles.vectors(name).to_vec());
    first.iter().zip(second).map(|(&first, second)| first * weights[0] + second * weights[1]).collect()
}

fn displace(particles: &mut Particles, displacements: &[Vector]) {
    particles.positions.iter_mut().zip(displacements).for_each(|(position, &displacement)| *position += displacement);
}
