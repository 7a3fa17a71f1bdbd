//! The solve by the kernels of a card, which an emulator runs on the host, against that of the host.

use super::*;
use crate::bodies::RigidBodies;
use crate::springs::{BondSprings, ContactSprings, TetherResistance};
use domain::{Boundaries, Random};
use fcm::{Method, Mobility, PastSolutions, StressletSolver};
use gpu::{Counted, Device, DeviceCounts, Emulator};

/// Spheres of two sizes in a box, one pair of them near contact.
pub(super) struct Suspension {
    pub(super) cell: PeriodicBox,
    pub(super) particles: Particles,
    pub(super) plan: Plan,
}

impl Suspension {
    /// In a sheared box.
    pub(super) fn new(precision: Precision, iteration: f64) -> Self {
        let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
        Self::within(sheared, precision, iteration)
    }

    /// In a box of some shape with the volume of a cube.
    pub(super) fn within(shape: impl Fn(f64) -> PeriodicBox, precision: Precision, iteration: f64) -> Self {
        Self::of(16, shape, precision, iteration)
    }

    /// The same with any number of spheres.
    pub(super) fn of(spheres: usize, shape: impl Fn(f64) -> PeriodicBox, precision: Precision, iteration: f64) -> Self {
        let radii: Vec<f64> = (0..spheres).map(|i| if i % 4 == 3 { 1.6 } else { 1.0 }).collect();
        let volume: f64 = radii.iter().map(|a| 4.0 / 3.0 * PI * a * a * a).sum();
        let edge = (volume / 0.3).cbrt();
        let cell = shape(edge);
        let mut positions = random_packing(&cell, &radii, 0.0, 3).unwrap();
        let line = cell.nearest_image(positions[1] - positions[0]);
        let line = if cell.is_periodic(2) { line } else { Vector::new(line.x, line.y, 0.0) };
        positions[1] = positions[0] + line.normalize() * (2.0 + 1e-3);
        let cell = if cell.boundaries() == Boundaries::Open { around(&cell, &positions) } else { cell };
        let mut particles = placed(&positions, &radii);
        particles.wrap(&cell);
        let given = problem(edge, &[1.0, 1.6], 1e-3, iteration);
        let fixed = Fixed { precision: Some(precision), method: Some(Method::Split), ..given.fixed };
        let of_cell = Problem {
            edges: cell.edges(),
            boundaries: cell.boundaries(),
            volume: cell.volume(),
            shortest_vector: Problem::shortest_vector_of(&cell),
            largest_strain: cell.strain().abs(),
            largest_tilts: Problem::tilts_of(&cell),
            ..given
        };
        let plan = Plan::choose(&Problem { fixed, ..of_cell }).unwrap();
        Self { cell, particles, plan }
    }

    pub(super) fn partition(&self) -> Partition {
        Partition::new(&Comm::alone(), [self.plan.grid[1], self.plan.grid[2]])
    }

    pub(super) fn on_host(&self) -> CoupledSolver {
        CoupledSolver::new(&self.plan, &self.partition(), lubricated()).unwrap()
    }

    pub(super) fn on(&self, device: Box<dyn Device>) -> CoupledSolver {
        self.with_range(device, lubricated())
    }

    /// The same with other short-range interactions.
    pub(super) fn with_range(&self, device: Box<dyn Device>, short_range: ShortRange) -> CoupledSolver {
        self.on_rank(device, &self.partition(), short_range)
    }

    /// The same on a rank of several, each of which has a device.
    pub(super) fn on_rank(
        &self,
        device: Box<dyn Device>,
        partition: &Partition,
        short_range: ShortRange,
    ) -> CoupledSolver {
        let far = StressletSolver::of(Mobility::on(device, &self.plan, partition), partition.comm());
        CoupledSolver::of(far, partition, short_range).unwrap()
    }

    /// The same in double precision, to another tolerance.
    pub(super) fn with_tolerance(&self, iteration_tolerance: f64) -> Self {
        let Self { cell, particles, plan } = self;
        let plan = Plan { iteration_tolerance, precision: Precision::Double, ..plan.clone() };
        Self { cell: *cell, particles: particles.clone(), plan }
    }

    /// Solutions in shear, then of settling spheres with random torques in ambient motions, from the first as a guess.
    pub(super) fn solutions(&self, mut solver: CoupledSolver) -> [Solution; 2] {
        let mut numbers = Random::new(7, 0);
        let mut vector = || Vector::from_array(std::array::from_fn(|_| numbers.uniform() - 0.5));
        let none = Loads::default();
        let shear = acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
        let first = solver.solve(&self.cell, &self.particles, &shear, Guess::default()).unwrap();
        let radii = &self.particles.radii;
        let loads = Loads {
            forces: radii.iter().map(|a| Vector::new(0.0, 0.0, -a.powi(3))).collect(),
            torques: radii.iter().map(|_| vector()).collect(),
            stresslets: Vec::new(),
        };
        let ambient = Motion {
            velocities: radii.iter().map(|_| vector() * 0.1).collect(),
            angular_velocities: radii.iter().map(|_| vector() * 0.1).collect(),
            strain_rates: radii.iter().map(|_| Traceless([0.02, vector().x, 0.0, 0.1, vector().y])).collect(),
        };
        let settling = SolveInput { ambient: &ambient, ..acting(&loads, Traceless::ZERO) };
        let guess = Guess { stresslets_far: first.far.stresslets.clone(), ..Guess::induced_by(&first.motion) };
        [first, solver.solve(&self.cell, &self.particles, &settling, guess).unwrap()]
    }
}

/// Lubrication of the usual range.
pub(super) fn lubricated() -> ShortRange {
    lubricated_at(Some(LubricationRange::default()))
}

/// A rigid body, whose solves iterate on the host.
#[test]
#[ignore = "heavy"]
fn bodies_are_those_of_the_host() {
    let suspension = Suspension::new(Precision::Double, 1e-6);
    let Suspension { cell, particles, .. } = &suspension;
    let count = particles.len();
    let centre = 0.5 * (particles.positions[0] + particles.positions[1]);
    let is_member = |row: usize| row < 2;
    let of: Vec<Option<u32>> = (0..count).map(|row| is_member(row).then_some(0)).collect();
    let arm = |row: usize| if is_member(row) { particles.positions[row] - centre } else { Vector::ZERO };
    let rigid = RigidBodies::new(&Comm::alone(), &of, &(0..count).map(arm).collect::<Vec<_>>());
    let none = Loads::default();
    let input = SolveInput { bodies: Some(&rigid), ..acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
    let solved = |mut solver: CoupledSolver| solver.solve(cell, particles, &input, Guess::default()).unwrap();
    let (device, counts) = Counted::new(emulator(13));
    let [found, exact] = [suspension.on(Box::new(device)), suspension.on_host()].map(solved);
    assert_eq!(found.iterations, exact.iterations);
    let counts = counts.borrow();
    assert!(counts.runs["solve_f64"] >= exact.iterations as u64 && !counts.runs.contains_key("coupled_loads_f64"));
    for (found, exact) in columns(&found).iter().zip(&columns(&exact)) {
        assert!(relative(found, exact) < 3e-6, "{:e}", relative(found, exact));
    }
}

/// A box around positions in unbounded fluid, with room for displacements.
fn around(cell: &PeriodicBox, positions: &[Vector]) -> PeriodicBox {
    let low = positions.iter().fold(positions[0], |low, &x| low.min(x));
    let high = positions.iter().fold(positions[0], |high, &x| high.max(x));
    let room = Vector::splat(0.01);
    cell.with_extent(low - room, high - low + 2.0 * room).unwrap()
}

pub(super) fn emulator(seed: u64) -> Box<dyn Device> {
    Box::new(Emulator::beside_program(&[], seed).unwrap())
}

/// Numbers of a solution by kind: motions, loads on the far field, and whole stresslets.
pub(super) fn columns(solution: &Solution) -> [Vec<f64>; 6] {
    let vectors = |list: &[Vector]| list.iter().flat_map(Vector::to_array).collect();
    let tensors = |list: &[Traceless]| list.iter().flat_map(|tensor| tensor.0).collect();
    let Solution { motion, far, stresslets, .. } = solution;
    [
        vectors(&motion.velocities),
        vectors(&motion.angular_velocities),
        vectors(&far.forces),
        vectors(&far.torques),
        tensors(&far.stresslets),
        tensors(stresslets),
    ]
}

/// Root of the mean square of a difference over that of the values.
pub(super) fn relative(found: &[f64], exact: &[f64]) -> f64 {
    assert!(found.len() == exact.len() && !exact.is_empty());
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|value| value * value).sum::<f64>();
    let difference = square(&mut found.iter().zip(exact).map(|(found, exact)| found - exact));
    (difference / square(&mut exact.iter().copied())).sqrt()
}

/// Both solutions have errors of some times the tolerance, in no more iterations but for the last steps.
#[test]
#[ignore = "heavy"]
fn solutions_are_those_of_the_host() {
    let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
    for (precision, iteration) in [(Precision::Double, 1e-6), (Precision::Single, 1e-4)] {
        agree(&Suspension::within(sheared, precision, iteration));
    }
}

/// The same in unbounded fluid.
#[test]
fn solutions_in_unbounded_fluid_are_those_of_the_host() {
    let open = |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(Boundaries::Open).unwrap();
    agree(&Suspension::within(open, Precision::Double, 1e-4));
}

/// Errors of the device by solutions of the host in double precision, to a smaller tolerance.
fn agree(suspension: &Suspension) {
    agree_in(suspension, |solver| suspension.solutions(solver));
}

/// The same for any solutions.
pub(super) fn agree_in(suspension: &Suspension, solutions: impl Fn(CoupledSolver) -> [Solution; 2]) {
    let Plan { precision, iteration_tolerance: iteration, .. } = suspension.plan;
    let fine = suspension.with_tolerance(1e-2 * iteration);
    let [exact, of_host, found] = [fine.on_host(), suspension.on_host(), suspension.on(emulator(11))].map(solutions);
    for ((found, of_host), exact) in found.iter().zip(&of_host).zip(&exact) {
        assert!(found.iterations > 3 && found.iterations <= of_host.iterations + 2, "{}", found.iterations);
        let all = columns(found).into_iter().zip(columns(of_host)).zip(columns(exact));
        for (kind, ((found, of_host), exact)) in all.enumerate() {
            let [error, of_host] = [&found, &of_host].map(|values| relative(values, &exact));
            assert!(error < 3.0 * iteration.max(of_host), "{precision:?}, kind {kind}: {error:e}, host {of_host:e}");
        }
    }
}

/// A solve starts from columns that stayed on the device as it does from the same numbers as lists.
#[test]
fn columns_on_the_device_are_a_guess_as_lists_are() {
    let suspension = Suspension::new(Precision::Single, 1e-2);
    let Suspension { cell, particles, .. } = &suspension;
    let mut solver = suspension.on(emulator(5));
    let none = Loads::default();
    let input = SolveInput { keeps_columns: true, ..acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
    let mut solved = |guess| solver.solve(cell, particles, &input, guess).unwrap();
    let first = solved(Guess::default());
    let kept = first.kept.as_ref().unwrap().columns.guessed.clone();
    assert!(first.stresslets.is_empty() && !kept[0].is_here());
    let from_columns = solved(Guess { past: Some(PastSolutions::last(kept)), ..Guess::default() });
    let lists =
        suspension.on(emulator(6)).solve(cell, particles, &acting(&none, input.strain_rate.at_zero), Guess::default());
    let Solution { far, induced, motion, iterations, .. } = lists.unwrap();
    let from_lists = solved(Guess {
        stresslets_far: far.stresslets,
        velocities: motion.velocities,
        angular_velocities: motion.angular_velocities,
        ..Guess::induced_by(&induced)
    });
    assert!(from_columns.iterations < iterations);
    let [from_columns, from_lists] = [from_columns, from_lists].map(|solution| solver.with_lists(solution, particles));
    assert_eq!(from_columns, from_lists);
}

/// Shuffled threads and blocks.
#[test]
fn any_order_of_threads_gives_the_same_bits() {
    let suspension = Suspension::new(Precision::Single, 1e-2);
    let [first, second] = [1, 2].map(|seed| suspension.solutions(suspension.on(emulator(seed))));
    assert_eq!(first, second);
}

/// Solutions in shear to two tolerances, with what the device has done for each.
fn counted(iteration: f64) -> (Solution, DeviceCounts) {
    let suspension = Suspension::new(Precision::Single, iteration);
    let (device, counts) = Counted::new(emulator(5));
    let mut solver = suspension.on(Box::new(device));
    let none = Loads::default();
    let shear = acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
    let solution = solver.solve(&suspension.cell, &suspension.particles, &shear, Guess::default()).unwrap();
    let counts = counts.borrow().clone();
    (solution, counts)
}

/// More iterations copy a few numbers between the host and the device at a time, wait once each except for more steps
/// of the preconditioner, and are recorded.
#[test]
fn iterations_stay_on_the_device() {
    let [(rough, few), (fine, many)] = [1e-2, 1e-4].map(counted);
    assert!(fine.iterations > rough.iterations + 3, "{} {}", rough.iterations, fine.iterations);
    for (few, many) in [(few.uploads, many.uploads), (few.downloads, many.downloads)] {
        let [copies, bytes] = std::array::from_fn(|k| many[k] - few[k]);
        assert!(copies > 0 && bytes <= 13 * 8 * copies, "{copies} copies of {bytes} bytes");
    }
    let iterations = (fine.iterations - rough.iterations) as u64;
    assert!(many.waits - few.waits <= iterations + iterations / 2 + 1, "{} for {iterations}", many.waits - few.waits);
    let [launches, runs] =
        [[&few, &many].map(|counts| counts.launches), [&few, &many].map(|counts| counts.runs.values().sum())];
    let [commands, of_kernels] = [launches, runs].map(|[few, many]: [u64; 2]| many - few);
    assert!(3 * commands < of_kernels, "{commands} commands for {of_kernels}");
    for (solution, counts) in [(&rough, &few), (&fine, &many)] {
        assert!(counts.replays >= solution.iterations as u64 - 1, "{}", counts.replays);
        // Groups of spheres near contact leave few steps to the iteration of the preconditioner.
        let (steps, solves) = (counts.runs["step_pairs"], solution.iterations as u64 + 2);
        assert!(steps < 10 * solves, "{steps} steps in {solves} solves");
        assert_eq!(counts.runs["solve_f32"], solution.iterations as u64 + 1);
        assert_eq!(counts.runs["coupled_image_f32"], solution.iterations as u64 + 1);
    }
}

/// Spheres in a box that shears on, under other loads in each step: what was recorded in steps before serves the later
/// ones, with the bits of a device that has recorded nothing.
#[test]
fn recordings_serve_later_steps() {
    let Suspension { mut cell, mut particles, plan } = Suspension::new(Precision::Single, 1e-2);
    let (device, counts) = Counted::new(emulator(5));
    let mut used = Suspension { cell, particles: particles.clone(), plan: plan.clone() }.on(Box::new(device));
    let steps = 6;
    for step in 0..steps {
        let strength = 1.0 + 0.1 * f64::from(step);
        let loads = Loads { forces: vec![Vector::new(0.1, 0.0, -strength); particles.len()], ..Loads::default() };
        let input = acting(&loads, Traceless([0.0, 0.5 * strength, 0.0, 0.0, 0.0]));
        let before = counts.borrow().clone();
        let solution = used.solve(&cell, &particles, &input, Guess::default()).unwrap();
        let (after, iterations) = (counts.borrow(), solution.iterations as u64);
        let [commands, waits] = [after.launches - before.launches, after.waits - before.waits];
        if step == steps - 1 {
            let fresh = Suspension { cell, particles: particles.clone(), plan: plan.clone() };
            let expected = fresh.on(emulator(6)).solve(&cell, &particles, &input, Guess::default()).unwrap();
            assert_eq!(solution, expected);
            assert!(commands <= 2 * iterations + 12 && waits <= 2 * iterations + 8, "{commands} and {waits}");
        }
        for (position, velocity) in particles.positions.iter_mut().zip(&solution.motion.velocities) {
            *position += (*velocity + Vector::X * (strength * position.y)) * 1e-3;
        }
        cell = PeriodicBox::sheared(cell.edges(), 0.3 + 1e-3 * strength * f64::from(step + 1)).unwrap();
        particles.wrap(&cell);
    }
}

/// Springs, traps, contacts and bonds that bend and twist are in the matrix of the device.
#[test]
fn springs_and_traps_are_in_the_rows() {
    let suspension = Suspension::new(Precision::Double, 1e-7);
    let Suspension { cell, particles, .. } = &suspension;
    let resistance = |distance: f64, _: lubrication::PairKind| 3.0 * (3.0 - distance).max(0.0);
    let traps = particles.ids.iter().map(|id| 0.1 * (1 + id % 3) as f64).collect();
    // Of the pair near contact, and of another one whose lubrication is soft or absent.
    let touching = |other| ContactSprings { other, within: f64::INFINITY, normal: 2.0, tangential: 5.0, rolling: 3.0 };
    let mut contacts = vec![Vec::new(); particles.len()];
    (contacts[0], contacts[1]) = (vec![touching(1)], vec![touching(0)]);
    let distance = |other: usize| cell.nearest_image(particles.positions[other] - particles.positions[2]).length();
    let far = (3..particles.len()).find(|&other| (3.2..4.0).contains(&distance(other))).unwrap();
    let bond = |other: usize| {
        let (other, within) = (other as u64, distance(far) + 1e-9);
        BondSprings { other, within, resistance: 4.0, bending: 6.0, twisting: 2.0 }
    };
    let mut bonds = vec![Vec::new(); particles.len()];
    (bonds[2], bonds[far]) = (vec![bond(far)], vec![bond(2)]);
    let tethers = TetherResistance { bonds: bonds.into_iter().collect(), traps };
    let springs = Springs { resistance: &resistance, contacts: &contacts.into_iter().collect(), tethers: &tethers };
    let none = Loads::default();
    let input = SolveInput { springs: Some(&springs), ..acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
    let free = acting(&none, input.strain_rate.at_zero);
    let solved = |mut solver: CoupledSolver, input| solver.solve(cell, particles, input, Guess::default()).unwrap();
    let [found, exact] = [suspension.on(emulator(4)), suspension.on_host()].map(|solver| solved(solver, &input));
    let without = solved(suspension.on_host(), &free);
    assert!(relative(&columns(&without)[0], &columns(&exact)[0]) > 1e-2);
    for (found, exact) in columns(&found).iter().zip(&columns(&exact)) {
        assert!(relative(found, exact) < 3e-6, "{:e}", relative(found, exact));
    }
}
