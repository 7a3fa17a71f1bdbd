//! Runs between two walls and above one.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Vector};
use lubrication::two_sphere::{Function, SphereWall};
use std::f64::consts::PI;
use suspension::{Suspension, VELOCITY};

/// A heavy sphere above a wall, from which it is repelled.
const SETTLING: &str = r#"
box = { edges = [12.0, 12.0, 10.0], boundaries = ["periodic", "periodic", "wall"] }
fluid.viscosity = 1.0
gravity.acceleration = [0.0, 0.0, -1.0]
repulsion = { strength = 40.0, range = 0.1 }
particles = { initial = "positions", positions = [[6.0, 6.0, 1.3]] }
time = { step = 0.05, steps = 400 }
[[species]]
radius = 1.0
count = 1
density_difference = 2.0
"#;

/// The sphere rests where the repulsion of the wall balances its weight, `strength (1 - h/(range a))^2 = 4/3 pi 2`,
/// with every integrator.
#[test]
fn a_sphere_comes_to_rest_where_repulsion_bears_its_weight() {
    let weight = 8.0 / 3.0 * PI;
    let rest = 1.0 + 0.1 * (1.0 - (weight / 40.0).sqrt());
    let methods = ["time.integrator=\"implicit\"", "time.integrator=\"adaptive\"", "time.step=0.05"];
    for (method, lubrication) in methods.into_iter().flat_map(|method| [(method, "true"), (method, "false")]) {
        let keys = [method, &format!("hydrodynamics.lubrication={lubrication}")];
        let (height, gap) = ended(&model_of(SETTLING, &keys), 1, |suspension| {
            (suspension.particles().positions[0].z, suspension.report().smallest_gap)
        });
        assert!((height - rest).abs() < 2e-3, "{keys:?}: {height}, not {rest}");
        assert!((gap - (height - 1.0)).abs() < 1e-14, "the smallest gap is that to the wall: {gap}");
    }
}

#[test]
fn a_sphere_that_is_driven_into_a_wall_is_named() {
    let keys = ["repulsion.strength=0.0", "species=[{radius=1.0, count=1, force=[0.0, 0.0, -300.0]}]"];
    let mut suspension = Suspension::start(&model_of(SETTLING, &keys), &Comm::alone()).unwrap();
    let error = (0..400).find_map(|_| suspension.step().err()).expect("it sinks in").to_string();
    assert!(error.contains("particle 0 of radius 1 was driven into a wall: its centre is at z = 0."), "{error}");
    // The state is that before the step.
    assert!(suspension.particles().positions[0].z > 0.85);
}

/// Exact velocities at half-widths of 5 and 2.5 radii.
const POISEUILLE: [f64; 2] = [0.98661734, 0.94530667];

/// Spheres between moving walls.
const SHEARED: &str = r#"
seed = 5
box = { edges = [9.0, 9.0, 10.0], boundaries = ["periodic", "periodic", "walls"] }
fluid.viscosity = 2.0
flow = { kind = "shear", rate = 0.5 }
repulsion = { strength = 20.0, range = 0.1 }
hydrodynamics = { lubrication = true, tolerance = 1e-3, iteration_tolerance = 1e-7 }
time = { step = 0.02, steps = 6 }
[[species]]
radius = 1.0
count = 12
[[species]]
radius = 1.4
count = 4
"#;

#[test]
fn walls_feel_the_stress_of_the_flow_and_of_the_particles() {
    let one = [
        "species=[{radius=1.0, count=1, force=[3.0, 0.0, 0.0]}]",
        "particles={initial=\"positions\", positions=[[4.0, 4.0, 5.0]]}",
        "time.steps=1",
    ];
    let (stress, walls, volume) = ended(&model_of(SHEARED, &one), 1, |suspension| {
        let stress = suspension.stress(1)[0].total();
        (stress, suspension.wall_stress(&stress), suspension.cell().volume())
    });
    // Einstein's stresslet 20/3 pi mu a^3 (rate/2) for a sphere in the middle; walls at 5 radii increase it by about
    // 3%.
    let einstein = 20.0 / 3.0 * PI * 2.0 * 0.25 / volume;
    let found = stress.col(2).x;
    assert!((found / einstein - 1.0).abs() < 0.06, "{found}, not {einstein}");
    let [lower, upper] = [walls[0][0], walls[1][0]];
    // Each wall bears half of the force, which it transmits to the fluid.
    let share = 0.5 * 3.0 / 81.0;
    assert!((lower - (1.0 + found + share)).abs() < 2e-3 && (upper - (1.0 + found - share)).abs() < 2e-3, "{walls:?}");
    assert!((lower - upper - 3.0 / 81.0).abs() < 1e-12);
}

/// Random starts keep clear of the walls, and so do the spheres later.
#[test]
fn spheres_stay_between_the_walls_on_any_ranks() {
    let all = [1, 3, 7].map(|ranks| {
        ended(&model_of(SHEARED, &[]), ranks, |suspension| {
            let gap = suspension.report().smallest_gap;
            (suspension.gathered(None), gap)
        })
    });
    let alone = &all[0].0;
    for (particles, gap) in &all {
        assert!(*gap > 0.0 && (gap - all[0].1).abs() < 1e-6, "{gap}");
        let off = |(x, a): (&Vector, &f64)| x.z > *a && x.z < 10.0 - a;
        assert!(particles.positions.iter().zip(&particles.radii).all(off));
        let error = alone.positions.iter().zip(&particles.positions).map(|(&a, &b)| (a - b).length());
        assert!(error.fold(0.0, f64::max) < 1e-6);
    }
}

/// A run resumed half-way continues bit for bit.
#[test]
fn a_run_between_walls_resumes_bit_for_bit() {
    let model = model_of(SHEARED, &["time.integrator=\"implicit\""]);
    let mut straight = Suspension::start(&model, &Comm::alone()).unwrap();
    (0..3).for_each(|_| straight.step().unwrap());
    let state = straight.state();
    let mut resumed = Suspension::resume(&model, Some(state), &Comm::alone()).unwrap();
    (0..3).for_each(|_| straight.step().unwrap());
    (0..3).for_each(|_| resumed.step().unwrap());
    assert_eq!(straight.gathered(None), resumed.gathered(None));
}

/// With friction a rough sphere on an inclined wall rolls without slipping: the velocity of its lowest point is zero.
#[test]
fn a_rough_sphere_rolls_down_a_tilted_bottom() {
    let rough = [
        "box.edges=[20.0, 20.0, 10.0]",
        "contacts={friction=1.0, stiffness=4000.0, roughness=0.01}",
        "repulsion.strength=0.0",
        "hydrodynamics.lubrication=true",
        "gravity.acceleration=[0.3, 0.0, -1.0]",
        "particles={initial=\"positions\", positions=[[6.0, 6.0, 1.02]]}",
        "time={step=0.01, steps=400}",
    ];
    let at_end = |keys: &[&str]| {
        ended(&model_of(SETTLING, keys), 1, |suspension| {
            let particles = suspension.particles();
            let velocity = particles.clone().vectors(VELOCITY)[0];
            let (turning, height) =
                (particles.clone().vectors(suspension::ANGULAR_VELOCITY)[0], particles.positions[0].z);
            (velocity.x, velocity.x - turning.y * height, height, suspension.contact_numbers().unwrap())
        })
    };
    let (velocity, slip, height, numbers) = at_end(&rough);
    // The power of the weight equals the dissipation of rolling by the exact resistance functions.
    let exact = SphereWall::get().resistance(height - 1.0).unwrap();
    let [force, coupling, torque] = [6.0 * exact[Function::YA], 4.0 * exact[Function::YB], 8.0 * exact[Function::YC]];
    let rolling = 0.3 * 8.0 / 3.0 / (force + 2.0 * coupling / height + torque / (height * height));
    // Images 20 radii away increase the velocity: by 2.2% at 12 radii, and as the inverse square of the distance.
    assert!((velocity / rolling - 1.0).abs() < 0.012, "{velocity}, not {rolling}");
    assert!(slip.abs() < 1e-3 * velocity, "{slip} of {velocity}");
    assert_eq!((numbers[0], numbers[1], numbers[2]), (1.0, 1.0, 0.0), "a contact with friction that does not slide");
    // With almost no friction the sphere slides.
    let smooth = [&rough[2..], &["contacts={friction=0.001, stiffness=4000.0, roughness=0.01}"]].concat();
    let (velocity, slip, ..) = at_end(&smooth);
    assert!(slip > 0.2 * velocity, "{velocity} {slip}");
}

/// Velocity of a free sphere in the mid-plane, over that of the fluid alone in the middle, at half-widths of 5 and 2.5
/// radii; by a single layer with the images of both walls (see `docs/src/walls.md`).
#[test]
fn a_free_sphere_in_poiseuille_flow_moves_as_the_exact_one() {
    for (height, place, expected) in [(10.0, 0.5, POISEUILLE[0]), (5.0, 0.5, POISEUILLE[1])] {
        let keys = [
            "species=[{radius=1.0, count=1}]",
            &format!("box.edges=[16.0, 16.0, {height}]"),
            &format!("particles={{initial=\"positions\", positions=[[4.0, 4.0, {}]]}}", height * place),
            &format!("flow={{kind=\"poiseuille\", pressure_gradient={}}}", 16.0 / (height * height)),
            "time.steps=0",
        ];
        let (velocity, walls) = ended(&model_of(SHEARED, &keys), 1, |suspension| {
            let stress = suspension.stress(1)[0].total();
            (suspension.particles().clone().vectors(VELOCITY)[0], suspension.wall_stress(&stress))
        });
        assert!((velocity.x - expected).abs() < 0.01 * expected, "{height}: {velocity}, not {expected}");
        // Both walls bear the force of the pressure.
        let pushed = 16.0 / height;
        assert!(
            (walls[0][0] - walls[1][0] - pushed).abs() < 1e-12 && (walls[0][0] - 0.5 * pushed).abs() < 1e-3 * pushed
        );
    }
}
