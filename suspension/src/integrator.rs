//! Positions advanced in time.

use crate::columns::VELOCITY;
use domain::{Particles, Vector};

/// Velocities of the steps before, the last one first.
pub const PAST: [&str; 3] = ["past velocity 1", "past velocity 2", "past velocity 3"];

/// Velocities of the stages within a Runge-Kutta step; there is no such column between steps.
const STAGES: [&str; 2] = ["stage velocity 2", "stage velocity 3"];

/// The mean velocity of the last substep, and that which is expected at the end of the one at hand; there is no such
/// column as the latter between substeps.
pub const MEAN: &str = "mean velocity";
pub const EXPECTED: &str = "expected velocity";

/// All columns that hold velocities: what has to change with a change of the frame of reference, as when a particle
/// leaves a sheared box on one side and enters it on the other.
pub const VELOCITY_COLUMNS: [&str; 8] = [VELOCITY, PAST[0], PAST[1], PAST[2], STAGES[0], STAGES[1], MEAN, EXPECTED];

/// Columns of velocities of the steps before that a method which can change its steps goes on from.
pub const PAST_OF_ANY_LENGTH: usize = 2;

/// The explicit Adams-Bashforth method of order `p`,
///
/// ```text
/// x_{n+1} = x_n + dt/2 (3 v_n - v_{n-1})                                       p = 2
/// x_{n+1} = x_n + dt/12 (23 v_n - 16 v_{n-1} + 5 v_{n-2})                      p = 3
/// x_{n+1} = x_n + dt/24 (55 v_n - 59 v_{n-1} + 37 v_{n-2} - 9 v_{n-3})         p = 4
/// ```
///
/// and, in the first steps, which have no past, the classical Runge-Kutta method of order 4.
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
    /// The method of an order, 2 to 4.
    ///
    /// # Panics
    ///
    /// If there is none of that order, which scenes are checked for.
    pub fn of_order(order: u8) -> Self {
        match order {
            2 => Self::Two,
            3 => Self::Three,
            4 => Self::Four,
            _ => panic!("no Adams-Bashforth method of order {order}"),
        }
    }

    /// Steps are stable for decay `x' = -rate x` up to this product of rate and step.
    pub fn stable(self) -> f64 {
        match self {
            Self::Two => 1.0,
            Self::Three => 6.0 / 11.0,
            Self::Four => 0.3,
        }
    }

    /// Steps before that it goes on from; so many first ones have none.
    fn past(self) -> usize {
        match self {
            Self::Two => 1,
            Self::Three => 2,
            Self::Four => 3,
        }
    }

    /// Columns of velocities at most.
    pub fn velocity_columns(self) -> usize {
        1 + self.past() + STAGES.len()
    }

    fn go(self, particles: &mut Particles, dt: f64) {
        match self {
            Self::Two => move_by(particles, [VELOCITY, PAST[0]], [3.0, -1.0].map(|w| w / 2.0 * dt)),
            Self::Three => move_by(particles, [VELOCITY, PAST[0], PAST[1]], [23.0, -16.0, 5.0].map(|w| w / 12.0 * dt)),
            Self::Four => {
                let weights = [55.0, -59.0, 37.0, -9.0].map(|w| w / 24.0 * dt);
                move_by(particles, [VELOCITY, PAST[0], PAST[1], PAST[2]], weights);
            }
        }
        remember(particles, self.past());
    }
}

/// Takes one step of a length, after so many others.
///
/// `evaluate` moves the particles to their home ranks and fills in the column [`VELOCITY`] for a fraction of the step;
/// it may change the order of the particles, wrap them, and shift all [`VELOCITY_COLUMNS`] by the same velocity. The
/// column must hold the velocities of now when this is called, and holds those of the step's end afterwards. Where
/// those of the steps before are missing, as after the particles were put elsewhere, they count as those of now.
pub fn advance<E>(
    particles: &mut Particles,
    (dt, steps): (f64, u64),
    method: AdamsBashforth,
    mut evaluate: impl FnMut(&mut Particles, f64) -> Result<(), E>,
) -> Result<(), E> {
    let is_known = particles.columns.iter().any(|column| column.name == PAST[0]);
    if steps > 0 && !is_known {
        (0..method.past()).for_each(|_| remember(particles, method.past()));
    }
    if steps < method.past() as u64 {
        runge_kutta(particles, dt, method.past(), &mut evaluate)?;
    } else {
        method.go(particles, dt);
    }
    evaluate(particles, 1.0)
}

fn runge_kutta<E>(
    particles: &mut Particles,
    dt: f64,
    past: usize,
    evaluate: &mut impl FnMut(&mut Particles, f64) -> Result<(), E>,
) -> Result<(), E> {
    remember(particles, past);
    let first = PAST[0];
    move_by(particles, [first], [0.5 * dt]);
    evaluate(particles, 0.5)?;
    copy(particles, VELOCITY, STAGES[0]);
    move_by(particles, [STAGES[0], first], [0.5 * dt, -0.5 * dt]);
    evaluate(particles, 0.5)?;
    copy(particles, VELOCITY, STAGES[1]);
    move_by(particles, [STAGES[1], STAGES[0]], [dt, -0.5 * dt]);
    evaluate(particles, 1.0)?;
    let weights = [1.0 / 6.0, 2.0 / 6.0, 2.0 / 6.0 - 1.0, 1.0 / 6.0].map(|w| w * dt);
    move_by(particles, [first, STAGES[0], STAGES[1], VELOCITY], weights);
    particles.columns.retain(|column| !STAGES.contains(&column.name.as_str()));
    Ok(())
}

/// Adds the sum of `weights[k] * column[k]` to the positions.
pub fn move_by<const N: usize>(particles: &mut Particles, columns: [&str; N], weights: [f64; N]) {
    for name in columns {
        particles.column(name, 3);
    }
    let find = |name| particles.columns.iter().find(|c| c.name == name).expect("made above");
    let columns: [&[Vector]; N] = columns.map(|name| bytemuck::cast_slice(&find(name).values));
    for (i, position) in particles.positions.iter_mut().enumerate() {
        *position += (0..N).map(|k| columns[k][i] * weights[k]).sum::<Vector>();
    }
}

/// Forgets all velocities but those of now.
pub fn forget(particles: &mut Particles) {
    particles.columns.retain(|column| column.name == VELOCITY || !VELOCITY_COLUMNS.contains(&column.name.as_str()));
}

/// Makes the velocities of now the last past ones, of which so many are kept.
pub fn remember(particles: &mut Particles, past: usize) {
    for k in (1..past).rev() {
        copy(particles, PAST[k - 1], PAST[k]);
    }
    copy(particles, VELOCITY, PAST[0]);
}

/// Copies a column of vectors into another.
fn copy(particles: &mut Particles, from: &str, to: &str) {
    let values = std::mem::take(&mut particles.column(from, 3).values);
    particles.column(to, 3).values.copy_from_slice(&values);
    particles.column(from, 3).values = values;
}

#[cfg(test)]
mod tests {
    use super::*;
    use simulation::Clock;

    /// A particle on a circle whose angular velocity changes in time: `x' = (1 + t) e_z x x`.
    fn circle(particles: &mut Particles, time: f64) {
        let velocities: Vec<Vector> = particles.positions.iter().map(|x| (1.0 + time) * Vector::Z.cross(*x)).collect();
        particles.vectors(VELOCITY).copy_from_slice(&velocities);
    }

    /// The distance from the exact place `t = 2` after a number of steps.
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
            advance(&mut particles, (clock.dt(), clock.step()), method, go).unwrap();
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

    /// What is left after 4,000 steps of a displacement that decays at rate 1.
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
            advance(&mut particles, (clock.dt(), clock.step()), method, decay).unwrap();
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
        // Three steps are all Runge-Kutta; over a fixed number of steps the error falls as dt^5.
        let error = |dt: f64| {
            let mut particles = Particles::default();
            particles.push(0, Vector::X, 1.0, 0);
            circle(&mut particles, 0.0);
            let mut clock = Clock::at(0, dt);
            for _ in 0..3 {
                let time = clock;
                advance(&mut particles, (clock.dt(), clock.step()), AdamsBashforth::Four, |p, f| {
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
        advance(&mut particles, (0.1, 0), AdamsBashforth::Four, |_, _| Ok::<(), ()>(())).unwrap();
        assert!(particles.columns.iter().all(|c| !STAGES.contains(&c.name.as_str())), "no stage outlives its step");
    }

    #[test]
    fn a_failed_evaluation_is_passed_on() {
        let mut particles = Particles::default();
        particles.push(0, Vector::X, 1.0, 0);
        circle(&mut particles, 0.0);
        let method = AdamsBashforth::Four;
        assert_eq!(advance(&mut particles, (0.1, 5), method, |_, _| Err("no")), Err("no"));
    }
}
