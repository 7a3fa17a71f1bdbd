//! Mobility between walls and in open space.

use domain::{AxisRotation, Boundaries, Bytes, Comm, PeriodicBox, Tensor, Traceless, Vector};
use fcm::Loads;
use lubrication::LubricationRange;
use solver::BackgroundFlow;
use std::f64::consts::PI;
use suspension::{Mobility, MobilityParameters, Motions};

const RADIUS: f64 = 1.0;

fn parameters(edges: [f64; 3], boundaries: Boundaries, count: usize) -> MobilityParameters {
    let cell = PeriodicBox::new(Vector::from_array(edges)).unwrap();
    MobilityParameters::new(cell.with_boundaries(boundaries).unwrap(), 1.0, vec![RADIUS; count])
}

fn planned(parameters: MobilityParameters) -> Mobility {
    Mobility::new(parameters, Bytes::default(), &Comm::alone()).unwrap()
}

fn shear(rate: f64) -> BackgroundFlow {
    BackgroundFlow::with_gradient(Tensor::from_cols(Vector::ZERO, Vector::ZERO, Vector::X * rate)).unwrap()
}

/// A free sphere a quarter of the way between walls, in Couette and Poiseuille flow. The exact velocities are 0.24243
/// of the upper wall's and 0.71325 of the centre's; without the walls' effect on the stresslet they would be 0.25 and
/// 0.75. The force-coupling method is within 7e-4 and 4e-3.
#[test]
fn one_sphere_in_the_flows_between_walls() {
    let (height, place) = (8.0, 2.0);
    let mut mobility =
        planned(MobilityParameters { tolerance: 1e-4, ..parameters([40.0, 40.0, height], Boundaries::Walls, 1) });
    mobility.place(&[Vector::new(3.0, 7.0, place)]).unwrap();
    let none = Loads::default();
    let slip = |motions: Motions| motions.motion.velocities[0].x;
    let couette = slip(mobility.apply(&none, &shear(1.0 / height)).unwrap()) + place / height;
    assert!((couette - 0.242_417_58).abs() < 1e-3 * couette, "{couette}");
    mobility.drive(Vector::new(-8.0 / (height * height), 0.0, 0.0)).unwrap();
    let driven = slip(mobility.apply(&none, &BackgroundFlow::NONE).unwrap());
    let poiseuille = driven + 4.0 * place * (height - place) / (height * height);
    assert!((poiseuille - 0.713_250_22).abs() < 1e-2 * poiseuille, "{poiseuille}");
}

/// A free lubricated sphere in Poiseuille flow of unit velocity at the centre, along x, along y and between them:
/// height over channel height, radius over height, and the exact velocity and angular velocity (by a single layer with
/// the images of both walls, see `docs/src/walls.md`).
#[test]
fn a_lubricated_sphere_in_poiseuille_flow_moves_as_the_exact_one() {
    let exact = [
        (0.5, 0.2, [0.986_617_34, 0.0]),
        (0.5, 0.5, [0.912_822_06, 0.0]),
        (0.25, 0.2, [0.745_609_95, 0.049_887_674]),
        (0.25, 0.5, [0.713_250_22, 0.121_003_97]),
        (0.25, 0.8, [0.622_225_95, 0.174_597_15]),
    ];
    let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    for (part, over_place, [velocity, turning]) in exact {
        let (place, height) = (RADIUS / over_place, RADIUS / over_place / part);
        let usual = parameters([24.0, 24.0, height], Boundaries::Walls, 1);
        let mut mobility = planned(MobilityParameters { lubrication, ..usual });
        mobility.place(&[Vector::new(3.0, 7.0, place)]).unwrap();
        for along in [Vector::X, Vector::Y, Vector::new(0.6, -0.8, 0.0)] {
            mobility.drive(along * (-8.0 / (height * height))).unwrap();
            let Motions { motion, stresslets, .. } = mobility.apply(&Loads::default(), &BackgroundFlow::NONE).unwrap();
            let across = Vector::Z.cross(along);
            let moved = motion.velocities[0] + along * (4.0 * part * (1.0 - part));
            let turned = motion.angular_velocities[0] + across * (2.0 * (1.0 - 2.0 * part) / height);
            assert!((moved - along * velocity).length() < 0.01 * velocity, "{part} {over_place}: {moved}");
            // Near a wall the far field lacks the effect of a curved flow on the rotation.
            let allowed = if over_place > 0.5 { 0.035 } else { 0.01 };
            assert!((turned - across * turning).length() < allowed * turning.max(0.1), "{part} {over_place}: {turned}");
            // The largest component is in the plane of flow and wall normal, if the flow has a strain rate there.
            let by_flow = stresslets[0].tensor() * Vector::Z;
            assert!(part > 0.4 || by_flow.dot(along) > 10.0 * by_flow.dot(across).abs());
        }
    }
}

/// Walls across x and across y, with rotated positions of the same spheres.
#[test]
fn any_axis_may_be_the_special_one() {
    let positions = [Vector::new(2.0, 3.0, 1.2), Vector::new(5.0, 3.5, 4.0), Vector::new(2.5, 6.0, 5.5)];
    let loads = Loads {
        forces: vec![Vector::new(1.0, -0.5, 0.3), Vector::new(0.2, 0.1, -1.0), Vector::ZERO],
        torques: vec![Vector::new(0.1, 0.4, 0.2), Vector::ZERO, Vector::new(-0.3, 0.0, 0.6)],
        stresslets: Vec::new(),
    };
    let own = || planned(parameters([9.0, 10.0, 7.0], Boundaries::Walls, 3));
    let mut mobility = own();
    mobility.place(&positions).unwrap();
    let expected = mobility.apply(&loads, &shear(0.3)).unwrap();
    for axis in [0, 1] {
        let turn = AxisRotation::to_last(axis);
        let back = turn.inverse();
        let vectors = |list: &[Vector]| list.iter().map(|&v| back.vector(v)).collect::<Vec<_>>();
        let mut mobility = own().turned(turn);
        mobility.place(&vectors(&positions)).unwrap();
        let turned = Loads { forces: vectors(&loads.forces), torques: vectors(&loads.torques), stresslets: Vec::new() };
        let flow = BackgroundFlow::with_gradient(back.tensor(&shear(0.3).gradient())).unwrap();
        let found = mobility.apply(&turned, &flow).unwrap();
        assert_eq!(found.motion.velocities, vectors(&expected.motion.velocities));
        assert_eq!(found.motion.angular_velocities, vectors(&expected.motion.angular_velocities));
        let stresslets: Vec<Traceless> = expected.stresslets.iter().map(|&s| back.traceless(s)).collect();
        for (found, expected) in found.stresslets.iter().zip(stresslets) {
            assert!(found.0.iter().zip(expected.0).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }
}

/// At any position a sphere has Stokes' velocity, and a net force is possible.
#[test]
fn open_space_has_no_places() {
    let mut mobility = planned(parameters([4.0; 3], Boundaries::Open, 1));
    for place in [Vector::ZERO, Vector::new(1e3, -70.0, 5.0)] {
        mobility.place(&[place]).unwrap();
        let loads = Loads { forces: vec![Vector::new(0.0, 2.0, 0.0)], ..Loads::default() };
        let motions = mobility.apply(&loads, &BackgroundFlow::NONE).unwrap();
        let speed = motions.motion.velocities[0].y * 6.0 * PI / 2.0;
        assert!((speed - 1.0).abs() < 1e-3, "{speed}");
    }
}

/// Random motions and drift are in the caller's axes: normal to walls, along x, random motions are smaller, and the
/// drift is away from the wall.
#[test]
fn random_motions_near_walls_are_in_the_axes_of_the_caller() {
    let mut mobility = planned(parameters([9.0, 10.0, 7.0], Boundaries::Walls, 1)).turned(AxisRotation::to_last(0));
    mobility.place(&[Vector::new(1.3, 0.0, 0.0)]).unwrap();
    let (motions, _) = mobility.noise(1, 0..100).unwrap();
    let square = |axis: usize| motions.iter().map(|motion| motion.velocities[0][axis].powi(2)).sum::<f64>();
    assert!(square(0) < 0.7 * square(1) && square(0) < 0.7 * square(2), "{} {} {}", square(0), square(1), square(2));
    let drifts = mobility.drift(1, 0..100).unwrap();
    let mean = drifts.iter().map(|drift| drift.velocities[0]).sum::<Vector>() / 100.0;
    assert!(mean.x > 0.01 && mean.x > 5.0 * mean.y.abs() && mean.x > 5.0 * mean.z.abs(), "{mean}");
}

#[test]
fn what_walls_do_not_allow_is_refused() {
    let mut mobility = planned(parameters([9.0, 10.0, 7.0], Boundaries::Walls, 1)).turned(AxisRotation::to_last(0));
    let error = mobility.place(&[Vector::new(0.5, 0.0, 0.0)]).unwrap_err().to_string();
    assert!(error.contains("sphere 0 of radius 1 is at x = 0.5") && error.contains("from 0.85"), "{error}");
    mobility.place(&[Vector::new(3.5, 0.0, 0.0)]).unwrap();
    let along = BackgroundFlow::shear(1.0);
    let error = mobility.apply(&Loads::default(), &along).unwrap_err().to_string();
    assert!(error.contains("du/dx"), "{error}");
    let error = mobility.drive(Vector::X).unwrap_err().to_string();
    assert!(error.contains("across the walls, along x"), "{error}");
    let mut above = planned(parameters([9.0; 3], Boundaries::Wall, 1));
    assert!(above.drive(Vector::X).unwrap_err().to_string().contains("between two walls"));
}

/// A swimmer alone in unbounded fluid has the velocity and the stresslet by which its slip is given, in the caller's
/// axes, and rests when it has no slip any more.
#[test]
fn a_swimmer_alone_has_its_own_velocity_and_stresslet() {
    let usual = parameters([10.0; 3], Boundaries::Open, 1);
    let turn = AxisRotation::to_last(0);
    let mut mobility = planned(MobilityParameters { swimming: true, ..usual.clone() }).turned(turn);
    let (velocity, stresslet) = (Vector::new(0.4, -0.7, 0.2), Traceless([1.0, -2.0, 0.5, 3.0, -0.3]));
    mobility.place(&[Vector::new(1.0, 2.0, 3.0)]).unwrap();
    mobility.swim(&[velocity], &[stresslet]).unwrap();
    let moved = mobility.apply(&Loads::default(), &BackgroundFlow::NONE).unwrap();
    assert!((moved.motion.velocities[0] - velocity).length() < 1e-3, "{moved:?}");
    let rest = moved.stresslets[0] - stresslet;
    assert!(rest.contract(rest).sqrt() < 5e-3, "{moved:?}");
    mobility.swim(&[], &[]).unwrap();
    let still = mobility.apply(&Loads::default(), &BackgroundFlow::NONE).unwrap();
    assert_eq!(still.motion.velocities[0], Vector::ZERO);
    let refused = planned(usual.clone()).swim(&[velocity], &[]).unwrap_err().to_string();
    assert_eq!(refused, "slip is given, but swimming is false; set it to true");
    let soft = MobilityParameters { swimming: true, rigid: false, ..usual };
    let refused = Mobility::new(soft, Bytes::default(), &Comm::alone()).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|text| text.starts_with("swimming needs rigid spheres")));
}
