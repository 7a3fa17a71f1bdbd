//! Random motions and the divergence of the mobility in boxes that are not periodic along all axes.

use crate::common::Suspension;
use domain::{Boundaries, Comm, Partition, PeriodicBox, Random, Traceless, Vector};
use fcm::{Loads, Mobility, Motion, Multipoles, Output, Plan, Problem, Stream};

fn cell(edges: [f64; 3], boundaries: Boundaries) -> PeriodicBox {
    PeriodicBox::new(Vector::from_array(edges)).unwrap().with_boundaries(boundaries).unwrap()
}

/// Up to `count` spheres of radii 1 and 1.4, all at different heights.
fn spheres(boundaries: Boundaries, count: usize) -> Suspension {
    let cell = cell([9.0, 11.0, 8.0], boundaries);
    let (edges, mut random) = (cell.edges(), Random::new(5, 1));
    let mut suspension = Suspension { cell, viscosity: 1.3, positions: Vec::new(), radii: Vec::new() };
    while suspension.radii.len() < count {
        let radius = if suspension.radii.len().is_multiple_of(2) { 1.0 } else { 1.4 };
        let place = random.point();
        let z = 1.02 * radius + place.z * (edges.z - 2.04 * radius);
        let position = Vector::new(place.x * edges.x, place.y * edges.y, z);
        let is_free = |(other, a): (&Vector, &f64)| {
            let mut x = position - *other;
            (0..2).for_each(|axis| x[axis] -= edges[axis] * (x[axis] / edges[axis]).round());
            x.length() > 1.01 * (a + radius)
        };
        if suspension.positions.iter().zip(&suspension.radii).all(is_free) {
            suspension.positions.push(position);
            suspension.radii.push(radius);
        }
    }
    suspension
}

fn mobility(suspension: &Suspension, multipoles: Multipoles, tolerance: f64) -> Mobility {
    let plan = Plan::choose(&Problem { multipoles, ..suspension.problem(tolerance) }).unwrap();
    let mut mobility = Mobility::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    mobility.arrange(&suspension.cell, &suspension.particles());
    mobility
}

/// Along loads of any kind the variance of draws is that of the mobility: within 4.5 standard errors of 300 draws.
#[test]
#[ignore = "heavy"]
fn draws_have_the_covariance_of_the_mobility() {
    let cases = [
        (Boundaries::Walls, Multipoles::Monopole),
        (Boundaries::Walls, Multipoles::Dipole),
        (Boundaries::OpenAlongZ, Multipoles::Dipole),
        (Boundaries::Open, Multipoles::Dipole),
    ];
    for (boundaries, multipoles) in cases {
        let suspension = spheres(boundaries, 10);
        let mut mobility = mobility(&suspension, multipoles, 1e-3);
        let mut directions: Vec<Loads> = (0..8).map(|seed| suspension.loads(seed)).collect();
        for (sphere, loads) in directions.iter_mut().take(4).enumerate() {
            for other in (0..10).filter(|&other| other != sphere) {
                (loads.forces[other], loads.torques[other]) = (Vector::ZERO, Vector::ZERO);
                loads.stresslets[other] = Traceless::ZERO;
            }
        }
        let mut wanted = Output::All;
        if multipoles == Multipoles::Monopole {
            wanted = Output::Velocities;
            for loads in &mut directions {
                (loads.torques, loads.stresslets) = (Vec::new(), Vec::new());
            }
        }
        let variances: Vec<f64> = directions.iter().map(|loads| mobility.apply(loads, wanted).power(loads)).collect();
        let (draws, ids) = (300, (0..10).collect::<Vec<_>>());
        let mut squares = vec![0.0; directions.len()];
        let mut most = 0;
        for number in 0..draws {
            let (motion, drawn) = mobility.noise(&ids, 1e-3, Stream::new(7, number));
            assert!(drawn.clipped == 0.0 && drawn.change <= 1e-3, "{boundaries:?}: {drawn:?}");
            assert_eq!(motion.strain_rates.is_empty(), multipoles == Multipoles::Monopole);
            most = most.max(drawn.iterations);
            squares.iter_mut().zip(&directions).for_each(|(sum, loads)| *sum += motion.power(loads).powi(2));
        }
        println!("{boundaries:?} {multipoles:?}: {most} iterations");
        let error = (2.0 / draws as f64).sqrt();
        for (square, variance) in squares.iter().zip(&variances) {
            let off = (square / draws as f64 / variance - 1.0) / error;
            assert!(off.abs() < 4.5, "{boundaries:?} {multipoles:?}: {off} errors");
        }
    }
}

/// Divergence of the whole mobility by central differences: the motion of each sphere under unit forces along each
/// axis, displaced along that axis. Only a sphere's own part remains in the sum over all spheres.
fn by_differences(suspension: &Suspension, tolerance: f64) -> Vec<[f64; 11]> {
    const STEP: f64 = 0.005;
    let mut mobility = mobility(suspension, Multipoles::Dipole, tolerance);
    let count = suspension.radii.len();
    let mut sums = vec![[0.0; 11]; count];
    for (sphere, axis) in (0..count).flat_map(|sphere| (0..3).map(move |axis| (sphere, axis))) {
        for sign in [1.0, -1.0] {
            let mut particles = suspension.particles();
            particles.positions[sphere][axis] += sign * STEP;
            particles.wrap(&suspension.cell);
            mobility.arrange(&suspension.cell, &particles);
            let mut forces = vec![Vector::ZERO; count];
            forces[sphere][axis] = sign / (2.0 * STEP);
            let motion = mobility.apply(&Loads { forces, ..Loads::default() }, Output::All);
            sums.iter_mut().zip(components(&motion)).for_each(|(sum, components)| {
                sum.iter_mut().zip(components).for_each(|(sum, component)| *sum += component);
            });
        }
    }
    sums
}

fn components(motion: &Motion) -> Vec<[f64; 11]> {
    let of_row = |row: usize| {
        let mut components = [0.0; 11];
        components[..3].copy_from_slice(&motion.velocities[row].to_array());
        components[3..6].copy_from_slice(&motion.angular_velocities[row].to_array());
        components[6..].copy_from_slice(&motion.strain_rates[row].0);
        components
    };
    (0..motion.velocities.len()).map(of_row).collect()
}

/// For spheres between walls and above one, in a box with different edges: within a thousandth of the largest value,
/// the accuracy of the differences.
#[test]
fn the_divergence_is_that_by_differences() {
    for boundaries in [Boundaries::Walls, Boundaries::Wall] {
        let suspension = spheres(boundaries, 5);
        let exact = by_differences(&suspension, 1e-9);
        let mut mobility = mobility(&suspension, Multipoles::Dipole, 1e-3);
        let found = components(&mobility.divergence_at_walls(&suspension.cell, &suspension.particles()).unwrap());
        let largest = |range: std::ops::Range<usize>| {
            exact.iter().flat_map(|row| &row[range.clone()]).fold(0.0, |most: f64, x| most.max(x.abs()))
        };
        for (range, size) in [(0..3, largest(0..3)), (3..11, largest(6..11))] {
            assert!(size > 3e-4, "{boundaries:?}: {size}");
            for (found, exact) in found.iter().zip(&exact) {
                for (found, exact) in found[range.clone()].iter().zip(&exact[range.clone()]) {
                    assert!((found - exact).abs() < 1e-3 * size, "{boundaries:?}: {found} is not {exact}, of {size}");
                }
            }
        }
    }
}

/// Without walls there is no divergence, since nothing depends on the position of a single sphere.
#[test]
fn without_walls_there_is_no_divergence() {
    for boundaries in [Boundaries::OpenAlongZ, Boundaries::Open, Boundaries::Periodic] {
        let suspension = Suspension { cell: cell([9.0, 11.0, 8.0], boundaries), ..spheres(Boundaries::Wall, 3) };
        let mut mobility = mobility(&suspension, Multipoles::Dipole, 1e-2);
        assert!(mobility.divergence_at_walls(&suspension.cell, &suspension.particles()).is_none());
    }
}
