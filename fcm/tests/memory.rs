//! Predicted against measured allocations.

mod common;
#[path = "../../domain/tests/heap/mod.rs"]
mod heap;

use common::Suspension;
use domain::{Boundaries, Comm, ExpectedCounts, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Fixed, Footprint, Method, Mobility, Plan, Problem, Stream, StressletSolver};
use heap::measured;

const COUNT: usize = 3000;

#[track_caller]
fn near(share: f64, predicted: f64, found: f64) {
    assert!((predicted / found - 1.0).abs() < share, "{predicted:.3e} predicted, {found:.3e} found");
}

/// A single test function, since the allocations of concurrent tests would be counted.
#[test]
#[ignore = "heavy"]
fn predictions_are_what_is_allocated() {
    let cell = PeriodicBox::new(Vector::splat(47.0)).unwrap();
    let suspension = Suspension::random(COUNT, 1.0, cell, 1);
    let (particles, loads) = (suspension.particles(), suspension.loads(1));
    let moved = suspension.displaced(Vector::splat(3.0)).particles();
    for (method, tolerance) in [(Method::Direct, 1e-2), (Method::Split, 1e-3), (Method::Split, 1e-6)] {
        let fixed = Fixed { method: Some(method), ..Fixed::default() };
        let plan = Plan::choose(&Problem { rigid: true, fixed, ..suspension.problem(tolerance) }).unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let expected = ExpectedCounts::new(plan.edges, &[(1.0, COUNT)], partition.place());
        let footprint = Footprint::new(&plan, partition.place(), rayon::current_num_threads(), &expected);
        assert_eq!(footprint.radii(), plan.radii);
        let (mut hydrodynamics, found) = measured(|| {
            let mut hydrodynamics = StressletSolver::new(&plan, &partition);
            // The lists of the first search have no skin.
            hydrodynamics.mobility().arrange(&cell, &moved);
            hydrodynamics.mobility().arrange(&cell, &particles);
            hydrodynamics
        });
        near(0.1, footprint.mobility().kept, found.kept);
        near(0.1, footprint.mobility().most, found.most);
        let (_, found) =
            measured(|| hydrodynamics.solve(&cell, &particles, &loads, Traceless::default(), &[]).unwrap());
        near(0.2, footprint.solve().most, found.most);
        let (_, found) = measured(|| hydrodynamics.mobility().velocity_field());
        near(1e-3, footprint.velocity_field().kept, found.kept);
        assert_eq!(footprint.points() as usize, plan.grid.iter().product());
        let (_, found) = measured(|| hydrodynamics.mobility().divergence());
        assert!(found.most < 1e-2 * footprint.mobility().kept, "the divergence takes {found:?} beside the field");
    }
    boxes_that_lean();
    flow_at_points();
    dense_matrix();
}

/// A matrix and its Cholesky factor.
fn dense_matrix() {
    let suspension = Suspension::random(60, 1.0, PeriodicBox::new(Vector::splat(14.0)).unwrap(), 1);
    let plan = suspension.plan(1e-3, Fixed { method: Some(Method::Dense), ..Fixed::default() });
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let expected = ExpectedCounts::new(plan.edges, &[(1.0, 60)], partition.place());
    let footprint = Footprint::new(&plan, partition.place(), rayon::current_num_threads(), &expected);
    let particles = suspension.particles();
    let (_, found) = measured(|| {
        let mut mobility = Mobility::new(&plan, &partition);
        mobility.arrange(&suspension.cell, &particles);
        mobility.noise(&particles.ids, 1e-3, Stream::new(1, 1));
        mobility
    });
    near(0.1, footprint.mobility().kept, found.kept);
    near(0.1, footprint.mobility().most, found.most);
}

/// Between walls, where the flow is computed plane by plane.
fn flow_at_points() {
    let walls = PeriodicBox::new(Vector::new(47.0, 40.0, 30.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
    let between = PeriodicBox::new(Vector::new(47.0, 40.0, 28.0)).unwrap();
    let mut suspension = Suspension::random(COUNT, 1.0, between, 1);
    suspension.positions.iter_mut().for_each(|x| x.z += 1.0);
    suspension.cell = walls;
    for tolerance in [1e-3, 1e-6] {
        let plan = Plan::choose(&suspension.problem(tolerance)).unwrap().with_points().unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let expected = ExpectedCounts::new(plan.edges, &[(1.0, COUNT)], partition.place());
        let footprint = Footprint::new(&plan, partition.place(), rayon::current_num_threads(), &expected);
        let (particles, loads) = (suspension.particles(), suspension.loads(1));
        let (mut mobility, found) = measured(|| {
            let mut mobility = Mobility::new(&plan, &partition);
            mobility.arrange(&walls, &particles);
            mobility
        });
        near(0.1, footprint.mobility().kept, found.kept);
        let raster = plan.raster(Vector::ZERO);
        let ((), found) = measured(|| {
            let mut flow = mobility.flow(&loads, None);
            // Planes are computed one at a time: two near walls, and one that is not.
            for k in [0, raster.points[2] / 2, raster.points[2] - 1] {
                assert_eq!(flow.plane(&raster, k).len(), raster.points[0] * raster.points[1]);
            }
        });
        near(0.2, footprint.flow().most, found.most);
    }
}

/// A tilted lattice, on a grid so flat that the tables of the modes in its plane are as large as the field.
fn boxes_that_lean() {
    let vectors = [Vector::X * 60.0, Vector::new(9.0, 60.0, 0.0), Vector::new(1.1, -0.7, 5.0)];
    let cell = PeriodicBox::of_lattice(vectors).unwrap();
    let particles = Suspension::random(20, 1.0, cell, 1).particles();
    let upright = Suspension::random(20, 1.0, cell, 1).problem(1e-2);
    let fixed = Fixed { method: Some(Method::Split), grid: Some([240, 240, 10]), ..Fixed::default() };
    let plan = Plan::choose(&Problem { rigid: true, fixed, ..upright }).unwrap();
    assert!(plan.is_tilted);
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let expected = ExpectedCounts::new(plan.edges, &[(1.0, 20)], partition.place());
    let footprint = Footprint::new(&plan, partition.place(), rayon::current_num_threads(), &expected);
    let (_, found) = measured(|| {
        let mut hydrodynamics = StressletSolver::new(&plan, &partition);
        hydrodynamics.mobility().arrange(&cell, &particles);
        hydrodynamics
    });
    near(0.1, footprint.mobility().kept, found.kept);
}
