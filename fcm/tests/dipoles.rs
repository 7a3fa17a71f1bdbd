//! Fields of magnetic or electric moments.

use crate::common::{MagnetisedSpheres, Suspension, error, vectors};
use domain::{Comm, DomainView, Particles, Partition, PeriodicBox, Tensor, Vector};
use fcm::{DipoleField, DipoleProblem, DipoleSolution, Plan};
use std::f64::consts::PI;

/// Boxes: orthogonal, sheared, and with all three lattice vectors tilted.
fn boxes(edge: f64) -> [PeriodicBox; 3] {
    let vectors = [Vector::new(1.0, 0.1, -0.05), Vector::new(0.2, 0.9, 0.1), Vector::new(-0.3, 0.15, 1.1)];
    [
        PeriodicBox::new(Vector::new(edge, 0.9 * edge, 1.2 * edge)).unwrap(),
        PeriodicBox::sheared(Vector::splat(edge), 0.4).unwrap(),
        PeriodicBox::of_lattice(vectors.map(|vector| vector * edge)).unwrap(),
    ]
}

fn store(moments: &MagnetisedSpheres) -> Particles {
    let count = moments.radii.len();
    Particles::numbered(moments.positions.clone(), moments.radii.clone(), vec![0; count])
}

fn plan(cell: &PeriodicBox, moments: &MagnetisedSpheres, tolerance: f64) -> Plan {
    let (positions, radii) = (moments.positions.clone(), moments.radii.clone());
    let suspension = Suspension { cell: *cell, viscosity: 3.0, positions, radii };
    DipoleField::plan(&suspension.problem(tolerance)).unwrap()
}

/// Entries of a list for some ids; none of an empty list.
fn own<T: Copy>(ids: &[u64], list: &[T]) -> Vec<T> {
    ids.iter().filter_map(|&id| list.get(id as usize).copied()).collect()
}

/// Solves a problem on some ranks, which own the spheres by another partition than that of the grid; results are in the
/// order of the spheres.
pub fn on_ranks(
    ranks: usize,
    cell: &PeriodicBox,
    moments: &MagnetisedSpheres,
    plan: &Plan,
    problem: &DipoleProblem,
) -> (DipoleSolution, Vec<Tensor>) {
    let parts = Comm::threads(ranks, |comm| {
        let partition = Partition::new(&comm, [6, 5]);
        let rows: Vec<usize> = (0..moments.radii.len()).filter(|r| r % comm.size() == comm.rank()).collect();
        let mut particles = store(moments).selected(&rows);
        particles.migrate(&partition, cell);
        let [polarisabilities, saturations] =
            [problem.polarisabilities, problem.saturations].map(|list| own(&particles.ids, list));
        let [permanent, guess] = [problem.permanent, problem.guess].map(|list| own(&particles.ids, list));
        let own_problem = DipoleProblem {
            permanent: &permanent,
            polarisabilities: &polarisabilities,
            saturations: &saturations,
            guess: &guess,
            ..*problem
        };
        let mut field = DipoleField::new(plan, &comm);
        let domain = DomainView { cell, partition: &partition };
        let solution = field.solve(domain, &particles, &own_problem).unwrap();
        let first_moments = field.first_moments(domain, &particles, &solution.moments);
        (particles.ids, solution, first_moments)
    });
    let count = moments.radii.len();
    let mut all = DipoleSolution {
        induced: vec![Vector::NAN; count],
        moments: vec![Vector::NAN; count],
        fields: vec![Vector::NAN; count],
        gradients: vec![Tensor::NAN; count],
        iterations: 0,
    };
    let mut tensors = vec![Tensor::NAN; count];
    for (ids, part, first_moments) in parts {
        for (row, id) in ids.into_iter().enumerate() {
            let id = id as usize;
            (all.induced[id], all.moments[id]) = (part.induced[row], part.moments[row]);
            (all.fields[id], all.gradients[id]) = (part.fields[row], part.gradients[row]);
            tensors[id] = first_moments[row];
        }
        all.iterations = part.iterations;
    }
    (all, tensors)
}

/// Permanent moments alone, on one rank.
fn permanent(cell: &PeriodicBox, moments: &MagnetisedSpheres, tolerance: f64) -> (DipoleSolution, Vec<Tensor>) {
    let none = vec![0.0; moments.radii.len()];
    let problem = DipoleProblem {
        field: Vector::ZERO,
        permanent: &moments.moments,
        polarisabilities: &none,
        saturations: &[],
        guess: &[],
    };
    on_ranks(1, cell, moments, &plan(cell, moments, tolerance), &problem)
}

/// Errors of fields and gradients, relative to fields `m / (4 pi a^3)` within the spheres and to those over the radii;
/// and of the sum of the first moments, relative to the energy.
fn errors(cell: &PeriodicBox, moments: &MagnetisedSpheres, tolerance: f64) -> [f64; 2] {
    let ((found, _), exact) = (permanent(cell, moments, tolerance), moments.fields());
    let own = |row: usize, power: i32| moments.moments[row].length() / (4.0 * PI * moments.radii[row].powi(power));
    let norm = |values: Vec<f64>| values.iter().map(|value| value * value).sum::<f64>().sqrt();
    let rows = || 0..moments.radii.len();
    let field = norm(rows().map(|r| (found.fields[r] - exact[r].0).length()).collect());
    let gradient = norm(rows().map(|r| norm((found.gradients[r] - exact[r].1).to_cols_array().to_vec())).collect());
    [field / norm(rows().map(|r| own(r, 3)).collect()), gradient / norm(rows().map(|r| own(r, 4)).collect())]
}

#[test]
fn fields_are_those_of_sums_over_wavevectors() {
    for cell in boxes(9.0) {
        for ratio in [1.0, 2.0] {
            let moments = MagnetisedSpheres::random(12, ratio, &cell, 7);
            for tolerance in [1e-2, 1e-4, 1e-6, 1e-8] {
                let found = errors(&cell, &moments, tolerance);
                println!("{ratio} {tolerance:e}: {:.1e} {:.1e}", found[0] / tolerance, found[1] / tolerance);
                assert!(
                    found[0] < tolerance && found[1] < tolerance,
                    "{found:?} at {tolerance:e}, 1:{ratio}, {cell:?}"
                );
            }
        }
    }
}

#[test]
fn a_single_sphere_has_the_field_of_a_uniformly_magnetised_one() {
    let cell = PeriodicBox::new(Vector::splat(40.0)).unwrap();
    let moment = Vector::new(0.3, -1.0, 2.0);
    let one = MagnetisedSpheres {
        lattice: cell.lattice_vectors(),
        positions: vec![Vector::new(3.1, 20.0, 7.7)],
        radii: vec![1.5],
        moments: vec![moment],
    };
    let (found, _) = permanent(&cell, &one, 1e-6);
    // In a cubic lattice the images cause a third of the magnetisation.
    let exact = moment * (1.0 / (3.0 * cell.volume()) - 1.0 / (4.0 * PI * 1.5_f64.powi(3)));
    assert!((found.fields[0] - exact).length() < 1e-6 * exact.length());
}

/// `dU = first moment : e` for the energy `U = m . K m / 2`, in each of the nine directions.
#[test]
fn first_moments_are_derivatives_of_the_energy() {
    for cell in boxes(8.0) {
        let moments = MagnetisedSpheres::random(6, 1.3, &cell, 3);
        let (_, tensors) = permanent(&cell, &moments, 1e-8);
        let sum = tensors.iter().fold(Tensor::ZERO, |sum, tensor| sum + *tensor);
        let (step, energy) = (1e-3, moments.energy());
        for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
            let along = |size: f64| {
                let mut e = Tensor::ZERO;
                e.col_mut(b)[a] = size;
                moments.deformed(e).energy()
            };
            // Fourth order in the step.
            let slope = (8.0 * (along(step) - along(-step)) - along(2.0 * step) + along(-2.0 * step)) / (12.0 * step);
            assert!((sum.col(b)[a] - slope).abs() < 1e-7 * energy, "{a}{b}: {} and {slope}", sum.col(b)[a]);
        }
    }
}

/// Forces are the slopes of the energy and sum up to zero; torques balance the antisymmetric part of the first moments.
#[test]
fn forces_and_torques_are_derivatives_of_the_energy() {
    let cell = boxes(8.0)[2];
    let moments = MagnetisedSpheres::random(5, 1.4, &cell, 5);
    let (found, tensors) = permanent(&cell, &moments, 1e-8);
    let (step, energy) = (1e-3, moments.energy());
    for row in 0..5 {
        for axis in Vector::AXES {
            let moved = |size: f64| {
                let mut moved = moments.clone();
                moved.positions[row] += axis * size;
                moved.energy()
            };
            let slope = (8.0 * (moved(step) - moved(-step)) - moved(2.0 * step) + moved(-2.0 * step)) / (12.0 * step);
            assert!((found.force(row).dot(axis) + slope).abs() < 1e-7 * energy);
            let turned = |size: f64| {
                let mut turned = moments.clone();
                let rotation = domain::Quaternion::exp(axis * size);
                turned.moments[row] = rotation.rotate(turned.moments[row]);
                turned.energy()
            };
            let slope =
                (8.0 * (turned(step) - turned(-step)) - turned(2.0 * step) + turned(-2.0 * step)) / (12.0 * step);
            assert!((found.torque(row).dot(axis) + slope).abs() < 1e-7 * energy);
        }
    }
    let force: Vector = (0..5).map(|row| found.force(row)).sum();
    let torque: Vector = (0..5).map(|row| found.torque(row)).sum();
    let sum = tensors.iter().fold(Tensor::ZERO, |sum, tensor| sum + *tensor);
    let twist = Vector::new(sum.y_axis.z - sum.z_axis.y, sum.z_axis.x - sum.x_axis.z, sum.x_axis.y - sum.y_axis.x);
    assert!(force.length() < 1e-7 * energy && torque.length() > 1e-3 * energy);
    assert!((torque - twist).length() < 1e-6 * energy, "{torque} and {twist}");
}

/// With `n` spheres per volume at the sites of a cubic lattice the local field is `H_0 + M/3`, so that
/// `m = 4 pi a^3 beta H_0 / (1 - phi beta)`, apart from the overlap of the envelopes.
#[test]
fn induced_moments_in_a_cubic_lattice_are_those_of_maxwell_garnett() {
    let (edge, radius) = (4.0, 1.0);
    let cell = PeriodicBox::new(Vector::splat(2.0 * edge)).unwrap();
    let site = |i: usize| Vector::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
    let positions: Vec<Vector> = (0..8).map(|i| site(i) * edge + Vector::new(0.2, 1.1, 0.7)).collect();
    let lattice = MagnetisedSpheres {
        lattice: cell.lattice_vectors(),
        positions,
        radii: vec![radius; 8],
        moments: vec![Vector::ZERO; 8],
    };
    let field = Vector::new(0.5, -1.0, 2.0);
    for chi in [-0.9, 0.5, 10.0, 1e4] {
        let beta = chi / (chi + 3.0);
        let fraction = 4.0 / 3.0 * PI / edge.powi(3);
        let alphas = vec![4.0 / 3.0 * PI * chi; 8];
        let problem = DipoleProblem {
            field,
            permanent: &lattice.moments,
            polarisabilities: &alphas,
            saturations: &[],
            guess: &[],
        };
        let (found, _) = on_ranks(1, &cell, &lattice, &plan(&cell, &lattice, 1e-6), &problem);
        let exact = field * (4.0 * PI * beta / (1.0 - fraction * beta));
        for moment in &found.moments {
            assert!((*moment - exact).length() < 1e-6 * exact.length(), "{chi}: {moment} and {exact}");
        }
    }
}

/// Mixed permanent and induced moments solve the equations of the field by sums over wavevectors.
#[test]
fn induced_moments_are_along_the_field() {
    for cell in boxes(9.0) {
        let moments = MagnetisedSpheres::random(10, 1.5, &cell, 11);
        let chi = |row: usize| if row.is_multiple_of(3) { 0.0 } else { 5.0 + row as f64 };
        let alphas: Vec<f64> = (0..10).map(|r| chi(r) * 4.0 / 3.0 * PI * moments.radii[r].powi(3)).collect();
        let permanent: Vec<Vector> =
            (0..10).map(|r: usize| if r.is_multiple_of(2) { moments.moments[r] } else { Vector::ZERO }).collect();
        let field = Vector::new(1.0, 0.3, -0.4);
        let tolerance = 1e-5;
        let problem =
            DipoleProblem { field, permanent: &permanent, polarisabilities: &alphas, saturations: &[], guess: &[] };
        let (found, _) = on_ranks(1, &cell, &moments, &plan(&cell, &moments, tolerance), &problem);
        let fields = MagnetisedSpheres { moments: found.moments.clone(), ..moments.clone() }.fields();
        let by_field: Vec<Vector> = (0..10).map(|r| permanent[r] + (field + fields[r].0) * alphas[r]).collect();
        assert!(error(&vectors(&found.moments), &vectors(&by_field)) < 5.0 * tolerance);
        assert!(found.iterations > 2);
    }
}

#[test]
fn ranks_threads_and_units_do_not_matter() {
    for cell in boxes(9.0) {
        let moments = MagnetisedSpheres::random(14, 1.5, &cell, 2);
        let alphas: Vec<f64> = moments.radii.iter().map(|a| 20.0 * a.powi(3)).collect();
        let permanent = &moments.moments;
        let field = Vector::new(1.0, 0.3, -0.4);
        let problem = DipoleProblem { field, permanent, polarisabilities: &alphas, saturations: &[], guess: &[] };
        let plan = plan(&cell, &moments, 1e-7);
        let (alone, tensors) = on_ranks(1, &cell, &moments, &plan, &problem);
        let sum = |tensors: &[Tensor]| tensors.iter().fold(Tensor::ZERO, |sum, tensor| sum + *tensor).to_cols_array();
        for ranks in [2, 3] {
            let (found, others) = on_ranks(ranks, &cell, &moments, &plan, &problem);
            assert_eq!(found.iterations, alone.iterations);
            assert!(error(&vectors(&found.moments), &vectors(&alone.moments)) < 1e-12);
            assert!(error(&vectors(&found.fields), &vectors(&alone.fields)) < 1e-11);
            let entries = |list: &[Tensor]| list.iter().flat_map(Tensor::to_cols_array).collect::<Vec<_>>();
            assert!(error(&entries(&found.gradients), &entries(&alone.gradients)) < 1e-11);
            assert!(error(&sum(&others), &sum(&tensors)) < 1e-10);
        }
        // Lengths in units of a quarter, fields in units of 1/8.
        let (length, unit) = (4.0, 8.0);
        let scaled = MagnetisedSpheres {
            positions: moments.positions.iter().map(|x| *x * length).collect(),
            radii: moments.radii.iter().map(|a| a * length).collect(),
            ..moments.clone()
        };
        let volume = length * length * length;
        let permanent: Vec<Vector> = permanent.iter().map(|m| *m * (volume * unit)).collect();
        let alphas: Vec<f64> = alphas.iter().map(|alpha| alpha * volume).collect();
        let problem = DipoleProblem {
            field: field * unit,
            permanent: &permanent,
            polarisabilities: &alphas,
            saturations: &[],
            guess: &[],
        };
        let cell = cell.scaled(length);
        let plan = self::plan(&cell, &scaled, 1e-7);
        let (found, _) = on_ranks(1, &cell, &scaled, &plan, &problem);
        for row in 0..14 {
            assert_eq!(found.moments[row], alone.moments[row] * (volume * unit));
            assert_eq!(found.fields[row], alone.fields[row] * unit);
            assert_eq!(found.gradients[row], alone.gradients[row] * (unit / length));
        }
    }
}

/// `K` is symmetric, and positive semi-definite: its form is that of an energy.
#[test]
fn the_field_is_symmetric_and_positive() {
    let cell = boxes(8.0)[1];
    let moments = MagnetisedSpheres::random(6, 2.0, &cell, 4);
    let particles = store(&moments);
    let plan = plan(&cell, &moments, 1e-7);
    let partition = Partition::new(&Comm::alone(), [4, 4]);
    let mut particles = particles;
    particles.migrate(&partition, &cell);
    let mut field = DipoleField::new(&plan, &Comm::alone());
    let domain = DomainView { cell: &cell, partition: &partition };
    let column = |k: usize| {
        let mut unit = vec![Vector::ZERO; 6];
        unit[k / 3][k % 3] = 1.0;
        vectors(&field.fields(domain, &particles, &unit))
    };
    let columns: Vec<Vec<f64>> = (0..18).map(column).collect();
    let largest = columns.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    for (i, j) in (0..18).flat_map(|i| (0..18).map(move |j| (i, j))) {
        assert!((columns[i][j] - columns[j][i]).abs() < 1e-12 * largest);
    }
    // The smallest pivot of Cholesky's factorisation of -K plus round-off.
    let mut rest: Vec<Vec<f64>> = columns.iter().map(|column| column.iter().map(|entry| -entry).collect()).collect();
    for k in 0..18 {
        assert!(rest[k][k] > -1e-10 * largest, "pivot {k}: {}", rest[k][k]);
        for i in k + 1..18 {
            let factor = rest[i][k] / rest[k][k];
            for j in k..18 {
                let entry = rest[k][j];
                rest[i][j] -= factor * entry;
            }
        }
    }
}
