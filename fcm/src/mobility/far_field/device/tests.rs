//! The kernels, run by an emulator on the host, against the far field of the host.

use super::*;
use crate::mobility::Mobility;
use crate::plan::costs::Costs;
use crate::plan::method::Method;
use crate::plan::problem::{Fixed, Loading, Multipoles, Precision, Problem};
use crate::rigid::stresslet_solver::{RigidInput, StressletSolver};
use domain::{Boundaries, Comm, Random, Tensor};
use gpu::Emulator;

/// Spheres at random in a box, which may overlap: the far field is defined all the same.
struct Case {
    cell: PeriodicBox,
    particles: Particles,
    loads: Loads,
    tolerance: f64,
}

/// Numbers from a seed.
struct Numbers(Random);

impl Numbers {
    fn of(seed: u64) -> Self {
        Self(Random::new(seed, 0))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    fn vector(&mut self) -> Vector {
        Vector::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)))
    }
}

/// Shape of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Upright,
    Sheared,
    Tilted,
}

impl Case {
    /// With radii from 1 to `ratio` and a fraction of the volume, at most some spheres.
    fn random(seed: u64, shape: Shape, ratio: f64) -> Self {
        let mut numbers = Numbers::of(seed);
        let radii = [1.0, numbers.between(1.0, ratio), ratio];
        let fraction = 10_f64.powf(numbers.between(-2.0, -0.22));
        let volume_of = |radius: f64| 4.19 * radius * radius * radius;
        let mut chosen: Vec<f64> = (0..30).map(|i| if i % 6 == 5 { ratio } else { radii[i % 2] }).collect();
        let least = (2.1 * ratio).powi(3);
        if chosen.iter().map(|&a| volume_of(a)).sum::<f64>() / fraction < 1.4 * least {
            chosen.extend(std::iter::repeat_n(1.0, 30));
        }
        let volume = (chosen.iter().map(|&a| volume_of(a)).sum::<f64>() / fraction).max(1.4 * least);
        let stretch = Vector::new(1.0, numbers.between(1.0, 1.2), numbers.between(1.0, 1.2));
        let edges = stretch * (volume / stretch.element_product()).cbrt();
        let (strain, Vector { x, y, z }) = (numbers.between(-0.45, 0.45), edges);
        let lattice = [
            Vector::new(x, 0.0, 0.0),
            Vector::new(strain * y, y, 0.0),
            Vector::new(numbers.between(-0.3, 0.3) * z, numbers.between(-0.3, 0.3) * z, z),
        ];
        let turn = Tensor::from_rotation_x(0.4) * Tensor::from_rotation_z(-0.9);
        let cell = match shape {
            Shape::Upright => PeriodicBox::new(edges),
            Shape::Sheared => PeriodicBox::sheared(edges, strain),
            Shape::Tilted => PeriodicBox::of_lattice(lattice.map(|vector| turn * vector)),
        };
        let cell = cell.unwrap();
        let mut particles = Particles::default();
        for (id, &radius) in chosen.iter().enumerate() {
            let coordinates = std::array::from_fn(|axis| numbers.between(0.0, edges[axis]));
            particles.push(id as u64, cell.position(Vector::from_array(coordinates)), radius, 0);
        }
        let loads = loads_of(&mut numbers, &chosen);
        let tolerance = 10_f64.powf(numbers.between(-4.0, -1.5));
        Self { cell, particles, loads, tolerance }
    }

    /// Plan of the split method.
    fn plan(&self, precision: Precision) -> Plan {
        let [t, r] = Problem::tilts_of(&self.cell);
        let problem = Problem {
            edges: self.cell.edges(),
            boundaries: Boundaries::Periodic,
            volume: self.cell.volume(),
            shortest_vector: Problem::shortest_vector_of(&self.cell),
            smallest_edge_ratio: 1.0,
            largest_strain: self.cell.strain().abs(),
            largest_tilts: [t, r],
            radii: self.particles.radii.iter().map(|&radius| (radius, 1)).collect(),
            viscosity: 0.7,
            multipoles: Multipoles::Dipole,
            rigid: false,
            lubricated: false,
            loading: Loading::Varied,
            tolerance: self.tolerance,
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed { method: Some(Method::Split), precision: Some(precision), ..Fixed::default() },
        };
        Plan::choose(&problem).unwrap()
    }

    /// The same on a device.
    fn on_device(&self, plan: &Plan, device: Box<dyn Device>) -> DeviceFarField {
        let mut far = DeviceFarField::on(device, plan, &alone(plan));
        far.arrange(&self.cell, &self.particles);
        far
    }

    /// Loads of some particles.
    fn loads_of(&self, rows: &[usize]) -> Loads {
        Loads {
            forces: rows.iter().map(|&row| self.loads.forces[row]).collect(),
            torques: rows.iter().map(|&row| self.loads.torques[row]).collect(),
            stresslets: rows.iter().map(|&row| self.loads.stresslets[row]).collect(),
        }
    }

    fn on_host(&self, plan: &Plan) -> GridFarField {
        let mut far = GridFarField::new(plan, &alone(plan));
        far.arrange(&self.cell, &self.particles);
        far
    }

    /// Loads of one kind at a time, and all together.
    fn kinds(&self) -> [Loads; 4] {
        let Loads { forces, torques, stresslets } = self.loads.clone();
        [
            Loads { forces, ..Loads::default() },
            Loads { torques, ..Loads::default() },
            Loads { stresslets, ..Loads::default() },
            self.loads.clone(),
        ]
    }
}

fn loads_of(numbers: &mut Numbers, radii: &[f64]) -> Loads {
    let mut loads = Loads::default();
    for &radius in radii {
        loads.forces.push(numbers.vector() * radius);
        loads.torques.push(numbers.vector() * radius.powi(3));
        let [a, b] = [numbers.vector(), numbers.vector()];
        loads.stresslets.push(Traceless([a.x, a.y, a.z, b.x, b.y]) * radius.powi(3));
    }
    loads
}

fn alone(plan: &Plan) -> Partition {
    Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]])
}

/// The emulator, compiled once beside the tests; with the options of `EMULATOR_FLAGS` too, see `scripts/kernels`.
fn emulator(options: &[&str], seed: u64) -> Box<dyn Device> {
    let more = std::env::var("EMULATOR_FLAGS").unwrap_or_default();
    let options: &[&str] = &[options, &more.split_whitespace().collect::<Vec<_>>()].concat();
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    Box::new(Emulator::start(&Emulator::compile(&folder, options).unwrap(), seed).unwrap())
}

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

/// Parity of some random cases: seeds from a first on.
fn agree(precision: Precision, allowed: f64, seeds: std::ops::Range<u64>, device: &dyn Fn(u64) -> Box<dyn Device>) {
    for seed in seeds {
        let shape = [Shape::Upright, Shape::Sheared, Shape::Tilted][seed as usize % 3];
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
    agree(Precision::Double, 1e-11, 0..cases(), &|seed| emulator(&[], seed));
}

#[test]
fn single_precision_agrees_with_the_host_to_its_round_off() {
    agree(Precision::Single, 2e-5, 1000..1000 + cases(), &|seed| emulator(&[], seed));
}

/// Shuffled threads and blocks.
#[test]
fn any_order_of_threads_gives_the_same_bits() {
    for (shape, precision) in [(Shape::Sheared, Precision::Single), (Shape::Tilted, Precision::Double)] {
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
    for (seed, precision) in [(40, Precision::Single), (41, Precision::Double), (42, Precision::Double)] {
        let shape = [Shape::Upright, Shape::Sheared, Shape::Tilted][seed as usize % 3];
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

/// The forecast of `check`, apart from the transforms, beside the memory that an emulator serves.
#[test]
#[ignore = "heavy"]
fn memory_is_as_predicted() {
    for (seed, precision) in [(33, Precision::Single), (34, Precision::Double)] {
        let case = Case::random(seed, Shape::Sheared, 1.5);
        let plan = case.plan(precision);
        let mut device = case.on_device(&plan, emulator(&[], seed));
        device.apply(&case.loads, Output::All);
        let card = device.split.borrow().device().unwrap();
        let count = case.particles.len() as f64;
        let expected = plan.size_on_card(count, device.split.borrow().neighbours() as f64 / count).bytes().lists;
        let found = card.total_bytes - card.free_bytes;
        // The forecast leaves out the window and the tables along the axes.
        let of_tables = 16e3;
        assert!((expected..expected + of_tables).contains(&found), "{found} bytes, {expected} expected");
    }
}

/// Random motions by the same numbers, to round-off: the square root of the pair corrections takes as many steps.
#[test]
fn noise_is_that_of_the_host() {
    for (seed, shape, precision, allowed) in [
        (60, Shape::Upright, Precision::Single, 1e-4),
        (61, Shape::Sheared, Precision::Double, 1e-10),
        (62, Shape::Tilted, Precision::Double, 1e-10),
    ] {
        let case = Case::random(seed, shape, 1.3);
        let of_dipoles = case.plan(precision);
        let of_forces = Plan { multipoles: Multipoles::Monopole, ..of_dipoles.clone() };
        for plan in [of_dipoles, of_forces] {
            let (mut device, mut host) = (case.on_device(&plan, emulator(&[], seed)), case.on_host(&plan));
            let stream = crate::mobility::noise::Stream::new(3, seed);
            let draw = NoiseRequest { ids: &case.particles.ids, tolerance: 1e-3, stream };
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

/// With a card: parity. Without one: a reason.
#[test]
fn a_card_agrees_with_the_host_or_is_not_there() {
    match Cuda::open() {
        Ok(_) => {
            let card = |_| -> Box<dyn Device> { Box::new(Cuda::open().unwrap()) };
            agree(Precision::Double, 1e-11, 0..cases(), &card);
            agree(Precision::Single, 2e-5, 1000..1000 + cases(), &card);
        }
        Err(reason) => assert_eq!(Cuda::check(), Err(reason)),
    }
}
