//! The kernels, run by an emulator on the host, against the far field of the host.

mod case;
mod displacement;
mod moving;
mod overlaps;
mod random_motions;
mod ranks;
mod steps;

use super::*;
use crate::mobility::Mobility;
use crate::plan::device::CardCounts;
use crate::plan::method::Split;
use crate::plan::problem::{Multipoles, Precision};
use crate::rigid::stresslet_solver::{RigidInput, StressletSolver};
use case::{Case, PERIODIC, Shape, alone};
use domain::{Boundaries, Comm};
use gpu::{Counted, Emulator};

/// The emulator, compiled once beside the tests.
fn emulator(options: &[&str], seed: u64) -> Box<dyn Device> {
    Box::new(Emulator::beside_program(options, seed).unwrap())
}

/// Unbounded fluid, and boxes with walls or open faces across z.
const OPEN: Shape = Shape::Bounded(Boundaries::Open);
const CHANNELS: [Shape; 3] =
    [Shape::Bounded(Boundaries::Walls), Shape::Bounded(Boundaries::Wall), Shape::Bounded(Boundaries::OpenAlongZ)];

/// Numbers of a motion by kind.
fn columns(motion: &Motion) -> [Vec<f64>; 3] {
    let vectors = |list: &[Vector]| list.iter().flat_map(Vector::to_array).collect();
    let strains = motion.strain_rates.iter().flat_map(|e| e.0).collect();
    [vectors(&motion.velocities), vectors(&motion.angular_velocities), strains]
}

/// Root of the mean square of a difference over that of the values.
fn relative(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    let difference = square(&mut found.iter().zip(exact).map(|(found, exact)| found - exact));
    if exact.is_empty() { 0.0 } else { (difference / square(&mut exact.iter().copied())).sqrt() }
}

/// Largest difference of the motions of all loads, kind by kind, and of each output.
fn difference(case: &Case, precision: Precision, device: Box<dyn Device>) -> f64 {
    let plan = case.plan(precision);
    let (mut device, mut host) = (case.on_device(&plan, device), case.on_host(&plan));
    let mut worst = 0.0_f64;
    for loads in case.kinds() {
        for output in [Output::All, Output::Velocities, Output::Gradients] {
            let [found, exact] = [device.apply(&loads, output), host.apply(&loads, output)];
            for (found, exact) in columns(&found).iter().zip(columns(&exact)) {
                worst = worst.max(relative(found, &exact));
            }
        }
    }
    worst
}

/// Devices by a seed.
type DeviceOfSeed<'a> = &'a dyn Fn(u64) -> Box<dyn Device>;

/// Parity of some random cases of some shapes: seeds from a first on.
fn agree(precision: Precision, shapes: &[Shape], seeds: std::ops::Range<u64>, device: DeviceOfSeed) {
    let allowed = if precision == Precision::Double { 1e-11 } else { 2e-5 };
    for seed in seeds {
        let shape = shapes[seed as usize % shapes.len()];
        let ratio = [1.0, 8.0, 2.3, 4.0][seed as usize % 4];
        let case = Case::random(seed, shape, ratio);
        let found = difference(&case, precision, device(seed));
        assert!(found < allowed, "{seed}: {shape:?}, 1:{ratio}, {:e}: {found:e}", case.tolerance);
    }
}

/// Random cases of each precision: a few, or as many as `EMULATOR_CASES` says, see `scripts/kernels`.
fn cases() -> u64 {
    std::env::var("EMULATOR_CASES").map_or(6, |count| count.parse().unwrap())
}

#[test]
#[ignore = "heavy"]
fn double_precision_agrees_with_the_host_to_round_off() {
    agree(Precision::Double, &PERIODIC, 0..cases(), &|seed| emulator(&[], seed));
}

#[test]
fn single_precision_agrees_with_the_host_to_its_round_off() {
    agree(Precision::Single, &PERIODIC, 1000..1000 + cases(), &|seed| emulator(&[], seed));
}

#[test]
fn unbounded_fluid_is_that_of_the_host() {
    let half = cases() / 2;
    agree(Precision::Double, &[OPEN], 100..100 + half, &|seed| emulator(&[], seed));
    agree(Precision::Single, &[OPEN], 1100..1100 + half, &|seed| emulator(&[], seed));
}

#[test]
fn walls_and_layers_are_those_of_the_host() {
    let half = cases() / 2;
    agree(Precision::Double, &CHANNELS, 200..200 + half, &|seed| emulator(&[], seed));
    agree(Precision::Single, &CHANNELS, 1200..1200 + half, &|seed| emulator(&[], seed));
}

/// Spheres at a wall, some so few that not all wavenumbers of their images are on the grid: of themselves and of each
/// other.
#[test]
fn images_in_walls_are_those_of_the_host() {
    let mut of_others = 0;
    for seed in 70..78 {
        let case = Case::random(seed, CHANNELS[seed as usize % 2], 1.5).with_fraction_of_edges(Vector::splat(0.4));
        let plan = case.plan(Precision::Double);
        let (mut device, mut host) = (case.on_device(&plan, emulator(&[], seed)), case.on_host(&plan));
        let lists = device.images.as_ref().unwrap().images.lists();
        for row in 0..case.particles.len() {
            let of_row = &lists.images[lists.starts[row] as usize..lists.starts[row + 1] as usize];
            of_others += of_row.iter().filter(|image| image[0] as usize != row).count();
        }
        let [found, exact] = [device.apply(&case.loads, Output::All), host.apply(&case.loads, Output::All)];
        for (found, exact) in columns(&found).iter().zip(columns(&exact)) {
            assert!(relative(found, &exact) < 1e-11, "{:e}", relative(found, &exact));
        }
    }
    assert!(of_others > 10, "{of_others}");
}

/// Shuffled threads and blocks.
#[test]
fn any_order_of_threads_gives_the_same_bits() {
    let cases = [(Shape::Sheared, Precision::Single), (Shape::Tilted, Precision::Double), (OPEN, Precision::Single)];
    for (shape, precision) in cases {
        let case = Case::random(31, shape, 1.7);
        let plan = case.plan(precision);
        let motion = |seed: u64| case.on_device(&plan, emulator(&[], seed)).apply(&case.loads, Output::All);
        let first = motion(1);
        assert!((2..6).all(|seed| motion(seed) == first));
    }
}

/// Bounds of global and shared memory, and undefined arithmetic.
#[test]
#[ignore = "heavy"]
fn kernels_stay_within_their_memory() {
    let sanitizers = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let cases = [
        (Shape::Upright, Precision::Single),
        (Shape::Sheared, Precision::Double),
        (Shape::Tilted, Precision::Double),
        (OPEN, Precision::Single),
        (CHANNELS[0], Precision::Double),
    ];
    for (seed, (shape, precision)) in (40..).zip(cases) {
        let case = Case::random(seed, shape, 2.0);
        let plan = case.plan(precision);
        let mut device = case.on_device(&plan, emulator(&sanitizers, seed));
        let exact = case.on_host(&plan).apply(&case.loads, Output::All);
        for _ in 0..2 {
            let found = device.apply(&case.loads, Output::All);
            assert!(relative(&columns(&found)[0], &columns(&exact)[0]) < 2e-5);
            device.arrange(&case.cell, &case.particles);
        }
    }
}

/// From call to call: other boxes, more and fewer particles, no loads at all.
#[test]
fn a_device_follows_changes_of_box_and_particles() {
    let case = Case::random(50, Shape::Sheared, 1.5);
    let plan = case.plan(Precision::Double);
    let (mut device, mut host) = (case.on_device(&plan, emulator(&[], 1)), case.on_host(&plan));
    let edges = case.cell.edges();
    for (rows, strain) in [(5..20, 0.0), (0..30, 0.5 * case.cell.strain()), (7..8, case.cell.strain())] {
        let cell = PeriodicBox::sheared(edges, strain).unwrap();
        let rows: Vec<usize> = rows.collect();
        let particles = case.particles.selected(&rows);
        let loads = case.loads_of(&rows);
        device.arrange(&cell, &particles);
        host.arrange(&cell, &particles);
        let [found, exact] = [device.apply(&loads, Output::All), host.apply(&loads, Output::All)];
        for (found, exact) in columns(&found).iter().zip(columns(&exact)) {
            assert!(relative(found, &exact) < 1e-11, "{} at {strain}", rows.len());
        }
        let still = device.apply(&Loads::default(), Output::Velocities);
        assert_eq!(still.velocities, vec![Vector::ZERO; rows.len()]);
    }
}

/// The box follows the spheres in unbounded fluid, and they have no images, even if the cutoff reaches across the
/// period of the grid.
#[test]
fn few_spheres_in_unbounded_fluid_have_no_images() {
    let case = Case::random(51, OPEN, 1.0).with_extent(Vector::new(-3.0, 5.0, 0.5), Vector::splat(2.5));
    let rows: Vec<usize> = (0..3).collect();
    let case = Case { particles: case.particles.selected(&rows), loads: case.loads_of(&rows), ..case };
    let usual = case.plan(Precision::Double);
    let split = usual.split.map(|split| Split { cutoff: usual.period.max_element(), ..split });
    let plan = Plan { split, ..usual };
    let exact = case.on_host(&plan).apply(&case.loads, Output::All);
    let mut device = case.on_device(&plan, emulator(&[], 1));
    for shift in [Vector::ZERO, Vector::new(1.0, -7.3, 40.1)] {
        let edges = case.cell.edges();
        let mut particles = case.particles.clone();
        particles.positions.iter_mut().for_each(|x| *x += shift);
        device.arrange(&case.cell.with_extent(case.cell.origin() + shift, edges).unwrap(), &particles);
        for (found, exact) in columns(&device.apply(&case.loads, Output::All)).iter().zip(columns(&exact)) {
            assert!(relative(found, &exact) < 1e-11, "{:e} at {shift}", relative(found, &exact));
        }
    }
}

/// Rigid spheres: stresslets that are found on the device, beside those of the solver on the host.
#[test]
fn stresslets_are_those_of_the_host() {
    for (seed, shape, precision, allowed) in
        [(80, Shape::Sheared, Precision::Double, 1e-8), (81, Shape::Tilted, Precision::Single, 1e-3)]
    {
        let case = Case::random(seed, shape, 1.6);
        let plan = Plan { iteration_tolerance: 0.1 * allowed, ..case.plan(precision) };
        let Loads { forces, torques, stresslets: guess } = case.loads.clone();
        let loads = Loads { forces, torques, ..Loads::default() };
        let background = Traceless([0.2, -0.1, 0.0, 0.3, 0.05]);
        let mut ambient = Motion::default();
        for force in &case.loads.forces {
            ambient.velocities.push(0.1 * *force);
            ambient.angular_velocities.push(0.2 * *force);
            ambient.strain_rates.push(Traceless([force.x, 0.1, force.y, 0.0, force.z]));
        }
        let input = RigidInput { loads: &loads, ambient: &ambient, background, guess: &guess, quadrupoles: None };
        let mut host = StressletSolver::new(&plan, &alone(&plan));
        let exact = host.solve_in(&case.cell, &case.particles, &input).unwrap();
        let far: Box<dyn FarField> = Box::new(case.on_device(&plan, emulator(&[], seed)));
        let partition = alone(&plan);
        let mobility = Mobility { plan, partition, far, wall_drift: None, constraint: None };
        let mut device = StressletSolver::of(mobility, &Comm::alone());
        let found = device.solve_in(&case.cell, &case.particles, &input).unwrap();
        assert!(found.iterations > 2 && found.iterations.abs_diff(exact.iterations) <= 1, "{}", found.iterations);
        let stresslets = |list: &[Traceless]| list.iter().flat_map(|s| s.0).collect::<Vec<_>>();
        let difference = relative(&stresslets(&found.stresslets), &stresslets(&exact.stresslets));
        assert!(difference < allowed, "{difference:e} in the stresslets");
        for (found, exact) in columns(&found.motion).iter().zip(columns(&exact.motion)) {
            assert!(relative(found, &exact) < allowed, "{:e}", relative(found, &exact));
        }
    }
}

/// Vectors of the iteration stay on the device: the host waits for a few sums in each step, and for nothing else.
#[test]
fn an_iteration_for_stresslets_waits_once() {
    let case = Case::random(82, Shape::Sheared, 1.6);
    let solved = |iteration_tolerance| {
        let plan = Plan { iteration_tolerance, ..case.plan(Precision::Double) };
        let (device, counts) = Counted::new(emulator(&[], 1));
        let far: Box<dyn FarField> = Box::new(case.on_device(&plan, Box::new(device)));
        let partition = alone(&plan);
        let mobility = Mobility { plan, partition, far, wall_drift: None, constraint: None };
        let input = RigidInput {
            loads: &Loads { forces: case.loads.forces.clone(), ..Loads::default() },
            ambient: &Motion::default(),
            background: Traceless([0.2, -0.1, 0.0, 0.3, 0.05]),
            guess: &[],
            quadrupoles: None,
        };
        let mut solver = StressletSolver::of(mobility, &Comm::alone());
        let found = solver.solve_in(&case.cell, &case.particles, &input).unwrap();
        (found.iterations as u64, counts.borrow().waits)
    };
    let [(few, before), (many, after)] = [1e-2, 1e-6].map(solved);
    assert!(many > few + 3 && after - before == many - few, "{} waits in {} steps", after - before, many - few);
}

/// The forecast of `check`, apart from the transforms, beside the memory that an emulator serves.
#[test]
#[ignore = "heavy"]
fn memory_is_as_predicted() {
    let cases = [(Shape::Sheared, Precision::Single), (Shape::Sheared, Precision::Double), (OPEN, Precision::Single)];
    for (seed, (shape, precision)) in (33..).zip(cases) {
        let case = Case::random(seed, shape, 1.5);
        let plan = case.plan(precision);
        let mut device = case.on_device(&plan, emulator(&[], seed));
        device.apply(&case.loads, Output::All);
        let card = device.split.borrow().device().unwrap();
        let count = case.particles.len() as f64;
        let counts = CardCounts { owned: count, present: count, ranks: 1 };
        let neighbours = device.split.borrow().neighbours() as f64 / count;
        let expected = plan.size_on_card(counts, neighbours).bytes().lists;
        let found = card.total_bytes - card.free_bytes;
        // The forecast leaves out the window and the tables along the axes.
        let of_tables = 16e3;
        assert!((expected..expected + of_tables).contains(&found), "{found} bytes, {expected} expected");
    }
}

/// With a card: parity. Without one: a reason.
#[test]
fn a_card_agrees_with_the_host_or_is_not_there() {
    match Cuda::open(0) {
        Ok(_) => {
            let card = |_| -> Box<dyn Device> { Box::new(Cuda::open(0).unwrap()) };
            agree(Precision::Double, &PERIODIC, 0..cases(), &card);
            agree(Precision::Single, &PERIODIC, 1000..1000 + cases(), &card);
            agree(Precision::Single, &[OPEN], 1100..1100 + cases() / 2, &card);
            agree(Precision::Single, &CHANNELS, 1200..1200 + cases(), &card);
        }
        Err(reason) => assert_eq!(Cuda::check(), Err(reason)),
    }
}
