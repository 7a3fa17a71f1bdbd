//! Random loads of near pairs and Brownian steps by the kernels of a card, against those of the host.

use super::device_pairs::tilted;
use super::on_device::{Suspension, columns, emulator, relative};
use super::*;
use domain::{Boundaries, Random};
use fcm::Stream;

impl Suspension {
    /// The same with ids in another order, steps across the faces of the box that spheres have made, a pair that
    /// overlaps, and a sphere on a face of the box.
    fn travelled(mut self) -> Self {
        let particles = &mut self.particles;
        Random::new(5, 0).shuffle(&mut particles.ids);
        for (row, steps) in particles.steps.iter_mut().enumerate() {
            *steps = [row as i32 % 3 - 1, 40 - row as i32, (row as i32 % 2) * 7];
        }
        let along = self.cell.nearest_image(particles.positions[1] - particles.positions[0]);
        particles.positions[1] -= along * 0.03;
        if self.cell.is_periodic(0) {
            particles.positions[0].x = 0.0;
        }
        self
    }

    fn pair_noise(&self, mut solver: CoupledSolver, draw: u64) -> Loads {
        solver.pair_noise(&self.cell, &self.particles, None, Stream::new(11, draw))
    }
}

fn numbers(loads: &Loads) -> [Vec<f64>; 2] {
    [&loads.forces, &loads.torques].map(|list| list.iter().flat_map(Vector::to_array).collect())
}

fn sheared(edge: f64) -> PeriodicBox {
    PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap()
}

fn bounded(boundaries: Boundaries) -> impl Fn(f64) -> PeriodicBox {
    move |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(boundaries).unwrap()
}

/// By the same numbers, in both precisions to round-off, in boxes of all shapes, one of them so small that spheres are
/// near their own images.
#[test]
fn random_loads_are_those_of_the_host() {
    let shapes: [(usize, &dyn Fn(f64) -> PeriodicBox); 5] = [
        (16, &sheared),
        (3, &sheared),
        (16, &tilted),
        (16, &bounded(Boundaries::Walls)),
        (16, &bounded(Boundaries::Open)),
    ];
    for ((spheres, shape), precision) in shapes.into_iter().zip([Precision::Single, Precision::Double].iter().cycle()) {
        let suspension = Suspension::of(spheres, shape, *precision, 1e-2).travelled();
        let first = suspension.pair_noise(suspension.on(emulator(6)), 0);
        for (found, exact) in numbers(&first).iter().zip(numbers(&suspension.pair_noise(suspension.on_host(), 0))) {
            let error = relative(found, &exact);
            assert!(error < 1e-10, "{spheres} spheres, {:?}: {error:e}", suspension.cell.boundaries());
        }
        assert_eq!(first, suspension.pair_noise(suspension.on(emulator(7)), 0), "in another order of threads");
        assert_ne!(first, suspension.pair_noise(suspension.on(emulator(6)), 1), "in another draw");
    }
}

/// Motions in a fluctuating fluid under the random loads of near pairs.
#[test]
fn brownian_steps_are_those_of_the_host() {
    let suspension = Suspension::within(sheared, Precision::Double, 1e-7).travelled();
    let Suspension { cell, particles, .. } = &suspension;
    let step = |mut solver: CoupledSolver| {
        let stream = Stream::new(2, 3);
        let (fluid, drawn) = solver.noise(cell, particles, 1e-3, stream);
        let loads = solver.pair_noise(cell, particles, None, stream);
        let input = SolveInput { ambient: &fluid, ..acting(&loads, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
        (solver.solve(cell, particles, &input, Guess::induced_by(&fluid)).unwrap(), drawn.iterations)
    };
    let [(found, steps), (exact, expected)] = [suspension.on(emulator(8)), suspension.on_host()].map(step);
    assert_eq!(steps, expected);
    for (found, exact) in columns(&found).iter().zip(&columns(&exact)) {
        assert!(relative(found, exact) < 1e-6, "{:e}", relative(found, exact));
    }
}
