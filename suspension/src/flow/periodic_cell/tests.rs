use super::*;
use crate::columns::VELOCITY;
use crate::integrators::adams_bashforth::{AdamsBashforth, advance};
use crate::model::Protocol;

fn at_rate(step: u64, start: PeriodicBox, rate: f64) -> PeriodicCell {
    PeriodicCell::at(&Clock::at(step, 0.1), start, ShearRates::new(rate, Protocol::STEADY, 0.1), true)
}

/// The unwrapped position of a particle that drifts in the flow is known, `x0 + rate y0 t + drift t`, and the
/// integrator is exact for it, whatever images the particle passes through and however often the lattice is reset.
#[test]
fn a_passing_particle_moves_on_a_straight_line() {
    let (rate, drift) = (0.7, Vector::new(0.1, 0.9, -0.4));
    let gradient = BackgroundFlow::shear(rate).gradient();
    let start = PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap();
    let mut moving = at_rate(0, start, rate);
    let mut particles = Particles::default();
    let from = Vector::new(1.0, 1.5, 0.2);
    particles.push(0, from, 0.1, 0);
    let flow = |particles: &mut Particles| {
        let velocities: Vec<Vector> = particles.positions.iter().map(|x| gradient * *x + drift).collect();
        particles.vectors(VELOCITY).copy_from_slice(&velocities);
    };
    flow(&mut particles);
    let mut clock = Clock::at(0, 0.05);
    for _ in 0..400 {
        let now = clock;
        let mut evaluate = |particles: &mut Particles, fraction| {
            moving.advance_to(now.time_at(fraction), particles);
            flow(particles);
            Ok::<(), ()>(())
        };
        advance(&mut particles, clock.dt(), clock.step(), AdamsBashforth::Four, &mut evaluate).unwrap();
        evaluate(&mut particles, 1.0).unwrap();
        clock.tick();
    }
    let t = clock.time();
    let y = from.y + drift.y * t;
    let x = from.x + (drift.x + rate * from.y) * t + 0.5 * rate * drift.y * t * t;
    let exact = Vector::new(x, y, from.z + drift.z * t);
    let found = particles.positions[0] + moving.cell().lattice(particles.steps[0]);
    assert!((found - exact).length() < 1e-10 * exact.length(), "{found} is not {exact}");
    assert!(matches!(moving.vectors, Vectors::Sheared(9..)), "the lattice turned back: {:?}", moving.vectors);
}

/// In an oscillating flow a drifting particle obeys `x' = rate cos(w t) y + drift`. The error is that of the
/// method, whatever images it passes through, and zero without drift.
#[test]
fn a_drifting_particle_follows_an_oscillation() {
    let (rate, w, start) = (1.2, 3.0, PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap());
    let (end, from) = (2.0, Vector::new(1.0, 1.5, 0.2));
    let error = |drift: Vector, dt: f64| {
        let rates = ShearRates::new(rate, Protocol::Oscillation { frequency: w }, dt);
        let mut moving = PeriodicCell::at(&Clock::at(0, dt), start, rates, true);
        let mut particles = Particles::default();
        particles.push(0, from, 0.1, 0);
        particles.vectors(VELOCITY).fill(drift);
        let mut clock = Clock::at(0, dt);
        while clock.time() < end - 0.5 * dt {
            let now = clock;
            let mut go = |particles: &mut Particles, fraction| {
                moving.advance_to(now.time_at(fraction), particles);
                particles.vectors(VELOCITY).fill(drift);
                Ok::<(), ()>(())
            };
            advance(&mut particles, clock.dt(), clock.step(), AdamsBashforth::Four, &mut go).unwrap();
            go(&mut particles, 1.0).unwrap();
            clock.tick();
        }
        // The integral of rate cos(w t) (y0 + drift t)
        let (sin, cos) = (w * end).sin_cos();
        let sheared = rate / w * (sin * (from.y + drift.y * end) + drift.y * (cos - 1.0) / w);
        let exact = from + drift * end + Vector::X * sheared;
        (particles.positions[0] + moving.cell().lattice(particles.steps[0]) - exact).length()
    };
    assert!(error(Vector::ZERO, 0.05) < 1e-13, "{}", error(Vector::ZERO, 0.05));
    let drift = Vector::new(0.1, 1.9, -0.4);
    let order = (error(drift, 0.01) / error(drift, 0.005)).log2();
    assert!((order - 4.0).abs() < 0.2, "order {order}");
}

#[test]
fn a_box_taken_up_later_is_the_same() {
    let start = PeriodicBox::new(Vector::new(3.0, 2.0, 4.0)).unwrap();
    let mut moving = at_rate(0, start, 0.7);
    moving.advance_to(0.1 * 137.0, &mut Particles::default());
    let later = at_rate(137, start, 0.7);
    assert_eq!((moving.cell, moving.vectors), (later.cell, later.vectors));
}
