//! Properties of any mobility, whatever its error.

use crate::common::{Suspension, error, vectors, worst};
use domain::{PeriodicBox, Tensor, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Mobility, Motion, Output, Precision};

/// Basis of traceless tensors, orthonormal in the full contraction.
fn strains() -> [Traceless; 5] {
    let (half, third) = (0.5_f64.sqrt(), (1.0 / 6.0_f64).sqrt());
    [
        Traceless([half, 0.0, 0.0, -half, 0.0]),
        Traceless([third, 0.0, 0.0, third, 0.0]),
        Traceless([0.0, half, 0.0, 0.0, 0.0]),
        Traceless([0.0, 0.0, half, 0.0, 0.0]),
        Traceless([0.0, 0.0, 0.0, 0.0, half]),
    ]
}

/// Matrix from `(F, T, -S)` to `(V, Omega, E)`: three, three and five rows per particle.
fn matrix(suspension: &Suspension, mobility: &mut Mobility) -> Vec<Vec<f64>> {
    let count = suspension.radii.len();
    let column = |c: usize| {
        let (n, component) = (c / 11, c % 11);
        let (mut forces, mut torques) = (vec![Vector::ZERO; count], vec![Vector::ZERO; count]);
        let mut stresslets = vec![Traceless::ZERO; count];
        match component {
            0..3 => forces[n] = Vector::AXES[component],
            3..6 => torques[n] = Vector::AXES[component - 3],
            _ => stresslets[n] = -strains()[component - 6],
        }
        let motion = mobility.apply(&Loads { forces, torques, stresslets }, Output::All);
        let of_particle = |m: usize| {
            let (v, w, e) = (motion.velocities[m], motion.angular_velocities[m], motion.strain_rates[m]);
            [v.to_array().as_slice(), &w.to_array(), &strains().map(|s| s.contract(e))].concat()
        };
        (0..count).flat_map(of_particle).collect()
    };
    (0..11 * count).map(column).collect()
}

/// Largest difference between the matrix and its transpose, over its largest element.
fn asymmetry(matrix: &[Vec<f64>]) -> f64 {
    let size = matrix.len();
    let pairs = || (0..size).flat_map(|i| (0..i).map(move |j| (i, j)));
    let scale = matrix.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
    pairs().map(|(i, j)| (matrix[i][j] - matrix[j][i]).abs()).fold(0.0, f64::max) / scale
}

/// Whether the symmetric part has a Cholesky factorisation.
fn is_positive_definite(matrix: &[Vec<f64>]) -> bool {
    let size = matrix.len();
    let mut lower = vec![vec![0.0; size]; size];
    for i in 0..size {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = 0.5 * (matrix[i][j] + matrix[j][i]) - known;
            if i == j && rest <= 0.0 {
                return false;
            }
            lower[i][j] = if i == j { f64::sqrt(rest) } else { rest / lower[j][j] };
        }
    }
    true
}

fn fixed(method: Method) -> Fixed {
    Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() }
}

const METHODS: [Method; 2] = [Method::Direct, Method::Split];

/// Spreading and interpolation are adjoint and the pair correction is symmetric in the pair, so the mobility is
/// symmetric to round-off at any tolerance.
#[test]
fn the_mobility_is_symmetric_and_positive_definite() {
    for (count, ratio, edges, strain) in [(4, 1.0, [6.0; 3], 0.0), (5, 2.0, [9.0, 8.0, 7.0], 0.35)] {
        let cell = PeriodicBox::sheared(Vector::from_array(edges), strain).unwrap();
        let suspension = Suspension::random(count, ratio, cell, 5);
        for method in METHODS {
            for tolerance in [0.3, 1e-1, 1e-2, 1e-4, 1e-8] {
                let plan = suspension.plan(tolerance, fixed(method));
                let matrix = matrix(&suspension, &mut suspension.mobility(&plan));
                let asymmetry = asymmetry(&matrix);
                assert!(asymmetry < 1e-13, "{method:?} at {tolerance:e}: asymmetry {asymmetry:e}");
                assert!(is_positive_definite(&matrix), "{method:?} at {tolerance:e}");
            }
        }
    }
}

#[test]
fn the_mobility_of_a_tilted_box_is_symmetric_and_positive_definite() {
    let vectors = [Vector::new(7.0, 1.0, -0.5), Vector::new(-1.0, 7.5, 2.0), Vector::new(2.5, -2.0, 7.0)];
    let suspension = Suspension::random(5, 1.6, PeriodicBox::of_lattice(vectors).unwrap(), 2);
    for tolerance in [0.3, 1e-2, 1e-8] {
        let mut mobility = suspension.mobility(&suspension.plan(tolerance, fixed(Method::Split)));
        let matrix = matrix(&suspension, &mut mobility);
        assert!(asymmetry(&matrix) < 1e-13, "at {tolerance:e}: asymmetry {:e}", asymmetry(&matrix));
        assert!(is_positive_definite(&matrix), "at {tolerance:e}");
        assert!(mobility.divergence().unwrap() < 1e-13);
    }
}

#[test]
fn the_mobility_is_symmetric_to_round_off_in_f32() {
    let suspension = Suspension::random(4, 1.5, PeriodicBox::new(Vector::splat(7.0)).unwrap(), 6);
    for method in METHODS {
        let single = Fixed { precision: Some(Precision::Single), ..fixed(method) };
        let matrix = matrix(&suspension, &mut suspension.mobility(&suspension.plan(1e-2, single)));
        let asymmetry = asymmetry(&matrix);
        // Sums of a thousand terms with round-off of 6e-8 each.
        assert!(asymmetry < 2e-6, "{method:?}: asymmetry {asymmetry:e}");
        assert!(is_positive_definite(&matrix));
    }
}

/// A displacement by any fraction of a grid cell changes the motion by less than the tolerance, one by whole cells
/// not at all.
#[test]
fn the_grid_has_no_preferred_place() {
    let cell = PeriodicBox::sheared(Vector::new(9.0, 7.0, 8.0), 0.2).unwrap();
    let suspension = Suspension::random(10, 1.6, cell, 7);
    let loads = suspension.loads(1);
    for (method, tolerance) in METHODS.iter().flat_map(|m| [1e-1, 1e-2, 1e-4, 1e-7].map(|t| (*m, t))) {
        let plan = suspension.plan(tolerance, fixed(method));
        let here = suspension.evaluate(&plan, &loads);
        let spacing = cell.edges() / Vector::from_array(plan.grid.map(|n| n as f64));
        for fraction in [0.17, 0.5, 0.83] {
            let there = suspension.displaced(spacing * Vector::new(fraction, 1.0 - fraction, 0.5 * fraction));
            let change = worst(&there.evaluate(&plan, &loads), &here);
            assert!(change < tolerance, "{method:?} at {tolerance:e}: {change:e}");
        }
        let step = Vector::new(2.0 * spacing.x + cell.strain() * 3.0 * spacing.y, 3.0 * spacing.y, -spacing.z);
        let change = worst(&suspension.displaced(step).evaluate(&plan, &loads), &here);
        assert!(change < 1e-12, "{method:?} at {tolerance:e}, whole cells: {change:e}");
    }
}

/// A quarter rotation of everything about z, then about x.
#[test]
fn a_cubic_box_has_no_preferred_axis() {
    let suspension = Suspension::random(10, 1.6, PeriodicBox::new(Vector::splat(8.0)).unwrap(), 8);
    let loads = suspension.loads(2);
    let turn =
        Tensor::from_cols(Vector::Y, Vector::Z, Vector::X) * Tensor::from_cols(Vector::Y, Vector::NEG_X, Vector::Z);
    let vectors = |list: &[Vector]| -> Vec<Vector> { list.iter().map(|v| turn * *v).collect() };
    let tensors = |list: &[Traceless]| -> Vec<Traceless> {
        list.iter().map(|t| Traceless::part_of(&(turn * t.tensor() * turn.transpose()))).collect()
    };
    let positions = vectors(&suspension.positions).iter().map(|p| suspension.cell.wrap(*p).0).collect();
    let turned = Suspension { positions, ..suspension.clone() };
    let turned_loads = Loads {
        forces: vectors(&loads.forces),
        torques: vectors(&loads.torques),
        stresslets: tensors(&loads.stresslets),
    };
    for (method, tolerance) in METHODS.iter().flat_map(|m| [1e-2, 1e-6].map(|t| (*m, t))) {
        let plan = suspension.plan(tolerance, fixed(method));
        let motion = suspension.evaluate(&plan, &loads);
        let expected = Motion {
            velocities: vectors(&motion.velocities),
            angular_velocities: vectors(&motion.angular_velocities),
            strain_rates: tensors(&motion.strain_rates),
        };
        let change = worst(&turned.evaluate(&plan, &turned_loads), &expected);
        assert!(change < tolerance, "{method:?} at {tolerance:e}: {change:e}");
    }
}

/// A net force is balanced by a uniform pressure gradient, not by a mean flow; and the flow is divergence-free.
#[test]
fn a_net_force_leaves_no_mean_flow() {
    let suspension = Suspension::random(6, 1.3, PeriodicBox::sheared(Vector::new(7.0, 6.0, 8.0), -0.3).unwrap(), 9);
    let loads = Loads { forces: vec![Vector::new(1.0, 2.0, -3.0); 6], ..suspension.loads(3) };
    for method in METHODS {
        let mut mobility = suspension.mobility(&suspension.plan(1e-4, fixed(method)));
        mobility.apply(&loads, Output::All);
        let field = mobility.velocity_field();
        let points = field.len() / 3;
        let size = (field.iter().map(|u| u * u).sum::<f64>() / points as f64).sqrt();
        assert!(size > 0.0);
        for component in field.chunks(points) {
            let mean = component.iter().sum::<f64>() / points as f64;
            assert!(mean.abs() < 1e-14 * size * (points as f64).sqrt(), "{method:?}: mean {mean:e} of {size:e}");
        }
        // Round-off, but not exactly zero.
        assert!(mobility.divergence().unwrap() > 0.0 && mobility.divergence().unwrap() < 1e-11);
    }
}

/// Strains that differ by a period give the same lattice, and so do `1/2` and `-1/2` of a period.
#[test]
fn strains_a_period_apart_give_the_same_motion() {
    let edges = Vector::new(9.0, 6.0, 7.0);
    let period = edges.x / edges.y;
    for (strain, digits) in [(0.3, 1e-12), (0.5 * period, 1e-12)] {
        let here = Suspension::random(8, 1.5, PeriodicBox::sheared(edges, strain).unwrap(), 10);
        let there = PeriodicBox::sheared(edges, strain - period).unwrap();
        let positions = here.positions.iter().map(|p| there.wrap(*p).0).collect();
        let there = Suspension { cell: there, positions, ..here.clone() };
        let loads = here.loads(4);
        for method in METHODS {
            let plan = here.plan(1e-4, fixed(method));
            let change = worst(&there.evaluate(&plan, &loads), &here.evaluate(&plan, &loads));
            assert!(change < digits, "{method:?} at {strain}: {change:e}");
        }
    }
}

/// Just before and just after the box is remapped its grids differ as much as they can, and the lattices by 1e-9: the
/// motion changes by less than the tolerance.
#[test]
fn turning_the_box_back_changes_the_motion_by_less_than_the_tolerance() {
    let edges = Vector::new(8.0, 8.0, 7.0);
    let before = Suspension::random(8, 1.5, PeriodicBox::sheared(edges, 0.5 - 1e-9).unwrap(), 11);
    let after = PeriodicBox::sheared(edges, 0.5 + 1e-9).unwrap();
    assert!(before.cell.strain() > 0.49 && after.strain() < -0.49);
    let positions = before.positions.iter().map(|p| after.wrap(*p).0).collect();
    let after = Suspension { cell: after, positions, ..before.clone() };
    let loads = before.loads(5);
    for (method, tolerance) in METHODS.iter().flat_map(|m| [1e-2, 1e-4, 1e-6].map(|t| (*m, t))) {
        let plan = before.plan(tolerance, fixed(method));
        let change = worst(&after.evaluate(&plan, &loads), &before.evaluate(&plan, &loads));
        assert!(change < tolerance, "{method:?} at {tolerance:e}: {change:e}");
        assert!(change > 1e-9, "the grids are not the same");
    }
}

#[test]
fn the_image_that_a_particle_starts_from_does_not_matter() {
    let suspension = Suspension::random(8, 1.5, PeriodicBox::sheared(Vector::new(9.0, 6.0, 7.0), 0.4).unwrap(), 12);
    let loads = suspension.loads(6);
    let mut elsewhere = suspension.clone();
    for (n, position) in elsewhere.positions.iter_mut().enumerate() {
        let n = n as i32;
        let image = *position + suspension.cell.lattice([n % 3 - 1, n % 2 + 1, 2 - n % 4]);
        *position = suspension.cell.wrap(image).0;
    }
    for method in METHODS {
        let plan = suspension.plan(1e-3, fixed(method));
        let [a, b] = [&suspension, &elsewhere].map(|s| s.evaluate(&plan, &loads).velocities);
        assert!(error(&vectors(&a), &vectors(&b)) < 1e-12);
    }
}

/// Motions are linear in the loads and inversely proportional to the viscosity.
#[test]
fn motions_are_linear_in_loads_and_fluidity() {
    let suspension = Suspension::random(8, 1.5, PeriodicBox::new(Vector::splat(7.0)).unwrap(), 13);
    let loads = suspension.loads(7);
    let twice = Loads {
        forces: loads.forces.iter().map(|f| *f * 2.0).collect(),
        torques: loads.torques.iter().map(|t| *t * 2.0).collect(),
        stresslets: loads.stresslets.iter().map(|s| *s * 2.0).collect(),
    };
    let thicker = Suspension { viscosity: 2.0 * suspension.viscosity, ..suspension.clone() };
    for method in METHODS {
        let change = worst(
            &thicker.evaluate(&thicker.plan(1e-3, fixed(method)), &twice),
            &suspension.evaluate(&suspension.plan(1e-3, fixed(method)), &loads),
        );
        assert!(change < 1e-13, "{method:?}: {change:e}");
    }
}
