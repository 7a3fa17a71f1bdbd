//! Boxes of other lattices than upright ones.

mod common;

use common::{Suspension, worst};
use domain::{PeriodicBox, Tensor, Traceless, Vector};
use fcm::{Evaluation, Fixed, Loads, MethodName, Motion, Precision};

fn turned(list: &[Vector], turn: &Tensor) -> Vec<Vector> {
    list.iter().map(|vector| *turn * *vector).collect()
}

fn turned_tensors(list: &[Traceless], turn: &Tensor) -> Vec<Traceless> {
    list.iter().map(|tensor| Traceless::part_of(&(*turn * tensor.tensor() * turn.transpose()))).collect()
}

fn fixed(method: MethodName) -> Fixed {
    Fixed { method: Some(method), precision: Some(Precision::Double), ..Fixed::default() }
}

/// A box that is turned with all that is in it has the same motions, turned, to round-off.
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
    for method in [MethodName::Direct, MethodName::Split] {
        let plan = suspension.plan(1e-3, fixed(method));
        let motion = suspension.evaluate(&plan, &loads);
        let expected = Motion {
            velocities: turned(&motion.velocities, &turn),
            angular_velocities: turned(&motion.angular_velocities, &turn),
            strain_rates: turned_tensors(&motion.strain_rates, &turn),
        };
        let mut mobility = other.mobility(&plan);
        let found = mobility.apply(&other_loads, Evaluation::All);
        assert!(worst(&found, &expected) < 1e-11, "{method:?}: {:e}", worst(&found, &expected));
        assert!(mobility.divergence() < 1e-13);
    }
}

/// Which vectors name a lattice does not matter: within the tolerance, motions are the same.
#[test]
fn other_vectors_of_a_lattice_have_the_same_motions() {
    let tolerance = 1e-4;
    let suspension = Suspension::random(12, 1.4, PeriodicBox::new(Vector::splat(8.0)).unwrap(), 6);
    let loads = suspension.loads(2);
    let exact = suspension.evaluate(&suspension.plan(0.01 * tolerance, Fixed::default()), &loads);
    let [a, b, c] = suspension.cell.lattice_vectors();
    for vectors in
        [[a, b, c], [b, c, a], [a + b, b, c], [a + b, a + 2.0 * b, c], [2.0 * a + b, a + b, c], [b + c, c, a]]
    {
        let cell = PeriodicBox::of_lattice(vectors).unwrap();
        let other = Suspension { cell, ..suspension.clone() }.displaced(Vector::ZERO);
        let plan = other.plan(tolerance, Fixed::default());
        let error = worst(&other.evaluate(&plan, &loads), &exact);
        assert!(error < tolerance, "{vectors:?}: {error:e}");
    }
}
