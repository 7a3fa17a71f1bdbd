//! Boxes with tilted or rotated lattices.

use crate::common::{Suspension, worst};
use domain::{PeriodicBox, Tensor, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Motion, Multipoles, Output, Plan, Precision, Problem};

fn turned(list: &[Vector], turn: &Tensor) -> Vec<Vector> {
    list.iter().map(|vector| *turn * *vector).collect()
}

fn turned_tensors(list: &[Traceless], turn: &Tensor) -> Vec<Traceless> {
    list.iter().map(|tensor| Traceless::part_of(&(*turn * tensor.tensor() * turn.transpose()))).collect()
}

fn fixed(method: Method) -> Fixed {
    Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() }
}

/// If a box is rotated with its particles, the motions are rotated likewise, to round-off.
#[test]
fn a_turned_box_has_turned_motions() {
    let cell = PeriodicBox::sheared(Vector::new(8.0, 7.0, 9.0), 0.3).unwrap();
    let suspension = Suspension::random(9, 1.7, cell, 3);
    let loads = suspension.loads(4);
    let turn = Tensor::from_axis_angle(Vector::new(2.0, -1.0, 0.5).normalize(), 1.1);
    let vectors = cell.lattice_vectors().map(|vector| turn * vector);
    let other = Suspension {
        cell: PeriodicBox::of_lattice(vectors).unwrap(),
        positions: turned(&suspension.positions, &turn),
        ..suspension.clone()
    }
    .displaced(Vector::ZERO);
    let other_loads = Loads {
        forces: turned(&loads.forces, &turn),
        torques: turned(&loads.torques, &turn),
        stresslets: turned_tensors(&loads.stresslets, &turn),
    };
    for method in [Method::Direct, Method::Split] {
        let plan = suspension.plan(1e-3, fixed(method));
        let motion = suspension.evaluate(&plan, &loads);
        let expected = Motion {
            velocities: turned(&motion.velocities, &turn),
            angular_velocities: turned(&motion.angular_velocities, &turn),
            strain_rates: turned_tensors(&motion.strain_rates, &turn),
        };
        let mut mobility = other.mobility(&plan);
        let found = mobility.apply(&other_loads, Output::All);
        assert!(worst(&found, &expected) < 1e-11, "{method:?}: {:e}", worst(&found, &expected));
        assert!(mobility.divergence().unwrap() < 1e-13);
    }
}

/// Any basis of a lattice gives the same motions, to the tolerance.
#[test]
fn other_vectors_of_a_lattice_have_the_same_motions() {
    let tolerance = 1e-4;
    let suspension = Suspension::random(12, 1.4, PeriodicBox::new(Vector::splat(8.0)).unwrap(), 6);
    let loads = suspension.loads(2);
    let exact = suspension.evaluate(&suspension.plan(0.01 * tolerance, Fixed::default()), &loads);
    let [a, b, c] = suspension.cell.lattice_vectors();
    let upright =
        [[a, b, c], [b, c, a], [a + b, b, c], [a + b, a + 2.0 * b, c], [2.0 * a + b, a + b, c], [b + c, c, a]];
    let tilted = [[a, b, c + a], [a, b, c - b], [a + b, b, c - a], [a + c, b + c, c], [a + b, b + c, a + b + c]];
    for vectors in upright.into_iter().chain(tilted) {
        let cell = PeriodicBox::of_lattice(vectors).unwrap();
        let other = Suspension { cell, ..suspension.clone() }.displaced(Vector::ZERO);
        let plan = other.plan(tolerance, Fixed::default());
        let error = worst(&other.evaluate(&plan, &loads), &exact);
        assert!(error < tolerance, "{vectors:?}: {error:e}");
    }
}

/// The same with forces alone, and down to small tolerances, for which the grid is in `f64`.
#[test]
fn a_tilted_lattice_keeps_any_tolerance() {
    let suspension = Suspension::random(10, 1.3, PeriodicBox::new(Vector::splat(7.5)).unwrap(), 8);
    let [a, b, c] = suspension.cell.lattice_vectors();
    let cell = PeriodicBox::of_lattice([a + b, b, c - a]).unwrap();
    let other = Suspension { cell, ..suspension.clone() }.displaced(Vector::ZERO);
    for (multipoles, tolerance) in [
        (Multipoles::Dipole, 1e-2),
        (Multipoles::Dipole, 1e-8),
        (Multipoles::Monopole, 1e-3),
        (Multipoles::Monopole, 1e-8),
    ] {
        let mut loads = suspension.loads(5);
        if multipoles == Multipoles::Monopole {
            (loads.torques, loads.stresslets) = (Vec::new(), Vec::new());
        }
        let plan = |of: &Suspension, tolerance| Plan::choose(&Problem { multipoles, ..of.problem(tolerance) }).unwrap();
        let wanted = if multipoles == Multipoles::Monopole { Output::Velocities } else { Output::All };
        let motion = |of: &Suspension, tolerance| of.mobility(&plan(of, tolerance)).apply(&loads, wanted);
        let error = worst(&motion(&other, tolerance), &motion(&suspension, 1e-2 * tolerance));
        assert!(error < tolerance, "{multipoles:?}, {tolerance:e}: {error:e}");
    }
}

/// The direct method has stencils only for boxes with an orthogonal third lattice vector.
#[test]
fn envelopes_on_a_tilted_grid_are_refused() {
    let vectors = [Vector::X * 9.0, Vector::Y * 9.0, Vector::new(2.0, 0.0, 9.0)];
    let suspension = Suspension::random(4, 1.0, PeriodicBox::of_lattice(vectors).unwrap(), 1);
    let problem = Problem { fixed: fixed(Method::Direct), ..suspension.problem(1e-3) };
    let error = Plan::choose(&problem).unwrap_err().to_string();
    assert!(error.contains("hydrodynamics.method is \"direct\"") && error.contains("at right angles"), "{error}");
}
