//! Lubrication of a pair: values, symmetries, limits of its range, and refusals.

use std::f64::consts::PI;

use domain::{Tensor, Traceless, Vector};
use lubrication::{
    Coefficients, LubricationRange, PairFactor, PairForce, PairForceError, PairLoads, PairMotion, RangeError,
};
use proptest::prelude::*;

fn force(radii: &[f64]) -> PairForce {
    PairForce::new(radii, 1.0, LubricationRange::default()).unwrap()
}

fn moving(sphere: usize, velocity: Vector) -> PairMotion {
    let mut motion = PairMotion::default();
    motion.velocity[sphere] = velocity;
    motion
}

fn turning(sphere: usize, angular_velocity: Vector) -> PairMotion {
    let mut motion = PairMotion::default();
    motion.angular_velocity[sphere] = angular_velocity;
    motion
}

/// Exact resistance minus that of FCM, by multipole collocation and a dense inverse: hatted dXA11, dXA12, dXA22,
/// dYA11, dYB11, dYB21, dYC11.
#[test]
fn strong_functions_agree_with_reference() {
    let cases = [
        (
            1.0,
            [
                2500.70497238,
                -2500.70039017,
                2500.70497238,
                1.19755309258,
                -1.76336407259,
                -1.77058263092,
                1.41951851229,
            ],
        ),
        (
            2.0,
            [4445.86708735, -2963.84771519, 2222.83985435, 1.84398570754, -1.97217713537, -2.7047529412, 1.98921738889],
        ),
    ];
    for (ratio, expected) in cases {
        let force = force(&[1.0, ratio]);
        let separation = Vector::Z * (1.0 + ratio + 1e-4);
        let loads = |motion: PairMotion| force.loads(separation, [0, 1], &motion).unwrap();
        let (s, first, second) = (1.0 + ratio, loads(moving(0, Vector::Z)), loads(moving(1, Vector::Z)));
        let (across, turned) = (loads(moving(0, Vector::X)), loads(turning(0, Vector::Y)));
        let found = [
            first.force[0].z / (6.0 * PI),
            second.force[0].z / (3.0 * PI * s),
            second.force[1].z / (6.0 * PI * ratio),
            across.force[0].x / (6.0 * PI),
            -across.torque[0].y / (4.0 * PI),
            -across.torque[1].y / (PI * s * s),
            turned.torque[0].y / (8.0 * PI),
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            // Making the resistance to motions positive semi-definite changes unequal spheres by up to a thousandth
            // of the drag.
            assert!((found - expected).abs() < 5e-3 + 1e-5 * expected.abs(), "ratio {ratio}: {found}, not {expected}");
        }
    }
}

/// Near contact forces of 1e6 cancel up to the error of FCM in the drag of the pair as a whole: net force and net
/// torque do not grow as the gap shrinks.
#[test]
fn action_equals_reaction_at_contact() {
    for ratio in [1.0, 2.0, 4.0, 10.0] {
        let force = force(&[1.0, ratio]);
        let axis = Vector::new(0.6, 0.0, 0.8);
        let at = |gap: f64| force.loads(axis * (1.0 + ratio + gap), [0, 1], &moving(0, axis)).unwrap();
        let [near, nearest] = [1e-3, 1e-6 * (1.0 + ratio)].map(at);
        assert!(nearest.force[0].length() > 1e5 && nearest.force[0].length() > 50.0 * near.force[0].length());
        for loads in [near, nearest] {
            let net = (loads.force[0] + loads.force[1]).length();
            assert!(net < 0.1 * 6.0 * PI, "ratio {ratio}: {net}");
            // Central forces: no torque on either, beyond the round-off of the forces.
            assert!(loads.torque.iter().all(|t| t.length() < 1e-13 * loads.force[0].length()), "ratio {ratio}");
        }
    }
}

/// The divergent part of the loads of sliding surfaces acts at the contact point: opposite forces, and torques that
/// balance those of the forces about any point.
#[test]
fn forces_and_torques_of_sliding_surfaces_balance_for_unequal_spheres() {
    for ratio in [1.0, 2.0, 4.0, 10.0] {
        let force = force(&[1.0, ratio]);
        let axis = Vector::new(0.6, 0.0, 0.8);
        let across = Vector::new(-0.8, 0.0, 0.6);
        for motion in [moving(0, across), moving(1, across), turning(0, Vector::Y), turning(1, Vector::Y)] {
            let [near, nearest] =
                [1e-3, 1e-5].map(|gap| force.loads(axis * (1.0 + ratio + gap), [0, 1], &motion).unwrap());
            let grown = [0, 1].map(|k| nearest.force[k] - near.force[k]);
            let turned = [0, 1].map(|k| nearest.torque[k] - near.torque[k]);
            let net = grown[0] + grown[1];
            let moment = turned[0] + turned[1] + (axis * (1.0 + ratio)).cross(grown[1]);
            let force = grown[0].length();
            assert!(force > 10.0 && net.length() < 1e-4 * force, "ratio {ratio}: {} of {force}", net.length());
            // The contact point is uncertain by a gap of a thousandth.
            let allowed = 1e-3 * force * (1.0 + ratio);
            assert!(moment.length() < allowed, "ratio {ratio}: {} of {allowed}", moment.length());
        }
    }
}

/// The resistance to a rigid-body motion of both spheres is a small part of their drag: lubrication depends on
/// relative motion.
#[test]
fn pairs_that_move_as_one_feel_little() {
    for ratio in [1.0, 2.0, 4.0, 10.0] {
        let force = force(&[1.0, ratio]);
        let separation = Vector::Z * (1.0 + ratio + 1e-5);
        for axis in [Vector::Z, Vector::X] {
            let mut motion = moving(0, axis);
            motion.velocity[1] = axis;
            let net = |loads: PairLoads| (loads.force[0] + loads.force[1]).length();
            let drag = 6.0 * PI * ratio;
            assert!(net(force.loads(separation, [0, 1], &motion).unwrap()) < 0.015 * drag, "ratio {ratio}");
        }
    }
}

/// The frame of a pair switches near one direction, without effect on the loads.
#[test]
fn loads_change_smoothly_with_direction() {
    let force = force(&[1.0, 2.0]);
    let motion = PairMotion {
        velocity: [Vector::X, Vector::new(0.3, -0.7, 0.2)],
        angular_velocity: [Vector::Y, Vector::Z],
        strain_rate: [Traceless([0.3, 0.1, -0.5, 0.2, 0.7]); 2],
    };
    let at = |angle: f64| {
        let direction = Vector::new(0.8 * angle.sin(), 0.6 * angle.sin(), -angle.cos());
        force.loads(direction * 3.01, [0, 1], &motion).unwrap()
    };
    // The direction at which the cosine passes 0.999.
    let switch = 0.999_f64.acos();
    let [before, after] = [switch * (1.0 - 1e-12), switch * (1.0 + 1e-12)].map(at);
    for i in 0..2 {
        assert!((before.force[i] - after.force[i]).length() < 1e-9 * size(&before));
        assert!((before.torque[i] - after.torque[i]).length() < 1e-9 * size(&before));
        let moment = before.moment[i] - after.moment[i];
        assert!(moment.contract(moment).sqrt() < 1e-9 * size(&before));
    }
}

#[test]
fn nothing_acts_beyond_the_cutoff_and_it_ends_smoothly() {
    let force =
        PairForce::new(&[1.0, 1.5], 1.0, LubricationRange::new(LubricationRange::NARROW, 1e-6).unwrap()).unwrap();
    let at =
        |gap: f64| force.loads(Vector::Y * (2.5 + gap), [0, 1], &moving(0, Vector::Y)).map(|loads| loads.force[0].y);
    assert!(at(0.3 + 1e-12).is_none());
    // Quintic step: third power of the distance to the end.
    let (near, nearer) = (at(0.3 - 1e-2).unwrap(), at(0.3 - 0.5e-2).unwrap());
    assert!(near > 0.0 && (nearer / near) < 0.15, "{near} {nearer}");
    assert!((force.reach() - 1.5 * 2.2).abs() < 1e-14);
}

/// Overlapping spheres have the resistance at a gap equal to the overlap if the range is to separate them, by factors
/// as well as by coefficients.
#[test]
fn spheres_that_overlap_part_again_if_they_are_to() {
    let parting = PairForce::new(&[1.0, 1.5], 1.0, LubricationRange::default().separating()).unwrap();
    let along = |force: &PairForce, gap: f64| {
        let by_factor = force.loads(Vector::X * (2.5 + gap), [0, 1], &moving(0, Vector::X)).unwrap();
        [force.coefficients(2.5 + gap, [0, 1]).unwrap().xa[0][0], by_factor.force[0].x]
    };
    let apart = along(&parting, 0.03);
    for (found, wanted) in along(&parting, -0.03).into_iter().zip(apart) {
        assert!((found / wanted - 1.0).abs() < 1e-9, "{found} is not {wanted}");
    }
    let kept = PairForce::new(&[1.0, 1.5], 1.0, LubricationRange::default()).unwrap();
    let motion = moving(0, Vector::X);
    assert_eq!(kept.loads(Vector::X * 2.53, [0, 1], &motion), parting.loads(Vector::X * 2.53, [0, 1], &motion));
    assert!(along(&kept, -0.03)[0].abs() > 1e4 * apart[0].abs());
}

#[test]
fn overlap_is_as_stiff_as_the_closest_gap() {
    let force = PairForce::new(&[1.0], 1.0, LubricationRange::new(2.0, 1e-3).unwrap()).unwrap();
    let at = |r: f64| force.loads(Vector::X * r, [0, 0], &moving(0, Vector::X)).unwrap();
    assert_eq!(at(1.9), at(1.0));
    assert!((at(1.9).force[0].x / at(2.001).force[0].x - 1.0).abs() < 1e-10);
    assert!(force.factor(Vector::ZERO, [0, 0]).is_none());
}

#[test]
fn loads_scale_with_size_and_viscosity() {
    let (unit, large) = (force(&[1.0, 2.0]), PairForce::new(&[3.0, 6.0], 5.0, LubricationRange::default()).unwrap());
    let separation = Vector::new(1.0, 2.0, 2.1);
    let loads = unit.loads(separation, [0, 1], &moving(1, Vector::X)).unwrap();
    let scaled = large.loads(3.0 * separation, [0, 1], &moving(1, Vector::X)).unwrap();
    assert!((scaled.force[0] - 15.0 * loads.force[0]).length() < 1e-11 * scaled.force[0].length());
    assert!((scaled.torque[0] - 45.0 * loads.torque[0]).length() < 1e-11 * scaled.torque[0].length());
    assert!((scaled.moment[1] - loads.moment[1] * 45.0).contract(Traceless([1.0; 5])).abs() < 1e-9);
}

#[test]
fn refuses_senseless_parameters() {
    assert_eq!(LubricationRange::new(9.0, 1e-4), Err(RangeError::Cutoff(9.0)));
    assert_eq!(LubricationRange::new(1.0, 0.2), Err(RangeError::MinimumGap(0.2)));
    assert!(LubricationRange::new(f64::NAN, 1e-4).is_err());
    assert!(matches!(
        PairForce::new(&[1.0, -1.0], 1.0, LubricationRange::default()),
        Err(PairForceError::Positive { .. })
    ));
    let error = PairForce::new(&[1.0, 30.0], 1.0, LubricationRange::default()).unwrap_err();
    assert!(error.to_string().contains("radii 1 and 30"));
}

fn vector() -> impl Strategy<Value = Vector> {
    prop::array::uniform3(-1.0..1.0f64).prop_map(Vector::from)
}

fn motion() -> impl Strategy<Value = PairMotion> {
    let strain = || prop::array::uniform5(-1.0..1.0f64).prop_map(Traceless);
    (vector(), vector(), vector(), vector(), strain(), strain()).prop_map(|(u, v, o, p, e, f)| PairMotion {
        velocity: [u, v],
        angular_velocity: [o, p],
        strain_rate: [e, f],
    })
}

fn turned(motion: &PairMotion, by: Tensor) -> PairMotion {
    PairMotion {
        velocity: motion.velocity.map(|u| by * u),
        angular_velocity: motion.angular_velocity.map(|o| by * o),
        strain_rate: motion.strain_rate.map(|e| Traceless::part_of(&(by * e.tensor() * by.transpose()))),
    }
}

fn swapped(motion: &PairMotion) -> PairMotion {
    let ([u, v], [o, p], [e, f]) = (motion.velocity, motion.angular_velocity, motion.strain_rate);
    PairMotion { velocity: [v, u], angular_velocity: [p, o], strain_rate: [f, e] }
}

fn size(loads: &PairLoads) -> f64 {
    (0..2)
        .map(|i| loads.force[i].length() + loads.torque[i].length() + loads.moment[i].contract(loads.moment[i]).sqrt())
        .sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn work_is_the_square_of_the_modes(direction in vector(), gap in 1e-4..1.0f64, a in motion(), b in motion()) {
        prop_assume!(direction.length() > 0.1);
        let factor = force(&[1.0, 2.0]).factor(direction.normalize() * (3.0 + gap), [1, 0]).unwrap();
        let (modes, others): ([f64; PairFactor::MODES], _) = (factor.modes(&a), factor.modes(&b));
        let squares: f64 = modes.iter().map(|g| g * g).sum();
        let product: f64 = modes.iter().zip(&others).map(|(g, h)| g * h).sum();
        let scale = squares + others.iter().map(|h| h * h).sum::<f64>();
        prop_assert!((a.power(&factor.loads(&modes)) - squares).abs() < 1e-12 * scale);
        prop_assert!((b.power(&factor.loads(&modes)) - product).abs() < 1e-12 * scale);
    }

    #[test]
    fn the_whole_resistance_is_symmetric(direction in vector(), gap in 1e-4..1.0f64, a in motion(), b in motion()) {
        prop_assume!(direction.length() > 0.1);
        let factor = force(&[1.0, 2.0]).factor(direction.normalize() * (3.0 + gap), [1, 0]).unwrap();
        let (first, second) = (factor.resistance(&a), factor.resistance(&b));
        let scale = a.power(&first).abs() + b.power(&second).abs() + size(&first) + size(&second);
        prop_assert!((b.power(&first) - a.power(&second)).abs() < 1e-12 * scale);
    }

    #[test]
    fn loads_turn_with_the_pair(
        direction in vector(), gap in 1e-4..1.0f64, a in motion(), turn in vector(), angle in 0.0..6.0f64
    ) {
        prop_assume!(direction.length() > 0.1 && turn.length() > 0.1);
        let (force, by) = (force(&[1.0, 2.0]), Tensor::from_axis_angle(turn.normalize(), angle));
        let separation = direction.normalize() * (3.0 + gap);
        let loads = force.loads(separation, [0, 1], &a).unwrap();
        let other = force.loads(by * separation, [0, 1], &turned(&a, by)).unwrap();
        for i in 0..2 {
            prop_assert!((by * loads.force[i] - other.force[i]).length() < 1e-10 * size(&loads));
            prop_assert!((by * loads.torque[i] - other.torque[i]).length() < 1e-10 * size(&loads));
            let moment = Traceless::part_of(&(by * loads.moment[i].tensor() * by.transpose())) - other.moment[i];
            prop_assert!(moment.contract(moment).sqrt() < 1e-10 * size(&loads));
        }
    }

    #[test]
    fn names_of_the_spheres_do_not_matter(direction in vector(), gap in 1e-4..1.0f64, a in motion()) {
        prop_assume!(direction.length() > 0.1);
        let (separation, force) = (direction.normalize() * (3.0 + gap), force(&[1.0, 2.0]));
        let loads = force.loads(separation, [0, 1], &a).unwrap();
        let other = force.loads(-separation, [1, 0], &swapped(&a)).unwrap();
        prop_assert_eq!(loads.force, [other.force[1], other.force[0]]);
        prop_assert_eq!(loads.moment, [other.moment[1], other.moment[0]]);
    }
}

proptest! {
    /// In any order of the spheres, equal or not.
    #[test]
    fn coefficients_give_the_loads(
        direction in vector(), gap in 1e-4..2.0_f64, ratio in prop::sample::select(vec![1.0, 2.0]), order in 0..2_u32,
        mut motion in motion(), strain in prop::array::uniform5(-1.0..1.0_f64),
    ) {
        prop_assume!(direction.length() > 0.1);
        let (force, species) = (force(&[1.0, ratio]), [order, 1 - order]);
        motion.strain_rate = [Traceless(strain); 2];
        let separation = direction.normalize() * (1.0 + ratio + gap);
        let expected = force.loads(separation, species, &motion).unwrap();
        let coefficients = force.coefficients(separation.length(), species).unwrap();
        let found = loads_by(&coefficients, direction.normalize(), order == 1, &motion);
        prop_assert!(size(&(found + times(&expected, -1.0))) < 1e-11 * size(&expected), "{found:?}, not {expected:?}");
    }
}

fn times(loads: &PairLoads, factor: f64) -> PairLoads {
    PairLoads {
        force: loads.force.map(|f| f * factor),
        torque: loads.torque.map(|t| t * factor),
        moment: loads.moment.map(|m| m * factor),
    }
}

/// Loads by the definition of the coefficients, with the direction to the second sphere; the first one is the larger
/// if `is_swapped`.
fn loads_by(c: &Coefficients<f64>, direction: Vector, is_swapped: bool, motion: &PairMotion) -> PairLoads {
    let (z, order) = if is_swapped { (-direction, [1, 0]) } else { (direction, [0, 1]) };
    let product = |a: Vector, b: Vector| Tensor::from_cols(a * b.x, a * b.y, a * b.z);
    let across = |v: Vector| v - z.dot(v) * z;
    let axial = product(z, z) * 3.0 - Tensor::IDENTITY;
    let mut loads = PairLoads::default();
    for k in 0..2 {
        let (mut force, mut torque, mut moment) = (Vector::ZERO, Vector::ZERO, Tensor::ZERO);
        for l in 0..2 {
            let (u, o) = (motion.velocity[order[l]], motion.angular_velocity[order[l]]);
            force += c.xa[k][l] * z.dot(u) * z + c.ya[k][l] * across(u) + c.yb[k][l] * o.cross(z);
            torque += c.xc[k][l] * z.dot(o) * z + c.yc[k][l] * across(o) + c.yb[l][k] * z.cross(u);
            let shear = c.yg[k][l] * across(u) + c.yh[k][l] * o.cross(z);
            moment += axial * (c.xg[k][l] * z.dot(u)) + product(z, shear) + product(shear, z);
        }
        let strain = motion.strain_rate[0].tensor();
        let (stretch, t) = (z.dot(strain * z), across(strain * z));
        force += c.xg_strain[k] * stretch * z + c.yg_strain[k] * t;
        torque += c.yh_strain[k] * z.cross(t);
        moment += strain * c.zm[k]
            + axial * (c.xm_minus_zm_half[k] * stretch)
            + (product(z, t) + product(t, z)) * c.ym_minus_zm[k];
        loads.force[order[k]] = force;
        loads.torque[order[k]] = torque;
        loads.moment[order[k]] = Traceless::part_of(&moment);
    }
    loads
}
