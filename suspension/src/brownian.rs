//! Steps of Brownian motion.

use crate::columns::VELOCITY;
use crate::dynamics::{Dynamics, Moment, Outcome};
use crate::integrator::{PAST, move_by};
use crate::model::BrownianScheme;
use crate::random_motion::{self, DISPLACEMENT, DRIFT_VELOCITY};
use crate::step_error::StepError;
use domain::Particles;
use fcm::Stream;
use simulation::Clock;

/// What heat does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heat {
    /// The thermal energy `kT`.
    pub energy: f64,
    /// Where random numbers start.
    pub seed: u64,
}

impl Heat {
    /// That of the step that begins.
    fn of_step(&self, clock: &Clock) -> Noise {
        let stream = Stream::new(self.seed, clock.step());
        Noise { stream, amplitude: (2.0 * self.energy / clock.dt()).sqrt(), energy: self.energy }
    }
}

/// What is random in a step.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// The random numbers.
    pub stream: Stream,
    /// The root of `2 kT / dt`, by which motions of the covariance of the mobility are those of the step.
    pub amplitude: f64,
    /// The thermal energy `kT`.
    pub energy: f64,
}

/// The part of half a step after which motions are looked at once more, for their change.
const PART: f64 = 0.02;

/// Takes one step of the clock. With `v, w, e` random motions of the fluid at the particles at `x`, whose covariance is
/// `2 kT / dt` times the mobility of the method, and `f` random loads whose covariance is `2 kT / dt` times the resistance of
/// lubrication, it is by the midpoint method with frozen noise
///
/// ```text
/// x* = x + dt/2 (v + u_inf)
/// x(t + dt) = x + dt U(x*)
/// ```
///
/// where `U` are the motions that rigid spheres have in that fluid under all forces, those of lubrication's noise by the same
/// random numbers at `x*`; or by two evaluations of `U`, with the same `v, w, e, f` and forces,
///
/// ```text
/// x* = x + a dt/2 v
/// x(t + dt) = x + dt (U(x) + [U(x*) - U(x)] / a),        a = 0.02
/// ```
///
/// The covariance of `U` is that of the mobility of rigid, lubricated spheres. The divergence of the method's own mobility
/// vanishes but near walls, so that the mean of `U` has the drift `kT div M` of the constrained one: `f` does not depend on `v`, and
/// it makes no difference to the mean where it is taken. Near walls the fluid at `x*` moves by `kT` times that divergence besides, or
/// `a` times that in the second. In the second, the same difference of stresslets has the mean `-kT div D` of
/// those of the first moments `D` that forces cause, with a variance that does not grow as `dt` falls; and near spheres are not
/// moved into each other before the solve. Both are of order 1 in `dt`, weakly. In the second, the motions by forces alone are
/// those of the particles after the step, but only where it is `seen`: nothing goes on from them. Collective; fails on every rank or on
/// none.
pub fn advance(
    particles: &mut Particles,
    (clock, is_seen): (&Clock, bool),
    (heat, scheme): (&Heat, BrownianScheme),
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let noise = heat.of_step(clock);
    match scheme {
        BrownianScheme::Midpoint => midpoint(particles, clock, noise, dynamics),
        BrownianScheme::TwoEvaluations => {
            let outcome = two_evaluations(particles, clock, noise, dynamics)?;
            if is_seen {
                dynamics.remember(particles, 0);
                dynamics.evaluate(particles, &Moment::in_step(clock, 1.0, 0))?;
            }
            Ok(outcome)
        }
    }
}

fn midpoint(
    particles: &mut Particles,
    clock: &Clock,
    noise: Noise,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let half = 0.5 * clock.dt();
    dynamics.fluctuate(particles, noise);
    dynamics.carry(particles);
    move_by(particles, [PAST[0]], [half]);
    let middle = Moment::in_step(clock, 0.5, 0);
    let outcome = dynamics.evaluate_fluctuating(particles, &middle, noise)?;
    move_by(particles, [VELOCITY, PAST[0]], [2.0 * half, -half]);
    dynamics.place(particles, &Moment::in_step(clock, 1.0, 0))?;
    random_motion::forget(particles);
    Ok(outcome)
}

fn two_evaluations(
    particles: &mut Particles,
    clock: &Clock,
    noise: Noise,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let start = Moment::in_step(clock, 0.0, 0);
    dynamics.fluctuate(particles, noise);
    random_motion::displace(particles, PART * 0.5 * clock.dt());
    let outcome = dynamics.move_at_random(particles, &start, noise)?;
    move_by(particles, [DISPLACEMENT], [1.0]);
    dynamics.place(particles, &start)?;
    dynamics.note_drift(particles, &start, (PART, noise.energy))?;
    random_motion::limit_drift(particles, clock.dt());
    move_by(particles, [DISPLACEMENT, PAST[0], DRIFT_VELOCITY], [-1.0, clock.dt(), clock.dt()]);
    random_motion::forget(particles);
    dynamics.place(particles, &Moment::in_step(clock, 1.0, 0))?;
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Integrator, Model, Parameters, Species, Start};
    use crate::setup::Setup;
    use domain::{Boundaries, Comm, PeriodicBox, Vector};

    fn pair(distance: f64) -> Model {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], (1e-4, 1));
        let start = Start::Positions(vec![Vector::splat(5.0), Vector::splat(5.0) + Vector::X * distance]);
        let mut parameters = Parameters {
            start,
            thermal_energy: Some(1.0),
            integrator: Integrator::Brownian(BrownianScheme::Midpoint),
            ..usual
        };
        parameters.hydrodynamics.lubrication = true;
        Model::new(parameters).unwrap()
    }

    /// The velocity at which unit forces along an axis part two spheres, or move one.
    fn parting(model: &Model, axis: Vector) -> f64 {
        let (mut dynamics, mut particles) =
            Dynamics::new(model, Setup::start(model, None, &Comm::alone()).unwrap()).unwrap();
        let pull = move |places: &[Vector], _: f64| {
            let forces = if places.len() == 1 { vec![axis] } else { vec![-axis, axis] };
            Ok(simulation::AppliedLoads { forces, ..simulation::AppliedLoads::default() })
        };
        dynamics.applied().add(simulation::OwnLoads::OfPositions(Box::new(pull)));
        dynamics.evaluate_now(&mut particles, &Clock::at(0, 1e-4)).unwrap();
        let velocities = particles.vectors(VELOCITY);
        if velocities.len() == 1 { velocities[0].dot(axis) } else { (velocities[1] - velocities[0]).dot(axis) }
    }

    type Step = fn(&mut Particles, &Clock, Noise, &mut Dynamics) -> Result<Outcome, StepError>;

    /// The mean velocity by heat of a coordinate over pairs of steps with opposite noise, from which the noise itself falls out, and
    /// its error.
    fn drift(model: &Model, (step, count): (Step, u64), coordinate: fn(&Particles) -> f64) -> [f64; 2] {
        let (mut dynamics, particles) =
            Dynamics::new(model, Setup::start(model, None, &Comm::alone()).unwrap()).unwrap();
        let clock = Clock::at(0, 1e-4);
        let amplitude = (2.0 / clock.dt()).sqrt();
        let of_draw = |draw: u64| {
            let stream = Stream::new(11, draw);
            let mut moved = 0.0;
            for sign in [1.0, -1.0] {
                let mut particles = particles.clone();
                let noise = Noise { stream, amplitude: sign * amplitude, energy: 1.0 };
                step(&mut particles, &clock, noise, &mut dynamics).unwrap();
                moved += 0.5 * coordinate(&particles);
            }
            (moved - coordinate(&particles)) / clock.dt()
        };
        let drifts: Vec<f64> = (0..count).map(of_draw).collect();
        let mean = drifts.iter().sum::<f64>() / count as f64;
        let variance = drifts.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count as f64 - 1.0);
        [mean, (variance / count as f64).sqrt()]
    }

    /// The velocity at which a pair parts under opposite unit forces, and its derivative with the distance are known by
    /// solving for them; the mean over steps is the drift `kT dm/dr` of the parting and, since there is more room across than along,
    /// `2 kT (m - m') / r` of the turning.
    #[test]
    fn spheres_drift_to_where_they_move_more_easily() {
        let distance = 2.3;
        let along = |distance: f64| parting(&pair(distance), Vector::X);
        let slope = (along(distance + 0.01) - along(distance - 0.01)) / 0.02;
        let turning = 2.0 * (along(distance) - parting(&pair(distance), Vector::Y)) / distance;
        let expected = slope + turning;
        for (step, count, largest) in [(midpoint as Step, 1500, 0.1), (two_evaluations, 800, 0.14)] {
            let [mean, error] =
                drift(&pair(distance), (step, count), |spheres| spheres.positions[1].x - spheres.positions[0].x);
            assert!(
                (mean - expected).abs() < 3.5 * error && error < largest * expected,
                "{mean} +- {error}, not {expected}"
            );
        }
    }

    /// A sphere drifts away from a wall as its mobility across it grows, by `kT dm/dz`: most of that is no more random than the
    /// divergence of its mobility by forces alone.
    #[test]
    fn a_sphere_drifts_away_from_a_wall() {
        let above = |height: f64| {
            let cell =
                PeriodicBox::new(Vector::new(9.0, 8.0, 7.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], (1e-4, 1));
            let start = Start::Positions(vec![Vector::new(3.0, 4.0, height)]);
            let integrator = Integrator::Brownian(BrownianScheme::Midpoint);
            let mut parameters = Parameters { start, thermal_energy: Some(1.0), integrator, ..usual };
            parameters.hydrodynamics.lubrication = true;
            Model::new(parameters).unwrap()
        };
        for (height, mirrored) in [(1.3, 1.0), (5.7, -1.0)] {
            let expected =
                (parting(&above(height + 0.01), Vector::Z) - parting(&above(height - 0.01), Vector::Z)) / 0.02;
            for (step, count) in [(midpoint as Step, 150), (two_evaluations, 100)] {
                let [mean, error] = drift(&above(height), (step, count), |spheres| spheres.positions[0].z);
                assert!(
                    (mean - expected).abs() < 3.5 * error + 0.02 * expected.abs() && error < 0.1 * mean * mirrored,
                    "{mean} +- {error}, not {expected}"
                );
            }
        }
    }
}
