//! Lubrication of a sphere at a wall: symmetries, limits of its range, units.

use domain::{Tensor, Traceless, Vector};
use lubrication::{LubricationRange, SphereLoads, SphereMotion, WallFactor, WallForce};
use proptest::prelude::*;

fn factor(to_wall: Vector) -> WallFactor {
    WallForce::new(1.0, LubricationRange::default()).factor(to_wall.normalize(), to_wall.length(), 1.0).unwrap()
}

fn vector() -> impl Strategy<Value = Vector> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(Vector::from)
}

fn motion() -> impl Strategy<Value = SphereMotion> {
    let strain = prop::array::uniform5(-1.0..1.0f64).prop_map(Traceless);
    (vector(), vector(), strain).prop_map(|(velocity, angular_velocity, strain_rate)| SphereMotion {
        velocity,
        angular_velocity,
        strain_rate,
    })
}

fn size(loads: &SphereLoads) -> f64 {
    loads.force.length() + loads.torque.length() + loads.moment.contract(loads.moment).sqrt()
}

fn distance(a: &SphereLoads, b: &SphereLoads) -> f64 {
    size(&SphereLoads { force: a.force - b.force, torque: a.torque - b.torque, moment: a.moment + b.moment * -1.0 })
}

/// Reflection of loads: angular velocities and torques are pseudovectors.
fn mirrored(loads: &SphereLoads, by: Tensor) -> SphereLoads {
    SphereLoads {
        force: by * loads.force,
        torque: by * loads.torque * by.determinant(),
        moment: Traceless::part_of(&(by * loads.moment.tensor() * by.transpose())),
    }
}

fn mirrored_motion(motion: &SphereMotion, by: Tensor) -> SphereMotion {
    let loads = SphereLoads { force: motion.velocity, torque: motion.angular_velocity, moment: motion.strain_rate };
    let SphereLoads { force, torque, moment } = mirrored(&loads, by);
    SphereMotion { velocity: force, angular_velocity: torque, strain_rate: moment }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn work_is_the_square_of_the_modes(direction in vector(), gap in 1e-6..1.4f64, a in motion(), b in motion()) {
        prop_assume!(direction.length() > 0.1);
        let factor = factor(direction.normalize() * (1.0 + gap));
        let (modes, others) = (factor.modes(&a), factor.modes(&b));
        let product: f64 = modes.iter().zip(&others).map(|(g, h)| g * h).sum();
        let scale: f64 = modes.iter().chain(&others).map(|g| g * g).sum();
        prop_assert!((b.power(&factor.loads(&modes)) - product).abs() < 1e-12 * scale);
    }

    /// For a sphere without strain, all forces and torques are those of the modes.
    #[test]
    fn modes_are_what_resists_motion(direction in vector(), gap in 1e-6..1.4f64, a in motion()) {
        prop_assume!(direction.length() > 0.1);
        let factor = factor(direction.normalize() * (1.0 + gap));
        let rigid = SphereMotion { strain_rate: Traceless::ZERO, ..a };
        let (by_modes, all) = (factor.loads(&factor.modes(&rigid)), factor.resistance(&rigid));
        prop_assert!((by_modes.force - all.force).length() < 1e-12 * size(&all));
        prop_assert!((by_modes.torque - all.torque).length() < 1e-12 * size(&all));
    }

    #[test]
    fn the_whole_resistance_is_symmetric(direction in vector(), gap in 1e-6..1.4f64, a in motion(), b in motion()) {
        prop_assume!(direction.length() > 0.1);
        let factor = factor(direction.normalize() * (1.0 + gap));
        let (first, second) = (factor.resistance(&a), factor.resistance(&b));
        prop_assert!((b.power(&first) - a.power(&second)).abs() < 1e-12 * (size(&first) + size(&second)));
    }

    /// An upper wall is the reflection of a lower one; rotations do not matter either.
    #[test]
    fn loads_turn_and_reflect_with_the_wall(
        gap in 1e-6..1.4f64, a in motion(), turn in vector(), angle in 0.0..6.0f64,
    ) {
        prop_assume!(turn.length() > 0.1);
        let to_wall = -Vector::Z * (1.0 + gap);
        let loads = factor(to_wall).resistance(&a);
        let mirror = Tensor::from_diagonal(Vector::new(1.0, 1.0, -1.0));
        for by in [mirror, Tensor::from_axis_angle(turn.normalize(), angle)] {
            let other = factor(by * to_wall).resistance(&mirrored_motion(&a, by));
            prop_assert!(distance(&mirrored(&loads, by), &other) < 1e-11 * size(&loads));
        }
    }

    #[test]
    fn loads_scale_with_size_and_viscosity(gap in 1e-6..1.4f64, a in motion()) {
        let to_wall = Vector::X * (1.0 + gap);
        let large = WallForce::new(5.0, LubricationRange::default()).factor(Vector::X, 3.0 * (1.0 + gap), 3.0).unwrap();
        let (loads, scaled) = (factor(to_wall).resistance(&a), large.resistance(&SphereMotion {
            velocity: a.velocity * 3.0, ..a
        }));
        // A length of 3 and a viscosity of 5: a force has 45 units, a torque 135. A gap of 1e-6 has ten digits.
        prop_assert!((scaled.force - 45.0 * loads.force).length() < 1e-8 * scaled.force.length());
        prop_assert!((scaled.torque - 135.0 * loads.torque).length() < 1e-8 * size(&scaled));
        let moment = scaled.moment + loads.moment * -135.0;
        prop_assert!(moment.contract(moment).sqrt() < 1e-8 * size(&scaled));
    }
}

#[test]
fn nothing_acts_beyond_the_cutoff_and_contact_is_as_stiff_as_the_closest_gap() {
    let force = WallForce::new(1.0, LubricationRange::default());
    assert_eq!(
        (force.range().cutoff(), WallForce::new(1.0, LubricationRange::new(0.2, 1e-6).unwrap()).range().cutoff()),
        (1.5, 0.2)
    );
    let approach = SphereMotion { velocity: Vector::Z, ..SphereMotion::default() };
    let at = |z: f64| force.factor(Vector::Z, z, 1.0).map(|factor| factor.resistance(&approach).force.z);
    assert!(at(2.5).is_none());
    assert_eq!(at(0.99), at(-0.5));
    assert!((at(0.99).unwrap() / at(1.0 + 1e-6).unwrap() - 1.0).abs() < 1e-8);
    assert!(at(2.499).unwrap() < 1e-6 && at(2.499).unwrap() >= 0.0);
}
