//! Residuals of random solutions, and their changes where spheres have moved, by the kernels of a card, which an
//! emulator runs on the host, against those of the host.

use super::device_pairs::tilted;
use super::on_device::{Suspension, emulator, relative};
use super::*;
use crate::brownian::{self, CHANGE, DISPLACEMENT, FiniteDifference};
use crate::solution::StoredSolution;
use domain::Boundaries;
use fcm::{Mobility, Stream, StressletSolver};
use gpu::{Counted, Device};

/// Time in which the drawn motions displace spheres by about a thousandth of a radius.
const TIME: f64 = 2e-3;

/// Relative error of changes that are to be exact, and of those by which they are compared.
const TIGHT: f64 = 1e-5;
const EXACT: f64 = 1e-7;

/// Round-off of ambient motions in double precision, which the resistance of the pair near contact magnifies, and in
/// single precision.
const ROUND_OFF: f64 = 1e-9;
const ROUND_OFF_SINGLE: f64 = 2e-5;

/// Rate of strain of the background.
const SHEAR: Traceless = Traceless([0.0, 0.1, 0.0, 0.0, 0.0]);

/// A suspension with or without lubrication.
struct DisplacedCase {
    suspension: Suspension,
    range: Option<LubricationRange>,
}

/// Motions of a fluctuating fluid, random loads, and the solution for both in shear.
struct RandomSolution {
    fluid: Motion,
    loads: Loads,
    solved: Solution,
}

/// Response of a solver to a displacement: the ambient motions for which a solution is exact, with its stresslets; and
/// the changes of motions and stresslets, with the number of iterations.
#[derive(Debug, PartialEq)]
struct Response {
    ambient: [Vec<f64>; 4],
    change: [Vec<f64>; 3],
    iterations: u64,
}

fn vectors(list: &[Vector]) -> Vec<f64> {
    list.iter().flat_map(Vector::to_array).collect()
}

fn tensors(list: &[Traceless]) -> Vec<f64> {
    list.iter().flat_map(|tensor| tensor.0).collect()
}

fn less(all: Vec<f64>, part: &[f64]) -> Vec<f64> {
    all.into_iter().zip(part).map(|(all, part)| all - part).collect()
}

fn sheared(edge: f64) -> PeriodicBox {
    PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap()
}

/// A fuller box: 16 spheres at a volume fraction of 0.42.
fn full(edge: f64) -> PeriodicBox {
    sheared(0.894 * edge)
}

fn bounded(boundaries: Boundaries) -> impl Fn(f64) -> PeriodicBox {
    move |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(boundaries).unwrap()
}

impl DisplacedCase {
    fn new(shape: impl Fn(f64) -> PeriodicBox, precision: Precision, range: Option<LubricationRange>) -> Self {
        Self { suspension: Suspension::within(shape, precision, 1e-3), range }
    }

    fn of_far(&self, far: StressletSolver) -> CoupledSolver {
        CoupledSolver::of(far, &self.suspension.partition(), lubricated_at(self.range)).unwrap()
    }

    fn on_host(&self) -> CoupledSolver {
        self.of_far(StressletSolver::new(&self.suspension.plan, &self.suspension.partition()))
    }

    fn on(&self, device: Box<dyn Device>) -> CoupledSolver {
        let partition = self.suspension.partition();
        self.of_far(StressletSolver::of(Mobility::on(device, &self.suspension.plan, &partition), partition.comm()))
    }

    /// The same in double precision.
    fn exact(&self) -> Self {
        Self { suspension: self.suspension.with_tolerance(1e-3), range: self.range }
    }

    /// A solution by the host.
    fn drawn(&self) -> RandomSolution {
        let (Suspension { cell, particles, .. }, stream) = (&self.suspension, Stream::new(3, 1));
        let mut solver = self.on_host();
        let (fluid, _) = solver.noise(cell, particles, 1e-3, stream);
        let loads = solver.pair_noise(cell, particles, None, stream);
        let input = SolveInput { ambient: &fluid, ..acting(&loads, SHEAR) };
        let solved = solver.solve(cell, particles, &input, Guess::induced_by(&fluid)).unwrap();
        RandomSolution { fluid, loads, solved }
    }

    /// Response to a displacement by the drawn motions, to a relative error.
    fn response(&self, mut solver: CoupledSolver, drawn: &RandomSolution, tolerance: f64) -> Response {
        let RandomSolution { fluid, loads, solved } = drawn;
        let Suspension { cell, particles, .. } = &self.suspension;
        solver.mobility().follow(cell, particles);
        let (ambient, found) = solver.equivalent_ambient(cell, particles, loads, solved).unwrap();
        let StoredSolution { motion: before, stresslets, .. } = &found;
        let mut displaced = particles.clone();
        displaced.positions.iter_mut().zip(&fluid.velocities).for_each(|(x, &v)| *x += v * TIME);
        displaced.wrap(cell);
        let evaluated = solver.mobility().work().evaluations;
        let at = DisplacedSpheres { cell, particles: &displaced, loads, ambient: &ambient };
        let (motion, changed) = solver.perturbed_solution(&at, &found, tolerance).unwrap();
        let columns = |motion: &Motion| [vectors(&motion.velocities), vectors(&motion.angular_velocities)];
        let ([v, w], [v0, w0]) = (columns(&motion), columns(before));
        let change = [less(v, &v0), less(w, &w0), less(tensors(&changed), &tensors(stresslets))];
        let [v, w] = columns(&ambient);
        let iterations = solver.mobility().work().evaluations - evaluated - 1;
        Response { ambient: [v, w, tensors(&ambient.strain_rates), tensors(stresslets)], change, iterations }
    }

    /// Responses of the host in double precision, of the host, and of a card.
    fn responses(&self, tolerance: f64) -> [Response; 3] {
        let (exact, drawn) = (self.exact(), self.exact().drawn());
        let of_exact = exact.response(exact.on_host(), &drawn, EXACT);
        let [of_host, of_card] =
            [self.on_host(), self.on(emulator(7))].map(|solver| self.response(solver, &drawn, tolerance));
        [of_exact, of_host, of_card]
    }

    /// Ambient motions and stresslets are those of the host to round-off, and changes have errors of at most three
    /// times the tolerance, or twice that of the host, in at most two iterations more.
    fn agree(&self, tolerance: f64, round_off: f64) {
        let [exact, host, card] = self.responses(tolerance);
        for (kind, (found, exact)) in card.ambient.iter().zip(&exact.ambient).enumerate() {
            let error = relative(found, exact);
            assert!(error < round_off, "ambient motions of kind {kind}: {error:e}");
        }
        for (kind, (found, exact)) in card.change.iter().zip(&exact.change).enumerate() {
            let [error, of_host] = [found, &host.change[kind]].map(|change| relative(change, exact));
            assert!(error < (3.0 * tolerance).max(2.0 * of_host), "change of kind {kind}: {error:e}, {of_host:e}");
        }
        assert!(card.iterations > 0 && card.iterations <= host.iterations + 2, "{}", card.iterations);
    }
}

#[test]
fn changes_of_lubricated_spheres_are_those_of_the_host() {
    let range = Some(LubricationRange::default());
    for (shape, precision, tolerance, round_off) in [
        (sheared as fn(f64) -> PeriodicBox, Precision::Double, TIGHT, ROUND_OFF),
        (full, Precision::Double, CHANGE, ROUND_OFF),
        (tilted, Precision::Single, CHANGE, ROUND_OFF_SINGLE),
    ] {
        DisplacedCase::new(shape, precision, range).agree(tolerance, round_off);
    }
}

#[test]
fn changes_without_lubrication_are_those_of_the_host() {
    DisplacedCase::new(sheared, Precision::Double, None).agree(TIGHT, ROUND_OFF);
    DisplacedCase::new(sheared, Precision::Single, None).agree(CHANGE, ROUND_OFF_SINGLE);
}

#[test]
fn changes_at_walls_and_in_the_open_are_those_of_the_host() {
    let range = Some(LubricationRange::default());
    DisplacedCase::new(bounded(Boundaries::Walls), Precision::Double, range).agree(TIGHT, ROUND_OFF);
    DisplacedCase::new(bounded(Boundaries::Wall), Precision::Single, range).agree(CHANGE, ROUND_OFF_SINGLE);
    DisplacedCase::new(bounded(Boundaries::Walls), Precision::Double, None).agree(TIGHT, ROUND_OFF);
    DisplacedCase::new(bounded(Boundaries::Open), Precision::Double, range).agree(TIGHT, ROUND_OFF);
}

/// Shuffled threads and blocks; loads of near pairs in the background of a solve before do not matter.
#[test]
fn any_order_of_threads_gives_the_same_changes() {
    let case = DisplacedCase::new(sheared, Precision::Single, Some(LubricationRange::default()));
    let (drawn, none, Suspension { cell, particles, .. }) = (case.exact().drawn(), Loads::default(), &case.suspension);
    let [first, mut used] = [1, 2].map(|seed| case.on(emulator(seed)));
    used.solve(cell, particles, &acting(&none, SHEAR), Guess::default()).unwrap();
    let [first, second] = [first, used].map(|solver| case.response(solver, &drawn, CHANGE));
    assert_eq!(first, second);
}

/// Drift and Brownian stresslets from columns of the particles, between walls, where the divergence of the mobility is
/// added to the motion of the fluid: those of the host to the error of the finite difference.
#[test]
fn drift_is_that_of_the_host() {
    let case = DisplacedCase::new(bounded(Boundaries::Walls), Precision::Single, Some(LubricationRange::default()));
    let exact = case.exact();
    let RandomSolution { fluid, loads, .. } = exact.drawn();
    let drift = |case: &DisplacedCase, mut solver: CoupledSolver, tolerance: f64| {
        let Suspension { cell, mut particles, .. } = case.exact().suspension;
        brownian::set_ambient(&mut particles, &fluid, 1.0);
        brownian::displace(&mut particles, TIME);
        brownian::solve(&mut solver, &cell, &mut particles, &loads, &fluid).unwrap();
        particles.displace_by([DISPLACEMENT], [1.0]);
        particles.wrap(&cell);
        let change = FiniteDifference { over: TIME, energy: 1.0, tolerance };
        brownian::store_drift(&mut solver, &cell, &mut particles, change).unwrap();
        let (motion, stresslets) = brownian::drift(&mut particles);
        [vectors(&motion.velocities), vectors(&motion.angular_velocities), tensors(&stresslets)]
    };
    let expected = drift(&exact, exact.on_host(), EXACT);
    for (found, expected) in drift(&case, case.on(emulator(4)), CHANGE).iter().zip(&expected) {
        let error = relative(found, expected);
        assert!(error < 3.0 * CHANGE, "{error:e}");
    }
}

/// Known loads, motions and first moments are copied to the card, ambient motions and positions too for a change;
/// motions, first moments and, from the first evaluation, rates of strain come back. More iterations copy a few numbers
/// each. The memory is that of a solve.
#[test]
fn iterations_for_changes_stay_on_the_device() {
    let case = DisplacedCase::new(sheared, Precision::Single, Some(LubricationRange::default()));
    let (drawn, spheres) = (case.exact().drawn(), case.suspension.particles.len() as u64);
    let copied = |tolerance: f64| {
        let (device, counts) = Counted::new(emulator(5));
        let mut solver = case.on(Box::new(device));
        let RandomSolution { fluid, loads, .. } = &drawn;
        let input = SolveInput { ambient: fluid, ..acting(loads, SHEAR) };
        let Suspension { cell, particles, .. } = &case.suspension;
        solver.solve(cell, particles, &input, Guess::induced_by(fluid)).unwrap();
        let before = counts.borrow().clone();
        let iterations = case.response(solver, &drawn, tolerance).iterations;
        let after = counts.borrow();
        assert_eq!(after.memory[1], before.memory[1], "memory besides that of a solve");
        assert_eq!(after.runs["coupled_image_f32"] - before.runs["coupled_image_f32"], iterations + 2);
        let since = |[after, before]: [[u64; 2]; 2]| [0, 1].map(|k| after[k] - before[k]);
        let copies = [[after.uploads, before.uploads], [after.downloads, before.downloads]].map(since);
        (iterations, copies)
    };
    let [(rough, few), (fine, many)] = [1e-1, 1e-3].map(copied);
    assert!(fine > rough + 1, "{rough} {fine}");
    for ([few, few_bytes], [many, many_bytes]) in few.into_iter().zip(many) {
        let (copies, bytes) = (many - few, many_bytes - few_bytes);
        assert!(copies > 0 && bytes <= 13 * 8 * copies, "{copies} copies of {bytes} bytes");
    }
    let [[up, to_card], [down, from_card]] = few;
    let [lists, state] = [[136 + 224, 2 * 128].map(|bytes| bytes * spheres), [up, down].map(|copies| 13 * 8 * copies)];
    let with_positions = lists[0] + 24 * spheres + state[0];
    assert!((lists[0]..=with_positions).contains(&to_card), "{to_card} bytes to the card");
    assert!((lists[1]..=lists[1] + state[1]).contains(&from_card), "{from_card} bytes from the card");
}
