//! Spheres at walls, in gaps that no grid resolves.

use crate::common::{Suspension, error, errors, rigid_errors, solved, vectors, worst};
use domain::{Boundaries, PeriodicBox, Random, Traceless, Vector};
use fcm::{Fixed, Loads, Multipoles, Output, Plan, PlanError, Precision, Problem};
use std::f64::consts::PI;

fn cell(edges: [f64; 3], boundaries: Boundaries) -> PeriodicBox {
    PeriodicBox::new(Vector::from_array(edges)).unwrap().with_boundaries(boundaries).unwrap()
}

/// Twelve spheres of radii 1 and `ratio` alternately: eight at walls, with a gap of `gap` radii, and four at random
/// positions in between.
fn at_walls(boundaries: Boundaries, ratio: f64, gap: f64, name: u64) -> Suspension {
    let cell = cell([12.0, 12.0, 11.0], boundaries);
    let (edges, mut random) = (cell.edges(), Random::new(77, name));
    let mut suspension = Suspension { cell, viscosity: 1.0, positions: Vec::new(), radii: Vec::new() };
    while suspension.radii.len() < 12 {
        let number = suspension.radii.len();
        let radius = if number.is_multiple_of(2) { 1.0 } else { ratio };
        let (place, height) = (random.point(), (1.0 + gap) * radius);
        let z = match number {
            8.. => 1.2 * radius + place.z * (edges.z - 2.4 * radius),
            4.. if boundaries == Boundaries::Walls => edges.z - height,
            _ => height,
        };
        let position = Vector::new(place.x * edges.x, place.y * edges.y, z);
        let is_free = |(other, a): (&Vector, &f64)| {
            let mut x = position - *other;
            (0..2).for_each(|axis| x[axis] -= edges[axis] * (x[axis] / edges[axis]).round());
            x.length() > 1.02 * (a + radius)
        };
        if suspension.positions.iter().zip(&suspension.radii).all(is_free) {
            suspension.positions.push(position);
            suspension.radii.push(radius);
        }
    }
    suspension
}

/// Spheres in layers on the walls, in gaps that no grid resolves, with images in themselves and in each other: errors
/// up to two and a half times the tolerance.
#[test]
fn spheres_in_layers_on_walls_are_within_two_and_a_half_tolerances() {
    for (name, ratio) in [1.0, 1.5, 2.0].into_iter().enumerate() {
        for boundaries in [Boundaries::Wall, Boundaries::Walls] {
            let suspension = at_walls(boundaries, ratio, 0.02, name as u64);
            let loads = Loads { stresslets: Vec::new(), ..suspension.loads(name as u64) };
            let exact = solved(&suspension, &loads, 1e-8);
            for tolerance in [1e-2, 1e-3, 1e-4] {
                let errors = rigid_errors(&solved(&suspension, &loads, tolerance), &exact);
                let plan = Plan::choose(&Problem { rigid: true, ..suspension.problem(tolerance) }).unwrap();
                println!("{boundaries:?} {ratio} {tolerance:e}: {errors:?}, {}", plan.in_short());
                let allowed = 2.5 * tolerance;
                assert!(
                    errors.iter().all(|error| *error < allowed),
                    "{boundaries:?} {ratio} {tolerance:e}: {errors:?}"
                );
            }
        }
    }
}

/// One sphere at a wall against its mobility in closed form: integrals of Blake's image in Fourier space with
/// Gaussian envelopes, whose squared widths are `s` for forces and `d` for torques and stresslets (see
/// `WallBlocks::of_method` of `lubrication`). In a box of 60 radii periodic copies add 2e-4 to the mobility along the
/// wall.
#[test]
fn a_sphere_at_a_wall_has_the_mobility_in_closed_form() {
    let (s, d) = (1.0 / PI, (6.0 * PI.sqrt()).powf(-2.0 / 3.0));
    let [force, strain] = [6.0 * PI, 20.0 / 3.0 * PI].map(f64::recip);
    for gap in [0.0, 0.02, 0.1, 0.5] {
        let z: f64 = 1.0 + gap;
        let sum = |terms: &[(i32, f64)]| terms.iter().map(|&(n, factor)| factor * z.powi(-n) / PI).sum::<f64>();
        let along = force + sum(&[(1, -3.0 / 16.0), (3, s / 4.0), (5, -3.0 / 16.0 * s * s)]);
        let across = force + sum(&[(1, -3.0 / 32.0), (3, s / 16.0), (5, -3.0 / 32.0 * s * s)]);
        let stretched = strain + sum(&[(3, -3.0 / 16.0), (5, 9.0 / 8.0 * d), (7, -135.0 / 64.0 * d * d)]);
        let sheared = strain + sum(&[(3, -9.0 / 64.0), (5, 3.0 / 4.0 * d), (7, -45.0 / 32.0 * d * d)]);
        let planar = strain + sum(&[(3, -3.0 / 64.0), (5, 3.0 / 16.0 * d), (7, -45.0 / 128.0 * d * d)]);
        let spin = 1.0 / (8.0 * PI) + sum(&[(3, -1.0 / 64.0)]);
        let roll = 1.0 / (8.0 * PI) + sum(&[(3, -5.0 / 128.0)]);
        let turned = -sum(&[(4, 3.0 / 64.0 * s)]);
        let one = Suspension {
            cell: cell([60.0, 60.0, 4.0], Boundaries::Wall),
            viscosity: 1.0,
            positions: vec![Vector::new(7.3, 11.2, z)],
            radii: vec![1.0],
        };
        for tolerance in [1e-2, 1e-3] {
            let plan = Plan::choose(&Problem { rigid: true, ..one.problem(tolerance) }).unwrap();
            let mut mobility = one.mobility(&plan);
            let mut by = |loads: Loads| mobility.apply(&loads, Output::All);
            let mut by_force = |force: Vector| by(Loads { forces: vec![force], ..Loads::default() });
            let (up, aside) = (by_force(Vector::Z), by_force(Vector::X));
            let mut by_torque = |torque: Vector| by(Loads { torques: vec![torque], ..Loads::default() });
            let (spun, rolled) = (by_torque(Vector::Z), by_torque(Vector::Y));
            let mut by_stresslet = |xx: f64, xz: f64, yy: f64| {
                let stresslets = vec![Traceless([xx, 0.0, xz, yy, 0.0])];
                -by(Loads { stresslets, ..Loads::default() }).strain_rates[0].tensor()
            };
            let (stretch, shear, plane) =
                (by_stresslet(-0.5, 0.0, -0.5), by_stresslet(0.0, 1.0, 0.0), by_stresslet(1.0, 0.0, -1.0));
            for (what, found, expected, alone) in [
                ("a force along the normal", up.velocities[0].z, along, force),
                ("a force across", aside.velocities[0].x, across, force),
                ("turning by a force", aside.angular_velocities[0].y, -turned, force),
                ("a torque along the normal", spun.angular_velocities[0].z, spin, strain),
                ("a torque across", rolled.angular_velocities[0].y, roll, strain),
                ("velocity by a torque", rolled.velocities[0].x, -turned, force),
                ("strain along the normal", stretch.z_axis.z, stretched, strain),
                ("strain across", shear.x_axis.z, sheared, strain),
                ("strain in the plane", plane.x_axis.x, planar, strain),
            ] {
                let error = (found - expected) / alone;
                println!("gap {gap} {tolerance:e} {what}: {:.2} tolerances", error / tolerance);
                assert!(error.abs() < 0.8 * tolerance, "gap {gap} {tolerance:e}, {what}: {found}, not {expected}");
            }
        }
    }
}

/// A sphere that nearly fills a slit has an image in each wall; the multiple reflections are beyond the truncation of
/// the grid. Its mobility is so small that relative errors are twice as large.
#[test]
fn a_sphere_that_fills_a_slit_keeps_its_tolerance() {
    let one = Suspension {
        cell: cell([9.0, 9.0, 2.06], Boundaries::Walls),
        viscosity: 1.0,
        positions: vec![Vector::new(7.3, 1.2, 1.02)],
        radii: vec![1.0],
    };
    let loads = one.loads(4);
    let evaluate = |tolerance: f64| one.evaluate(&one.plan(tolerance, Fixed::default()), &loads);
    let exact = evaluate(1e-8);
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let found = evaluate(tolerance);
        println!("{}: {:?}", one.plan(tolerance, Fixed::default()).in_short(), errors(&found, &exact));
        assert!(worst(&found, &exact) < 2.0 * tolerance, "{tolerance:e}: {:?}", errors(&found, &exact));
    }
}

/// Images of the smallest sphere need wavenumbers for which a grid for the largest is far too coarse.
#[test]
fn radii_of_extreme_ratios_are_refused() {
    for ratio in [1e4, 1e6, 1e9] {
        let edge = 10.0 * ratio;
        let suspension = Suspension {
            cell: cell([edge; 3], Boundaries::Walls),
            viscosity: 1.0,
            positions: vec![Vector::splat(0.5 * edge), Vector::new(0.5 * edge, 0.5 * edge, 1.5)],
            radii: vec![ratio, 1.0],
        };
        let plan = Plan::choose(&suspension.problem(1e-3));
        assert!(matches!(plan, Err(PlanError::TooFine { .. })), "{ratio:e}: {plan:?}");
    }
}

/// Equal spheres that touch the wall, and almost each other, in a hexagonal layer.
fn close_packed() -> Suspension {
    let (step, height) = (2.02, 2.02 * 3.0_f64.sqrt());
    let rows = (0..2).flat_map(|row| (0..4).map(move |column| (row, column)));
    let places = rows.flat_map(|(row, column)| {
        let (x, y) = (step * f64::from(column), height * f64::from(row));
        [Vector::new(x, y, 1.0), Vector::new(x + 0.5 * step, y + 0.5 * height, 1.0)]
    });
    let positions: Vec<Vector> = places.collect();
    let cell = cell([4.0 * step, 2.0 * height, 5.0], Boundaries::Wall);
    Suspension { cell, viscosity: 1.0, radii: vec![1.0; positions.len()], positions }
}

/// For spheres in layers, also overlapping the walls as far as is allowed.
#[test]
fn the_mobility_is_symmetric_and_positive_definite() {
    let layers = [(Boundaries::Wall, -0.15), (Boundaries::Walls, -0.15), (Boundaries::Walls, 0.0)];
    let layers = layers.map(|(boundaries, gap)| at_walls(boundaries, 1.5, gap, 3));
    for suspension in layers.into_iter().chain([close_packed()]) {
        for tolerance in [1e-2, 1e-3] {
            let fixed = Fixed { precision: Some(Precision::Double), ..Fixed::default() };
            let mut mobility = suspension.mobility(&suspension.plan(tolerance, fixed));
            let size = 11 * suspension.radii.len();
            let loads: Vec<Loads> = (0..size).map(|number| suspension.unit_load(number)).collect();
            let row = |load: &Loads| {
                let motion = mobility.apply(load, Output::All);
                loads.iter().map(|load| motion.power(load)).collect()
            };
            let mut matrix: Vec<Vec<f64>> = loads.iter().map(row).collect();
            let pairs = (0..size).flat_map(|i| (0..i).map(move |j| (i, j)));
            let asymmetry = pairs.map(|(i, j)| (matrix[i][j] - matrix[j][i]).abs()).fold(0.0, f64::max);
            assert!(asymmetry < 1e-12, "{asymmetry:e}");
            let least = least_pivot(&mut matrix);
            println!("{:?} {tolerance:e}: least pivot {least:.3}", suspension.cell.boundaries());
            // Mobilities relative to those of isolated spheres.
            assert!(least > 0.02, "{least} at {tolerance:e}: {suspension:?}");
        }
    }
}

/// Unit loads, scaled by the square root of the mobility of an isolated sphere: components of its force, its torque,
/// its stresslet.
trait UnitLoad {
    fn unit_load(&self, number: usize) -> Loads;
}

impl UnitLoad for Suspension {
    fn unit_load(&self, number: usize) -> Loads {
        let (row, component, count) = (number / 11, number % 11, self.radii.len());
        let a = self.radii[row];
        let size = |resistance: f64| (resistance * PI * self.viscosity).sqrt();
        let one = |axis: usize, size: f64| {
            let mut list = vec![Vector::ZERO; count];
            list[row][axis] = size;
            list
        };
        match component {
            0..3 => Loads { forces: one(component, size(6.0 * a)), ..Loads::default() },
            3..6 => Loads { torques: one(component - 3, size(8.0 * a.powi(3))), ..Loads::default() },
            _ => {
                // An orthonormal basis.
                let (half, third) = (0.5_f64.sqrt(), 1.0 / 6.0_f64.sqrt());
                let basis = [
                    [third, 0.0, 0.0, third, 0.0],
                    [half, 0.0, 0.0, -half, 0.0],
                    [0.0, half, 0.0, 0.0, 0.0],
                    [0.0, 0.0, half, 0.0, 0.0],
                    [0.0, 0.0, 0.0, 0.0, half],
                ];
                let mut stresslets = vec![Traceless::ZERO; count];
                stresslets[row] = Traceless(basis[component - 6]) * size(20.0 / 3.0 * a.powi(3));
                Loads { stresslets, ..Loads::default() }
            }
        }
    }
}

/// Least pivot in the elimination of a symmetric matrix: positive if the matrix is positive definite.
fn least_pivot(matrix: &mut [Vec<f64>]) -> f64 {
    let mut least = f64::INFINITY;
    for n in 0..matrix.len() {
        let pivot = matrix[n].clone();
        least = least.min(pivot[n]);
        for row in &mut matrix[n + 1..] {
            let factor = row[n] / pivot[n];
            row.iter_mut().zip(&pivot).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    least
}

/// Spheres near both walls of a thin slit, or far apart in a layer: periodic copies of the grid along z are as near
/// as spheres are. With forces alone there are no pairs within a cutoff, but the Gaussians overlap all the same.
#[test]
fn forces_alone_are_no_nearer_to_copies_than_with_dipoles() {
    let centres = [
        [0.32, 4.87, 2.83],
        [5.89, 6.43, 2.83],
        [2.49, 1.14, 2.83],
        [3.91, 1.09, 1.02],
        [4.35, 4.4, 2.83],
        [2.03, 3.66, 2.83],
        [3.74, 6.42, 2.83],
    ];
    for boundaries in [Boundaries::Walls, Boundaries::Wall, Boundaries::OpenAlongZ] {
        let suspension = Suspension {
            cell: cell([6.98, 6.98, 3.856], boundaries),
            viscosity: 1.0,
            positions: centres.map(Vector::from_array).to_vec(),
            radii: vec![1.0; centres.len()],
        };
        let loads = Loads { forces: suspension.loads(3).forces, ..Loads::default() };
        let velocities = |multipoles: Multipoles, tolerance: f64| {
            let plan = Plan::choose(&Problem { multipoles, ..suspension.problem(tolerance) }).unwrap();
            vectors(&suspension.mobility(&plan).apply(&loads, Output::Velocities).velocities)
        };
        let exact = velocities(Multipoles::Dipole, 1e-9);
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let error = error(&velocities(Multipoles::Monopole, tolerance), &exact);
            assert!(error < tolerance, "{boundaries:?} at {tolerance:e}: {error:e}");
        }
    }
}
