//! Time integration of positions and orientations.

use crate::columns;
use crate::columns::VELOCITY;
use crate::columns::{PAST, STAGES};
use crate::integrators::motion;
use domain::Particles;

/// Number of past velocities that implicit steps of variable length keep.
pub const PAST_OF_ANY_LENGTH: usize = 2;

/// The explicit Adams-Bashforth method of order `p`,
///
/// ```text
/// x_{n+1} = x_n + dt/2 (3 v_n - v_{n-1})                                       p = 2
/// x_{n+1} = x_n + dt/12 (23 v_n - 16 v_{n-1} + 5 v_{n-2})                      p = 3
/// x_{n+1} = x_n + dt/24 (55 v_n - 59 v_{n-1} + 37 v_{n-2} - 9 v_{n-3})         p = 4
/// ```
///
/// and, for the first steps, which lack the history, the classical Runge-Kutta method of order 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdamsBashforth {
    /// Order 2.
    Two,
    /// Order 3.
    Three,
    /// Order 4.
    Four,
}

impl AdamsBashforth {
    /// The method of an order from 2 to 4.
    ///
    /// # Panics
    ///
    /// For any other order; models are checked for that.
    pub fn of_order(order: u8) -> Self {
        match order {
            2 => Self::Two,
            3 => Self::Three,
            4 => Self::Four,
            _ => panic!("no Adams-Bashforth method of order {order}"),
        }
    }

    /// Stability limit: largest product of rate and step for the decay `x' = -rate x`.
    pub fn stable(self) -> f64 {
        match self {
            Self::Two => 1.0,
            Self::Three => 6.0 / 11.0,
            Self::Four => 0.3,
        }
    }

    /// Number of past velocities; as many first steps are taken by the Runge-Kutta method.
    fn past(self) -> usize {
        match self {
            Self::Two => 1,
            Self::Three => 2,
            Self::Four => 3,
        }
    }

    /// Largest number of columns of velocities.
    pub fn velocity_columns(self) -> usize {
        1 + self.past() + STAGES.len()
    }

    fn advance(self, particles: &mut Particles, dt: f64) {
        match self {
            Self::Two => motion::advance(particles, [VELOCITY, PAST[0]], [3.0, -1.0].map(|w| w / 2.0 * dt)),
            Self::Three => {
                motion::advance(particles, [VELOCITY, PAST[0], PAST[1]], [23.0, -16.0, 5.0].map(|w| w / 12.0 * dt));
            }
            Self::Four => {
                let weights = [55.0, -59.0, 37.0, -9.0].map(|w| w / 24.0 * dt);
                motion::advance(particles, [VELOCITY, PAST[0], PAST[1], PAST[2]], weights);
            }
        }
        let known = 1 + self.past();
        let (columns, times) = ([VELOCITY, PAST[0], PAST[1], PAST[2]], [0.0, -dt, -2.0 * dt, -3.0 * dt]);
        motion::end_smooth(particles, &columns[..known], &times[..known], dt);
        remember(particles, self.past());
    }
}

/// Moves the particles by one step of length `dt`, after `steps` previous steps; the caller then evaluates the
/// velocities at its end.
///
/// `evaluate` moves the particles to their home ranks and fills in the column [`VELOCITY`] for a fraction of the step;
/// it may change the order of the particles, wrap them, and shift all [`VELOCITY_COLUMNS`] by the same velocity. The
/// column must hold the present velocities when this is called. If velocities of previous steps are missing, for
/// example after a change of positions, the present ones are used in their place.
pub fn advance<E>(
    particles: &mut Particles,
    dt: f64,
    steps: u64,
    method: AdamsBashforth,
    evaluate: &mut impl FnMut(&mut Particles, f64) -> Result<(), E>,
) -> Result<(), E> {
    let is_known = particles.columns.iter().any(|column| column.name == PAST[0]);
    if steps > 0 && !is_known {
        (0..method.past()).for_each(|_| remember(particles, method.past()));
    }
    if steps < method.past() as u64 {
        return runge_kutta(particles, dt, method.past(), evaluate);
    }
    method.advance(particles, dt);
    Ok(())
}

fn runge_kutta<E>(
    particles: &mut Particles,
    dt: f64,
    past: usize,
    evaluate: &mut impl FnMut(&mut Particles, f64) -> Result<(), E>,
) -> Result<(), E> {
    remember(particles, past);
    let first = PAST[0];
    motion::advance(particles, [first], [0.5 * dt]);
    evaluate(particles, 0.5)?;
    motion::copy(particles, VELOCITY, STAGES[0]);
    motion::advance(particles, [STAGES[0], first], [0.5 * dt, -0.5 * dt]);
    evaluate(particles, 0.5)?;
    motion::copy(particles, VELOCITY, STAGES[1]);
    motion::advance(particles, [STAGES[1], STAGES[0]], [dt, -0.5 * dt]);
    evaluate(particles, 1.0)?;
    let weights = [1.0 / 6.0, 2.0 / 6.0, 2.0 / 6.0 - 1.0, 1.0 / 6.0].map(|w| w * dt);
    motion::advance(particles, [first, STAGES[0], STAGES[1], VELOCITY], weights);
    motion::end_smooth(particles, &[first, VELOCITY], &[0.0, dt], dt);
    let stages = STAGES.map(|name| [name, columns::angular(name), columns::centre(name)]);
    particles.columns.retain(|column| !stages.as_flattened().contains(&column.name.as_str()));
    Ok(())
}

/// Makes the present velocities the latest past ones and keeps `past` of them.
pub fn remember(particles: &mut Particles, past: usize) {
    for k in (1..past).rev() {
        motion::exchange(particles, PAST[k - 1], PAST[k]);
    }
    motion::copy(particles, VELOCITY, PAST[0]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Vector;
    use simulation::Clock;

    /// Takes a step with the evaluation at its end.
    fn take<E>(
        particles: &mut Particles,
        clock: &Clock,
        method: AdamsBashforth,
        mut evaluate: impl FnMut(&mut Particles, f64) -> Result<(), E>,
    ) -> Result<(), E> {
        advance(particles, clock.dt(), clock.step(), method, &mut evaluate)?;
        evaluate(particles, 1.0)
    }

    /// A particle on a circle whose angular velocity changes in time: `x' = (1 + t) e_z x x`.
    fn circle(particles: &mut Particles, time: f64) {
        let velocities: Vec<Vector> = particles.positions.iter().map(|x| (1.0 + time) * Vector::Z.cross(*x)).collect();
        particles.vectors(VELOCITY).copy_from_slice(&velocities);
    }

    /// Distance from the exact position at `t = 2` after a number of steps.
    fn error(method: AdamsBashforth, steps: u64) -> f64 {
        let mut particles = Particles::default();
        particles.push(0, Vector::X, 1.0, 0);
        circle(&mut particles, 0.0);
        let mut clock = Clock::at(0, 2.0 / steps as f64);
        for _ in 0..steps {
            let go = |particles: &mut Particles, fraction| {
                circle(particles, clock.time_at(fraction));
                Ok::<(), ()>(())
            };
            take(&mut particles, &clock, method, go).unwrap();
            clock.tick();
        }
        let angle = 2.0_f64 + 2.0;
        (particles.positions[0] - Vector::new(angle.cos(), angle.sin(), 0.0)).length()
    }

    #[test]
    fn errors_fall_with_the_order_of_the_method() {
        for expected in [2, 3, 4] {
            let method = AdamsBashforth::of_order(expected);
            for steps in [100, 200, 400] {
                let order = (error(method, steps) / error(method, 2 * steps)).log2();
                assert!((order - f64::from(expected)).abs() < 0.15, "order {order} of {method:?} from {steps} steps");
            }
        }
    }

    /// Magnitude after 4,000 steps of a displacement that decays at rate 1.
    fn left_of_decay(method: AdamsBashforth, dt: f64) -> f64 {
        let decay = |particles: &mut Particles, _: f64| {
            let velocities: Vec<Vector> = particles.positions.iter().map(|&x| -x).collect();
            particles.vectors(VELOCITY).copy_from_slice(&velocities);
            Ok::<(), ()>(())
        };
        let mut particles = Particles::default();
        particles.push(0, Vector::X, 1.0, 0);
        decay(&mut particles, 0.0).unwrap();
        let mut clock = Clock::at(0, dt);
        for _ in 0..4000 {
            take(&mut particles, &clock, method, decay).unwrap();
            clock.tick();
        }
        particles.positions[0].length()
    }

    #[test]
    fn decay_is_stable_up_to_the_limit_of_each_method() {
        for method in [AdamsBashforth::Two, AdamsBashforth::Three, AdamsBashforth::Four] {
            let (within, beyond) = (0.99 * method.stable(), 1.01 * method.stable());
            assert!(left_of_decay(method, within) < 1e-6, "{method:?} is unstable at {within}");
            assert!(left_of_decay(method, beyond) > 1e6, "{method:?} is stable at {beyond}");
        }
    }

    #[test]
    fn the_start_is_of_order_four_too() {
        // All three steps are Runge-Kutta steps; over a fixed number of steps the error scales as dt^5.
        let error = |dt: f64| {
            let mut particles = Particles::default();
            particles.push(0, Vector::X, 1.0, 0);
            circle(&mut particles, 0.0);
            let mut clock = Clock::at(0, dt);
            for _ in 0..3 {
                let time = clock;
                take(&mut particles, &clock, AdamsBashforth::Four, |p, f| {
                    circle(p, time.time_at(f));
                    Ok::<(), ()>(())
                })
                .unwrap();
                clock.tick();
            }
            let angle = 3.0 * dt + 4.5 * dt * dt;
            (particles.positions[0] - Vector::new(angle.cos(), angle.sin(), 0.0)).length()
        };
        let order = (error(0.02) / error(0.01)).log2();
        assert!((order - 5.0).abs() < 0.2, "order {order}");
        let mut particles = Particles::default();
        particles.push(0, Vector::X, 1.0, 0);
        circle(&mut particles, 0.0);
        take(&mut particles, &Clock::at(0, 0.1), AdamsBashforth::Four, |_, _| Ok::<(), ()>(())).unwrap();
        assert!(particles.columns.iter().all(|c| !STAGES.contains(&c.name.as_str())), "no stage outlives its step");
    }

    #[test]
    fn a_failed_evaluation_is_passed_on() {
        let mut particles = Particles::default();
        particles.push(0, Vector::X, 1.0, 0);
        circle(&mut particles, 0.0);
        let method = AdamsBashforth::Four;
        assert_eq!(take(&mut particles, &Clock::at(5, 0.1), method, |_, _| Err("no")), Err("no"));
    }
}
