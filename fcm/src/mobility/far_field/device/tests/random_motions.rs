//! Random motions on a device, by its emulator, against those of the host.

use super::*;
use crate::mobility::noise::Stream;
use gpu::EvaluationSize;

/// A draw for the particles of a case.
fn draw(particles: &Particles, number: u64) -> NoiseRequest<'_> {
    NoiseRequest { ids: &particles.ids, tolerance: 1e-3, stream: Stream::new(3, number) }
}

/// Random motions by the same numbers, to round-off: the square root of the pair corrections takes as many steps.
#[test]
fn noise_is_that_of_the_host() {
    for (seed, shape, precision, allowed) in [
        (60, Shape::Upright, Precision::Single, 1e-4),
        (61, Shape::Sheared, Precision::Double, 1e-10),
        (62, Shape::Tilted, Precision::Double, 1e-10),
        (63, OPEN, Precision::Double, 1e-10),
        (64, CHANNELS[1], Precision::Double, 1e-10),
    ] {
        let case = Case::random(seed, shape, 1.3);
        let of_dipoles = case.plan(precision);
        let of_forces = Plan { multipoles: Multipoles::Monopole, ..of_dipoles.clone() };
        for plan in [of_dipoles, of_forces] {
            let (mut device, mut host) = (case.on_device(&plan, emulator(&[], seed)), case.on_host(&plan));
            let draw = draw(&case.particles, seed);
            let ((found, steps), (exact, expected)) = (device.noise(&draw), host.noise(&draw));
            assert_eq!(steps.iterations, expected.iterations);
            for (found, exact) in columns(&found).iter().zip(columns(&exact)) {
                assert!(relative(found, &exact) < allowed, "{shape:?}: {:e}", relative(found, &exact));
            }
            let none = Loads::default();
            let still = device.apply(&none, Output::Velocities);
            assert_eq!(still.velocities, vec![Vector::ZERO; case.particles.len()], "the field is still there");
            assert!(device.host.is_none());
        }
    }
}

/// From draw to draw, of the same particles and of others: the second one runs from recordings, and a basis may be
/// smaller or larger than the one before.
#[test]
fn draws_follow_each_other() {
    let case = Case::random(65, Shape::Sheared, 1.5);
    let plan = case.plan(Precision::Double);
    let (mut device, mut host) = (case.on_device(&plan, emulator(&[], 1)), case.on_host(&plan));
    for rows in [0..20, 3..30, 0..0, 4..5] {
        let particles = case.particles.selected(&rows.collect::<Vec<_>>());
        device.arrange(&case.cell, &particles);
        host.arrange(&case.cell, &particles);
        let mut past: Option<Motion> = None;
        for number in 0..3 {
            let draw = draw(&particles, number);
            let ((found, steps), (exact, expected)) = (device.noise(&draw), host.noise(&draw));
            assert_eq!(steps.iterations, expected.iterations);
            for (found, exact) in columns(&found).iter().zip(columns(&exact)) {
                assert!(relative(found, &exact) < 1e-10, "draw {number} of {}", particles.len());
            }
            assert!(particles.is_empty() || past.as_ref() != Some(&found), "draws differ");
            past = Some(found);
        }
    }
}

/// Copies of the spheres of a case at other places, so many that kernels take several blocks.
fn copies_of(case: Case) -> Case {
    let mut particles = Particles::default();
    for id in 0..300 {
        let (copy, row) = (id / case.particles.len(), id % case.particles.len());
        let shift = case.cell.edges() * Vector::new(0.31, 0.57, 0.73) * copy as f64;
        particles.push(id as u64, case.particles.positions[row] + shift, case.particles.radii[row], 0);
    }
    particles.wrap(&case.cell);
    Case { particles, ..case }
}

/// Shuffled threads and blocks.
#[test]
fn draws_have_the_same_bits_in_any_order_of_threads() {
    for (shape, precision, allowed) in
        [(Shape::Tilted, Precision::Single, 1e-4), (Shape::Sheared, Precision::Double, 1e-10)]
    {
        let case = copies_of(Case::random(66, shape, 1.2));
        let plan = case.plan(precision);
        let motion = |seed: u64| case.on_device(&plan, emulator(&[], seed)).noise(&draw(&case.particles, 0));
        let first = motion(1);
        assert!((2..4).all(|seed| motion(seed) == first));
        let (exact, expected) = case.on_host(&plan).noise(&draw(&case.particles, 0));
        assert_eq!(first.1.iterations, expected.iterations);
        for (found, exact) in columns(&first.0).iter().zip(columns(&exact)) {
            assert!(relative(found, &exact) < allowed, "{shape:?}: {:e}", relative(found, &exact));
        }
    }
}

/// The forecast of `check` for as many vectors as a draw takes.
#[test]
fn memory_of_draws_is_as_predicted() {
    let case = Case::random(67, Shape::Sheared, 1.5);
    let plan = case.plan(Precision::Single);
    let mut device = case.on_device(&plan, emulator(&[], 1));
    device.apply(&case.loads, Output::All);
    let free = |device: &DeviceFarField| device.split.borrow().device().unwrap().free_bytes;
    let before = free(&device);
    let (_, drawn) = device.noise(&draw(&case.particles, 0));
    let count = case.particles.len() as f64;
    let size = plan.size_on_card(CardCounts { owned: count, present: count, ranks: 1 }, 0.0);
    let vectors = |random_vectors: f64| EvaluationSize { random_vectors, ..size }.bytes().vectors;
    let expected = vectors(drawn.iterations as f64) - vectors(0.0);
    // The forecast leaves out the state of the iteration and the scales of the classes.
    let found = before - free(&device);
    assert!((expected..expected + 3e3).contains(&found), "{found} bytes, {expected} expected");
}
