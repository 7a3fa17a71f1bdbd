//! Steps of Brownian motion.

use crate::columns::VELOCITY;
use crate::dynamics::{Dynamics, Moment, Outcome};
use crate::integrator::{PAST, move_by};
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
    /// The random numbers of the step that begins, and the root of `2 kT / dt` by which motions of the covariance of the
    /// mobility are those of the step.
    fn of_step(&self, clock: &Clock) -> (Stream, f64) {
        (Stream::new(self.seed, clock.step()), (2.0 * self.energy / clock.dt()).sqrt())
    }
}

/// Takes one step of the clock by the midpoint method with frozen noise: with `v, w, e` random motions of the fluid at the
/// particles, whose covariance is `2 kT / dt` times the mobility of the method,
///
/// ```text
/// x* = x + dt/2 (v + u_inf)          v, w, e at x
/// x(t + dt) = x + dt U(x*)           the same v, w, e, and forces of lubrication's noise at x*
/// ```
///
/// where `U` are the motions that rigid spheres have in that fluid, under all forces at `x*`. The covariance of `U` is that of
/// the mobility of rigid, lubricated spheres. The divergence of the method's own mobility vanishes, so that the mean of `U` has
/// the drift `kT div M` of the constrained one. Of order 1 in `dt`, weakly. Collective; fails on every rank or on none.
pub fn advance(
    particles: &mut Particles,
    clock: &Clock,
    heat: &Heat,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let (stream, amplitude) = heat.of_step(clock);
    step(particles, clock, (amplitude, stream), dynamics)
}

fn step(
    particles: &mut Particles,
    clock: &Clock,
    noise: (f64, Stream),
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let half = 0.5 * clock.dt();
    dynamics.fluctuate(particles, noise);
    move_by(particles, [PAST[0]], [half]);
    let middle = Moment::in_step(clock, 0.5, 0);
    let outcome = dynamics.evaluate_fluctuating(particles, &middle, noise)?;
    move_by(particles, [VELOCITY, PAST[0]], [2.0 * half, -half]);
    dynamics.place(particles, &Moment::in_step(clock, 1.0, 0))?;
    Dynamics::calm(particles);
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Integrator, Model, Parameters, Species, Start};
    use crate::setup::Setup;
    use domain::{Comm, PeriodicBox, Vector};

    fn pair(distance: f64) -> Model {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], (1e-4, 1));
        let start = Start::Positions(vec![Vector::splat(5.0), Vector::splat(5.0) + Vector::X * distance]);
        let mut parameters = Parameters { start, thermal_energy: Some(1.0), integrator: Integrator::Brownian, ..usual };
        parameters.hydrodynamics.lubrication = true;
        Model::new(parameters).unwrap()
    }

    /// The velocity at which a pair parts under opposite unit forces, and its derivative with the distance are known by
    /// solving for them; the mean of pairs of steps with opposite noise, from which the noise itself falls out, is the drift
    /// `kT dm/dr` of the parting and, since there is more room across than along, `2 kT (m - m') / r` of the turning.
    #[test]
    fn spheres_drift_to_where_they_move_more_easily() {
        let distance = 2.3;
        let parting = |distance: f64, axis: Vector| {
            let model = pair(distance);
            let (mut dynamics, mut particles) =
                Dynamics::new(&model, Setup::start(&model, None, &Comm::alone()).unwrap()).unwrap();
            let pull = move |_: &[Vector], _: f64| {
                Ok(simulation::AppliedLoads { forces: vec![-axis, axis], torques: Vec::new() })
            };
            dynamics.applied().add(Box::new(pull));
            dynamics.evaluate_now(&mut particles, &Clock::at(0, 1e-4)).unwrap();
            let velocities = particles.vectors(VELOCITY);
            (velocities[1] - velocities[0]).dot(axis)
        };
        let slope = (parting(distance + 0.01, Vector::X) - parting(distance - 0.01, Vector::X)) / 0.02;
        let turning = 2.0 * (parting(distance, Vector::X) - parting(distance, Vector::Y)) / distance;
        let expected = slope + turning;
        let model = pair(distance);
        let (mut dynamics, particles) =
            Dynamics::new(&model, Setup::start(&model, None, &Comm::alone()).unwrap()).unwrap();
        let (clock, count) = (Clock::at(0, 1e-4), 1500);
        let amplitude = (2.0 / clock.dt()).sqrt();
        let drifts: Vec<f64> = (0..count)
            .map(|draw| {
                let stream = Stream::new(11, draw);
                let ends = [1.0, -1.0].map(|sign| {
                    let mut moved = particles.clone();
                    step(&mut moved, &clock, (sign * amplitude, stream), &mut dynamics).unwrap();
                    moved.positions[1].x - moved.positions[0].x
                });
                (0.5 * (ends[0] + ends[1]) - distance) / clock.dt()
            })
            .collect();
        let mean = drifts.iter().sum::<f64>() / count as f64;
        let variance = drifts.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count as f64 - 1.0);
        let error = (variance / count as f64).sqrt();
        assert!((mean - expected).abs() < 3.5 * error && error < 0.1 * expected, "{mean} +- {error}, not {expected}");
    }
}
