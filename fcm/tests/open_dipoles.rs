//! Fields of magnetic or electric moments in open space, against direct sums.

use crate::common::{MagnetisedSpheres, Suspension, error, vectors};
use crate::dipoles::on_ranks;
use domain::{Boundaries, PeriodicBox, Tensor, Vector};
use fcm::{DipoleField, DipoleProblem, DipoleSolution, Magnetisation, Plan};
use std::f64::consts::PI;

/// Random spheres in a box of the given edge, which is open.
fn cluster(edge: f64, count: usize, ratio: f64, seed: u64) -> (PeriodicBox, MagnetisedSpheres) {
    let cell = PeriodicBox::new(Vector::new(edge, 1.3 * edge, 0.9 * edge)).unwrap();
    let spheres = MagnetisedSpheres::random(count, ratio, &cell, seed);
    (cell.with_boundaries(Boundaries::Open).unwrap(), spheres)
}

fn plan(cell: &PeriodicBox, spheres: &MagnetisedSpheres, tolerance: f64) -> Plan {
    let (positions, radii) = (spheres.positions.clone(), spheres.radii.clone());
    let suspension = Suspension { cell: *cell, viscosity: 1.0, positions, radii };
    DipoleField::plan(&suspension.problem(tolerance)).unwrap()
}

/// Permanent moments alone.
fn permanent(
    cell: &PeriodicBox,
    spheres: &MagnetisedSpheres,
    tolerance: f64,
    ranks: usize,
) -> (DipoleSolution, Vec<Tensor>) {
    let none = vec![0.0; spheres.radii.len()];
    let problem = DipoleProblem {
        field: Vector::ZERO,
        permanent: &spheres.moments,
        polarisabilities: &none,
        saturations: &[],
        guess: &[],
    };
    on_ranks(ranks, cell, spheres, &plan(cell, spheres, tolerance), &problem)
}

/// Field and gradient of a point at a distance `x`.
fn of_point(x: Vector, moment: Vector) -> (Vector, Tensor) {
    let r = x.length();
    let (unit, along) = (1.0 / (4.0 * PI * r.powi(5)), x.dot(moment));
    let column = |c: usize| {
        let delta = Vector::AXES[c] * along;
        (moment * x[c] + x * moment[c] + delta - x * (5.0 * x[c] * along / (r * r))) * (3.0 * unit)
    };
    ((x * (3.0 * along) - moment * (r * r)) * unit, Tensor::from_cols(column(0), column(1), column(2)))
}

/// Fields and gradients by direct sums.
fn direct(spheres: &MagnetisedSpheres) -> Vec<(Vector, Tensor)> {
    let count = spheres.radii.len();
    let of_one = |row: usize| {
        let own = -spheres.moments[row] / (4.0 * PI * spheres.radii[row].powi(3));
        (0..count).filter(|&other| other != row).fold((own, Tensor::ZERO), |(field, gradient), other| {
            let x = spheres.positions[row] - spheres.positions[other];
            let (more, slope) = of_point(x, spheres.moments[other]);
            (field + more, gradient + slope)
        })
    };
    (0..count).map(of_one).collect()
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|value| value * value).sum::<f64>().sqrt()
}

#[test]
fn fields_are_those_of_direct_sums() {
    for (edge, count, ratio) in [(9.0, 14, 1.0), (11.0, 10, 2.0), (40.0, 30, 1.0)] {
        let (cell, spheres) = cluster(edge, count, ratio, 5);
        let exact = direct(&spheres);
        for tolerance in [1e-2, 1e-4, 1e-6, 1e-9] {
            let (found, _) = permanent(&cell, &spheres, tolerance, 1);
            let own = |power: i32| {
                norm((0..count).map(|r| spheres.moments[r].length() / (4.0 * PI * spheres.radii[r].powi(power))))
            };
            let field = norm((0..count).map(|r| (found.fields[r] - exact[r].0).length())) / own(3);
            let entries = |r: usize| (found.gradients[r] - exact[r].1).to_cols_array();
            let gradient = norm((0..count).flat_map(entries)) / own(4);
            println!("{edge} {tolerance:e} {:.2} {:.2}", field / tolerance, gradient / tolerance);
            assert!(field < tolerance && gradient < tolerance, "{field} and {gradient} at {tolerance:e}");
        }
    }
}

/// Two spheres that touch in line attract each other as points do, by `3 m^2 / (2 pi r^4)`, and the rest of the box
/// does not matter.
#[test]
fn touching_spheres_have_the_forces_of_points() {
    let cell = PeriodicBox::new(Vector::new(6.0, 3.0, 3.0)).unwrap().with_boundaries(Boundaries::Open).unwrap();
    for distance in [2.0001, 2.1, 3.0] {
        let positions = vec![Vector::new(1.3, 1.5, 1.5), Vector::new(1.3 + distance, 1.5, 1.5)];
        let moments = vec![Vector::X * 5.0; 2];
        let pair = MagnetisedSpheres { lattice: cell.lattice_vectors(), positions, radii: vec![1.0; 2], moments };
        let (found, _) = permanent(&cell, &pair, 1e-8, 1);
        let exact = 3.0 * 25.0 / (2.0 * PI * distance.powi(4));
        for (row, sign) in [(0, 1.0), (1, -1.0)] {
            assert!((found.force(row) - Vector::X * (sign * exact)).length() < 1e-6 * exact, "{distance}");
        }
    }
}

/// Positions in another place, on other ranks.
#[test]
fn places_and_ranks_do_not_matter() {
    let (cell, spheres) = cluster(9.0, 14, 1.4, 8);
    let (alone, tensors) = permanent(&cell, &spheres, 1e-7, 1);
    let shift = Vector::new(1000.0, -37.5, 3.0);
    let there = cell.with_extent(cell.origin() + shift, cell.edges()).unwrap();
    let moved =
        MagnetisedSpheres { positions: spheres.positions.iter().map(|x| *x + shift).collect(), ..spheres.clone() };
    let sum = |tensors: &[Tensor]| tensors.iter().fold(Tensor::ZERO, |sum, tensor| sum + *tensor).to_cols_array();
    for (found, others) in
        [permanent(&there, &moved, 1e-7, 1), permanent(&cell, &spheres, 1e-7, 2), permanent(&cell, &spheres, 1e-7, 3)]
    {
        assert!(error(&vectors(&found.fields), &vectors(&alone.fields)) < 1e-10);
        let entries = |list: &[Tensor]| list.iter().flat_map(Tensor::to_cols_array).collect::<Vec<_>>();
        assert!(error(&entries(&found.gradients), &entries(&alone.gradients)) < 1e-9);
        assert!(error(&sum(&others), &sum(&tensors)) < 1e-7);
    }
}

/// The first moment of the forces, `-sum x F` for forces that add up to zero.
#[test]
fn first_moments_are_those_of_the_forces() {
    let (cell, spheres) = cluster(8.0, 8, 1.5, 2);
    let (_, tensors) = permanent(&cell, &spheres, 1e-8, 1);
    let sum = tensors.iter().fold(Tensor::ZERO, |sum, tensor| sum + *tensor);
    let of_one = |(row, (_, gradient)): (usize, &(Vector, Tensor))| {
        let (force, x) = (*gradient * spheres.moments[row], spheres.positions[row]);
        Tensor::from_cols(force * -x.x, force * -x.y, force * -x.z)
    };
    let exact = direct(&spheres).iter().enumerate().map(of_one).fold(Tensor::ZERO, |sum, tensor| sum + tensor);
    assert!(error(&sum.to_cols_array(), &exact.to_cols_array()) < 1e-6, "{sum} and {exact}");
}

/// Induced moments solve their equations, here those of direct sums.
#[test]
fn induced_moments_are_along_the_field() {
    let (cell, spheres) = cluster(8.0, 12, 1.5, 4);
    let alphas: Vec<f64> = spheres.radii.iter().map(|a| 20.0 * a.powi(3)).collect();
    let (permanent, field) = (vec![Vector::ZERO; 12], Vector::new(1.0, 0.3, -0.4));
    let problem =
        DipoleProblem { field, permanent: &permanent, polarisabilities: &alphas, saturations: &[], guess: &[] };
    let (found, _) = on_ranks(1, &cell, &spheres, &plan(&cell, &spheres, 1e-6), &problem);
    let fields = direct(&MagnetisedSpheres { moments: found.moments.clone(), ..spheres.clone() });
    let by_field: Vec<Vector> = (0..12).map(|r| (field + fields[r].0) * alphas[r]).collect();
    assert!(error(&vectors(&found.moments), &vectors(&by_field)) < 1e-5);
}

/// The moments of spheres that saturate are those of their law in the fields of direct sums, from weak fields to strong
/// ones, whatever the guess.
#[test]
fn moments_saturate_by_their_law() {
    let (cell, spheres) = cluster(8.0, 12, 1.5, 4);
    let volumes: Vec<f64> = spheres.radii.iter().map(|a| 4.0 / 3.0 * PI * a.powi(3)).collect();
    let largest: Vec<f64> = volumes.iter().map(|volume| 2.0 * volume).collect();
    let (permanent, plan) = (vec![Vector::ZERO; 12], plan(&cell, &spheres, 1e-6));
    for (chi, size) in [(5.0, 0.1), (5.0, 3.0), (1000.0, 0.01), (1000.0, 0.6), (1000.0, 40.0)] {
        let field = Vector::new(0.8, 0.0, -0.6) * size;
        let polarisabilities: Vec<f64> = volumes.iter().map(|volume| chi * volume).collect();
        for guess in [vec![], vec![Vector::new(0.1, 20.0, 3.0); 12]] {
            let problem = DipoleProblem {
                field,
                permanent: &permanent,
                polarisabilities: &polarisabilities,
                saturations: &largest,
                guess: &guess,
            };
            let (found, _) = on_ranks(1, &cell, &spheres, &plan, &problem);
            let fields = direct(&MagnetisedSpheres { moments: found.moments.clone(), ..spheres.clone() });
            let by_law = |row: usize| {
                let law = Magnetisation { polarisability: polarisabilities[row], saturation: largest[row] };
                law.moment(field + fields[row].0)
            };
            let by_law: Vec<Vector> = (0..12).map(by_law).collect();
            // An error of a field is larger by 1 + chi / 3 in the moment.
            let allowed = 2e-5 * (1.0 + chi / 3.0);
            assert!(error(&vectors(&found.moments), &vectors(&by_law)) < allowed, "{chi} {size}");
            assert!(found.iterations < 200, "{chi} {size}: {}", found.iterations);
        }
    }
}
