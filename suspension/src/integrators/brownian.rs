//! Time stepping of Brownian motion.

use crate::bodies;
use crate::columns::{PAST, VELOCITY};
use crate::error::step::StepError;
use crate::evaluation::fluctuating::Noise;
use crate::evaluation::fluctuating_bodies;
use crate::evaluation::{Dynamics, Outcome, StageTime};
use crate::integrators::motion;
use crate::model::BrownianScheme;
use domain::Particles;
use fcm::Stream;
use hydrodynamics::brownian::{self, CHANGE, DISPLACEMENT, DRIFT_VELOCITY, FiniteDifference};
use simulation::Clock;

/// Thermal fluctuations of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThermalNoise {
    /// The thermal energy `kT`.
    pub energy: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl ThermalNoise {
    /// Noise of the step that begins.
    fn of_step(&self, clock: &Clock) -> Noise {
        let stream = Stream::new(self.seed, clock.step());
        Noise { stream, amplitude: (2.0 * self.energy / clock.dt()).sqrt(), energy: self.energy }
    }
}

/// Parameters of a step with Brownian motion.
#[derive(Debug, Clone, Copy)]
pub struct BrownianStep {
    /// Source of the thermal fluctuations.
    pub noise_source: ThermalNoise,
    /// Time integrator.
    pub scheme: BrownianScheme,
    /// Whether the state after the step is recorded.
    pub is_seen: bool,
}

/// Size of the displacement for the finite difference of motions, over that in half a step.
const DIFFERENCE_FRACTION: f64 = 0.02;

/// Takes one step of the clock. Let `v, w, e` be random motions of the fluid at the particles at `x`, whose covariance
/// is `2 kT / dt` times the mobility of the method, and `f` random loads whose covariance is `2 kT / dt` times the
/// lubrication resistance. The midpoint scheme, with frozen noise, is
///
/// ```text
/// x* = x + dt/2 (v + u_inf)
/// x(t + dt) = x + dt U(x*)
/// ```
///
/// where `U` are the motions of rigid spheres in that fluid under all forces; the lubrication noise at `x*` uses the
/// same random numbers. The scheme with two evaluations of `U`, with the same `v, w, e, f` and forces, is
///
/// ```text
/// x* = x + a dt/2 v
/// x(t + dt) = x + dt (U(x) + [U(x*) - U(x)] / a),        a = 0.02
/// ```
///
/// The covariance of `U` is that of the mobility of rigid, lubricated spheres. The divergence of the method's own
/// mobility vanishes except near walls, so that the mean of `U` contains the drift `kT div M` of the constrained
/// mobility. `f` is independent of `v`, so its evaluation point does not affect the mean. Near walls `kT` times the
/// divergence of the method's mobility is added to the fluid velocity at `x*`, or `a` times that in the second scheme.
///
/// Two evaluations give the Brownian stress as well: the same difference of stresslets has the mean `-kT div D` of the
/// first moments `D` caused by forces, with a variance that does not grow as `dt` decreases. They also avoid pushing
/// near spheres into overlap before the solve. Orientations rotate in both schemes as positions move, by the drawn
/// rotations of the fluid to `x*` and by the angular velocities of rigid spheres after it, see
/// [`rotation`]. Both schemes are weakly of order 1 in `dt`. With two evaluations, the
/// velocities due to forces alone are evaluated after the step only if it `is_seen`, since later steps do not use them.
/// Collective; fails on every rank or on none.
pub fn advance(
    particles: &mut Particles,
    clock: &Clock,
    BrownianStep { noise_source, scheme, is_seen }: BrownianStep,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    dynamics.reorient(particles, clock);
    let noise = noise_source.of_step(clock);
    match scheme {
        BrownianScheme::Midpoint => midpoint(particles, clock, noise, dynamics),
        BrownianScheme::TwoEvaluations => {
            let outcome = two_evaluations(particles, clock, noise, dynamics)?;
            if is_seen {
                dynamics.remember(particles, 0);
                dynamics.evaluate(particles, &StageTime::in_step(clock, 1.0, 0))?;
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
    dynamics.draw_velocities(particles, noise);
    motion::advance(particles, [PAST[0]], [half]);
    let middle = StageTime::in_step(clock, 0.5, 0);
    add_divergence_of_bodies(particles, &middle, noise, dynamics)?;
    let outcome = dynamics.evaluate_fluctuating(particles, &middle, noise)?;
    motion::advance(particles, [VELOCITY, PAST[0]], [2.0 * half, -half]);
    motion::end(particles);
    dynamics.wrap_and_migrate(particles, &StageTime::in_step(clock, 1.0, 0))?;
    brownian::clear_history(particles);
    Ok(outcome)
}

/// Adds the divergence due to the rigidity of bodies to the drawn motions of the fluid, as a finite difference between
/// positions to which bodies are displaced both ways, see [`fluctuating_bodies`].
fn add_divergence_of_bodies(
    particles: &mut Particles,
    moment: &StageTime,
    noise: Noise,
    dynamics: &mut Dynamics,
) -> Result<(), StepError> {
    if !bodies::exist(particles) {
        return Ok(());
    }
    let step = dynamics.draw_displacements(particles, noise);
    for [displaced, sign] in [[0.5, 1.0], [-1.0, -1.0]] {
        motion::advance(particles, [DISPLACEMENT], [displaced]);
        dynamics.add_caused(particles, moment, sign * noise.energy / step)?;
    }
    motion::advance(particles, [DISPLACEMENT], [0.5]);
    fluctuating_bodies::clear_displacements(particles);
    Ok(())
}

fn two_evaluations(
    particles: &mut Particles,
    clock: &Clock,
    noise: Noise,
    dynamics: &mut Dynamics,
) -> Result<Outcome, StepError> {
    let start = StageTime::in_step(clock, 0.0, 0);
    dynamics.draw_motions(particles, noise, DIFFERENCE_FRACTION * 0.5 * clock.dt());
    let outcome = dynamics.move_at_random(particles, &start, noise)?;
    motion::advance(particles, [DISPLACEMENT], [1.0]);
    dynamics.wrap_and_migrate(particles, &start)?;
    let change = FiniteDifference { over: DIFFERENCE_FRACTION, energy: noise.energy, tolerance: CHANGE };
    dynamics.store_drift(particles, &start, change)?;
    dynamics.limit_drift(particles, clock.dt());
    motion::advance(particles, [DISPLACEMENT, PAST[0], DRIFT_VELOCITY], [-1.0, clock.dt(), clock.dt()]);
    motion::end(particles);
    brownian::clear_history(particles);
    dynamics.wrap_and_migrate(particles, &StageTime::in_step(clock, 1.0, 0))?;
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::prepared::Setup;
    use crate::model::{Bodies, BodyOrientation, Integrator, Model, Parameters, Species, Start};
    use domain::{BodyShape, Boundaries, Comm, EqualSpheres, PeriodicBox, Vector};
    use hydrodynamics::GivenMotion;

    fn pair(distance: f64) -> Model {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], 1e-4, 1);
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

    /// Relative velocity of two spheres under opposite unit forces along an axis, or velocity of one sphere under a
    /// unit force.
    fn separation_rate(model: &Model, axis: Vector) -> f64 {
        let (mut dynamics, mut particles) =
            Dynamics::new(model, Setup::start(model, None, &Comm::alone()).unwrap()).unwrap();
        let pull = move |places: &[Vector], _: f64| {
            let forces = if places.len() == 1 { vec![axis] } else { vec![-axis, axis] };
            Ok(simulation::AppliedLoads { forces, ..simulation::AppliedLoads::default() })
        };
        dynamics.forces_mut().applied.add(simulation::UserLoads::OfPositions(Box::new(pull)));
        dynamics.evaluate_now(&mut particles, &Clock::at(0, 1e-4)).unwrap();
        let velocities = particles.vectors(VELOCITY);
        if velocities.len() == 1 { velocities[0].dot(axis) } else { (velocities[1] - velocities[0]).dot(axis) }
    }

    type Step = fn(&mut Particles, &Clock, Noise, &mut Dynamics) -> Result<Outcome, StepError>;

    /// Mean Brownian drift velocity of a coordinate over pairs of steps with opposite noise, in which the noise itself
    /// cancels, and its standard error.
    fn drift(model: &Model, step: Step, count: u64, coordinate: fn(&Particles) -> f64) -> [f64; 2] {
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

    /// The mobility `m` of a pair under opposite unit forces, and its derivative, are found by solves. The mean drift
    /// of the separation is the radial part `kT dm/dr` plus `2 kT (m - m') / r` from the rotation, since the mobility
    /// `m'` across the line of centres differs.
    #[test]
    #[ignore = "heavy"]
    fn spheres_drift_to_where_they_move_more_easily() {
        let distance = 2.3;
        let along = |distance: f64| separation_rate(&pair(distance), Vector::X);
        let slope = (along(distance + 0.01) - along(distance - 0.01)) / 0.02;
        let turning = 2.0 * (along(distance) - separation_rate(&pair(distance), Vector::Y)) / distance;
        let expected = slope + turning;
        for (step, count, largest) in [(midpoint as Step, 1500, 0.1), (two_evaluations, 800, 0.14)] {
            let [mean, error] =
                drift(&pair(distance), step, count, |spheres| spheres.positions[1].x - spheres.positions[0].x);
            assert!(
                (mean - expected).abs() < 3.5 * error && error < largest * expected,
                "{mean} +- {error}, not {expected}"
            );
        }
    }

    /// A sphere drifts away from a wall as its mobility normal to the wall grows, by `kT dm/dz`. Most of the drift is
    /// not random but comes from the divergence of the mobility of the method.
    #[test]
    #[ignore = "heavy"]
    fn a_sphere_drifts_away_from_a_wall() {
        let above = |height: f64| {
            let cell =
                PeriodicBox::new(Vector::new(9.0, 8.0, 7.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], 1e-4, 1);
            let start = Start::Positions(vec![Vector::new(3.0, 4.0, height)]);
            let integrator = Integrator::Brownian(BrownianScheme::Midpoint);
            let mut parameters = Parameters { start, thermal_energy: Some(1.0), integrator, ..usual };
            parameters.hydrodynamics.lubrication = true;
            Model::new(parameters).unwrap()
        };
        for (height, mirrored) in [(1.3, 1.0), (5.7, -1.0)] {
            let expected = (separation_rate(&above(height + 0.01), Vector::Z)
                - separation_rate(&above(height - 0.01), Vector::Z))
                / 0.02;
            for (step, count) in [(midpoint as Step, 150), (two_evaluations, 100)] {
                let [mean, error] = drift(&above(height), step, count, |spheres| spheres.positions[0].z);
                assert!(
                    (mean - expected).abs() < 3.5 * error + 0.02 * expected.abs() && error < 0.1 * mean * mirrored,
                    "{mean} +- {error}, not {expected}"
                );
            }
        }
    }

    /// A doublet along a wall that may move normal to it alone, as its motion is given otherwise.
    fn doublet_above(height: f64) -> Model {
        let cell = PeriodicBox::new(Vector::new(9.0, 8.0, 7.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
        let shape = BodyShape::Rod(EqualSpheres { number: 2, radius: 1.0, gap: 0.0 }).spheres();
        let motion = GivenMotion { velocity: [Some(0.0), Some(0.0), None], angular_velocity: [Some(0.0); 3] };
        let bodies = Bodies {
            positions: Some(vec![Vector::new(3.0, 4.0, height)]),
            orientation: BodyOrientation::Aligned(Vector::new(1.0, 0.2, 0.0)),
            motion,
            ..Bodies::new("doublet", shape, 1)
        };
        let integrator = Integrator::Brownian(BrownianScheme::Midpoint);
        let mut parameters =
            Parameters { thermal_energy: Some(1.0), integrator, ..Parameters::new(cell, 1.0, Vec::new(), 1e-4, 1) };
        parameters.hydrodynamics.lubrication = true;
        Model::new(parameters.with_bodies(vec![bodies])).unwrap()
    }

    /// Velocity along z of the body under a unit force.
    fn rise(model: &Model) -> f64 {
        let (mut dynamics, mut particles) =
            Dynamics::new(model, Setup::start(model, None, &Comm::alone()).unwrap()).unwrap();
        let lift = |places: &[Vector], _: f64| {
            let forces = vec![0.5 * Vector::Z; places.len()];
            Ok(simulation::AppliedLoads { forces, ..simulation::AppliedLoads::default() })
        };
        dynamics.forces_mut().applied.add(simulation::UserLoads::OfPositions(Box::new(lift)));
        dynamics.evaluate_now(&mut particles, &Clock::at(0, 1e-4)).unwrap();
        particles.vectors(VELOCITY)[0].z
    }

    /// A body with one free component drifts by `kT dm/dz` of its mobility `m` along that component, and not at all
    /// along the others.
    #[test]
    #[ignore = "heavy"]
    fn a_driven_body_drifts_away_from_a_wall() {
        for (height, mirrored) in [(1.4, 1.0), (5.6, -1.0)] {
            let expected = (rise(&doublet_above(height + 0.01)) - rise(&doublet_above(height - 0.01))) / 0.02;
            let model = doublet_above(height);
            let [mean, error] = drift(&model, midpoint, 300, |spheres| spheres.positions[0].z);
            assert!(
                (mean - expected).abs() < 3.5 * error + 0.02 * expected.abs() && error < 0.12 * mean * mirrored,
                "{mean} +- {error}, not {expected}"
            );
            let [along, _] = drift(&model, midpoint, 3, |spheres| spheres.positions[0].x);
            assert!(along.abs() < 1e-8, "{along:e}");
        }
    }
}
