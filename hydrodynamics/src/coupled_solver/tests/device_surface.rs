//! Forces between surfaces that the kernels of a card add up, against those of the host.

use super::device_pairs::tilted;
use super::on_device::{Suspension, columns, emulator, relative};
use super::*;
use crate::pairs::surface_laws::TakenForce;
use domain::Boundaries;
use fcm::{Mobility, StressletSolver};
use gpu::{Counted, Device, DeviceCounts};
use lubrication::{Barrier, PairKind, SurfaceForce};

/// A force of each kind; the first screened repulsion reaches images of its own sphere.
fn forces() -> [SurfaceForce; 6] {
    let barrier = |range, power| SurfaceForce::Barrier(Barrier::new(3.0, range).unwrap().growing(power));
    [
        barrier(0.4, 0),
        barrier(1.0, 2),
        SurfaceForce::Screened { strength: 5.0, radius_power: 1, length: 0.5 },
        SurfaceForce::Screened { strength: 2.0, radius_power: 2, length: 0.02 },
        SurfaceForce::VanDerWaals { hamaker: 0.6, closest: 0.01, range: 0.5 },
        SurfaceForce::Depletion { pressure: 2.0, thickness: 0.4 },
    ]
}

/// Explicit forces.
fn taken(forces: &[SurfaceForce]) -> Vec<TakenForce> {
    forces.iter().map(|&force| TakenForce { force, is_implicit: false }).collect()
}

impl Suspension {
    /// The same with a pair that overlaps.
    fn pressed(mut self) -> Self {
        let [first, second] = [0, 1].map(|row| self.particles.positions[row]);
        self.particles.positions[1] -= self.cell.nearest_image(second - first) * 0.03;
        self
    }

    /// Sums of forces over all images of all pairs.
    fn surface_forces(&self, forces: &[SurfaceForce]) -> Vec<Vector> {
        let Self { cell, particles, .. } = self;
        let images = (0..1331).map(|k| [k % 11 - 5, k / 11 % 11 - 5, k / 121 - 5]);
        let images: Vec<[i32; 3]> =
            images.filter(|steps| (0..3).all(|axis| steps[axis] == 0 || cell.is_periodic(axis))).collect();
        let of_row = |row: usize| {
            let of_pair = |other: usize, steps: &[i32; 3]| {
                let separation = particles.positions[other] + cell.lattice(*steps) - particles.positions[row];
                let between = PairKind::Spheres([row, other].map(|row| particles.radii[row]));
                let is_itself = row == other && *steps == [0; 3];
                forces.iter().filter(|_| !is_itself).map(|force| force.force(separation, between)).sum::<Vector>()
            };
            let rows = 0..particles.len();
            rows.flat_map(|other| images.iter().map(move |steps| of_pair(other, steps))).sum::<Vector>()
        };
        (0..particles.len()).map(of_row).collect()
    }

    /// A solver without lubrication.
    fn without_lubrication(&self, device: Option<Box<dyn Device>>) -> CoupledSolver {
        let far = match device {
            Some(device) => StressletSolver::of(Mobility::on(device, &self.plan, &self.partition()), &Comm::alone()),
            None => StressletSolver::new(&self.plan, &self.partition()),
        };
        CoupledSolver::of(far, &self.partition(), ShortRange::default()).unwrap()
    }
}

fn sheared(edge: f64) -> PeriodicBox {
    PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap()
}

fn bounded(boundaries: Boundaries) -> impl Fn(f64) -> PeriodicBox {
    move |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(boundaries).unwrap()
}

fn numbers(vectors: &[Vector]) -> Vec<f64> {
    vectors.iter().flat_map(Vector::to_array).collect()
}

/// One by one and together, of spheres of two sizes, one pair of which overlaps.
#[test]
fn forces_are_those_of_all_images() {
    let all = forces();
    let shapes: [&dyn Fn(f64) -> PeriodicBox; 4] =
        [&sheared, &tilted, &bounded(Boundaries::Walls), &bounded(Boundaries::Open)];
    for (shape, precision) in shapes.into_iter().zip([Precision::Single, Precision::Double].into_iter().cycle()) {
        let suspension = Suspension::within(shape, precision, 1e-2).pressed();
        let mut solver = suspension.on(emulator(3));
        for forces in all.chunks(1).chain([&all[..]]) {
            assert!(solver.take_surface_forces(&taken(forces)));
            let (none, Suspension { cell, particles, .. }) = (Loads::default(), &suspension);
            let input = SolveInput { surface_forces: true, ..acting(&none, Traceless::ZERO) };
            let found = solver.with_surface_forces(cell, particles, &input).unwrap().forces;
            let exact = suspension.surface_forces(forces);
            assert!(exact.iter().any(|force| force.length() > 0.1), "{forces:?}");
            let error = relative(&numbers(&found), &numbers(&exact));
            assert!(error < 1e-11, "{precision:?}, {:?}, {forces:?}: {error:e}", cell.boundaries());
        }
    }
}

/// Solutions with forces that the device adds are those of the host with these forces among its loads: with
/// lubrication where the near pairs are assembled, between walls, where the host iterates, and without lubrication.
#[test]
fn solutions_have_the_forces_of_the_host() {
    let forces = &forces()[..4];
    let walls = bounded(Boundaries::Walls);
    let cases: [(&dyn Fn(f64) -> PeriodicBox, bool); 3] = [(&sheared, true), (&walls, true), (&sheared, false)];
    for (shape, is_lubricated) in cases {
        let suspension = Suspension::within(shape, Precision::Double, 1e-7);
        let Suspension { cell, particles, .. } = &suspension;
        let weights = vec![Vector::new(0.0, 0.1, -0.3); particles.len()];
        let by_pairs = suspension.surface_forces(forces);
        let total = by_pairs.iter().zip(&weights).map(|(&force, &weight)| force + weight);
        let [weights, total] = [weights.clone(), total.collect()].map(|forces| Loads { forces, ..Loads::default() });
        let strain = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
        let [mut on_card, mut on_host] = if is_lubricated {
            [suspension.on(emulator(4)), suspension.on_host()]
        } else {
            [Some(emulator(4)), None].map(|device| suspension.without_lubrication(device))
        };
        assert!(on_card.take_surface_forces(&taken(forces)) && !on_host.take_surface_forces(&taken(forces)));
        let input = SolveInput { surface_forces: true, ..acting(&weights, strain) };
        let found = on_card.solve(cell, particles, &input, Guess::default()).unwrap();
        let exact = on_host.solve(cell, particles, &acting(&total, strain), Guess::default()).unwrap();
        for (found, exact) in columns(&found).iter().zip(&columns(&exact)).filter(|(_, exact)| !exact.is_empty()) {
            let error = relative(found, exact);
            assert!(error < 3e-6, "{:?}, {is_lubricated}: {error:e}", cell.boundaries());
        }
    }
}

/// Spheres out of reach of lubrication, which repel each other nevertheless.
#[test]
fn spheres_without_near_pairs_have_forces() {
    let suspension =
        Suspension::of(2, |edge| PeriodicBox::new(Vector::splat(2.0 * edge)).unwrap(), Precision::Double, 1e-7);
    let Suspension { cell, mut particles, plan } = suspension;
    particles.positions[1] = particles.positions[0] + Vector::X * 3.4;
    particles.wrap(&cell);
    let suspension = Suspension { cell, particles, plan };
    let forces = &[SurfaceForce::Screened { strength: 5.0, radius_power: 0, length: 0.5 }];
    let near = ShortRange { lubrication: Some(LubricationRange::new(0.2, 1e-4).unwrap()), springs: None };
    let far = StressletSolver::of(Mobility::on(emulator(2), &suspension.plan, &suspension.partition()), &Comm::alone());
    let mut solver = CoupledSolver::of(far, &suspension.partition(), near).unwrap();
    assert!(solver.take_surface_forces(&taken(forces)));
    let none = Loads::default();
    let input = SolveInput { surface_forces: true, ..acting(&none, Traceless::ZERO) };
    let found = solver.solve(&suspension.cell, &suspension.particles, &input, Guess::default()).unwrap();
    let exact = suspension.surface_forces(forces);
    assert!(exact[0].length() > 0.1 && relative(&numbers(&found.far.forces), &numbers(&exact)) < 1e-11);
}

/// Forces are added where the loads of near pairs are: to find the pairs at new positions takes one more run of a
/// kernel, and no more copies once the laws are there.
#[test]
fn forces_are_not_copied() {
    let mut suspension = Suspension::within(sheared, Precision::Single, 1e-2);
    let (device, counts) = Counted::new(emulator(5));
    let mut solver = suspension.on(Box::new(device));
    assert!(solver.take_surface_forces(&taken(&forces()[..2])));
    let none = Loads::default();
    let mut counted = |surface_forces| {
        suspension.particles.positions[0].x += 1e-9;
        let (Suspension { cell, particles, .. }, before) = (&suspension, counts.borrow().clone());
        let input = SolveInput { surface_forces, ..acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
        let own = crate::units::particles(particles, &solver.units);
        solver.pairs_of_solve(cell, [particles, &own], &input);
        let after = counts.borrow().clone();
        let runs = |counts: &DeviceCounts| counts.runs.get("surface_forces_f32").copied().unwrap_or(0);
        let copies = [after.uploads[0] - before.uploads[0], after.downloads[0] - before.downloads[0]];
        (runs(&after) - runs(&before), after.launches - before.launches, copies)
    };
    // The first run copies the laws, the next ones record commands.
    for _ in 0..3 {
        counted(true);
    }
    let [(none, fewer, copies), (one, more, no_more)] = [false, true].map(&mut counted);
    assert_eq!((none, one, more - fewer, no_more), (0, 1, 1, copies));
}
