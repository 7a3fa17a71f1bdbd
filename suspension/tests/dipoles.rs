//! Spheres with magnetic and electric moments.

use crate::support::ended::ended;
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, Quaternion, Tensor, Vector};
use std::f64::consts::PI;
use suspension::{ANGULAR_VELOCITY, ORIENTATION, Suspension, VELOCITY};

/// A sphere with a permanent moment across the field, in a large box.
const COMPASS: &str = r#"
box.edges = [40.0, 40.0, 40.0]
fluid.viscosity = 1.0
particles = { initial = "positions", positions = [[3.0, 4.0, 5.0]] }
hydrodynamics = { tolerance = 1e-5 }
magnetic = { field = [0.0, 0.0, 2.0], permeability = 3.0 }
time = { step = 0.1, steps = 20 }
[[species]]
radius = 1.0
count = 1
orientation = "aligned"
orientation_axis = [1.0, 0.0, 0.0]
magnetic_moment = 4.0
"#;

/// The angle to the field falls as `tan(angle/2) = tan(angle_0/2) exp(-t mu_0 m H / (8 pi mu a^3))`.
#[test]
fn a_permanent_moment_turns_into_the_field() {
    let angle = ended(&model_of(COMPASS, &[]), 1, |suspension| {
        let particles = suspension.gathered(None);
        let q: &[f64] = &particles.columns.iter().find(|column| column.name == ORIENTATION).unwrap().values;
        Quaternion::from_array([q[0], q[1], q[2], q[3]]).axis().angle_between(Vector::Z)
    });
    let rate = 3.0 * 4.0 * 2.0 / (8.0 * PI);
    let exact = 2.0 * (PI / 4.0).tan().atan2((2.0 * rate).exp());
    // Images slow the rotation by the volume fraction, 7e-5.
    assert!((angle - exact).abs() < 3e-4, "{angle} and {exact}");
}

/// Two susceptible spheres of monopoles, so that forces are those of their velocities.
const PAIR: &str = r#"
box.edges = [60.0, 60.0, 60.0]
fluid.viscosity = 1.0
hydrodynamics = { tolerance = 1e-6, multipoles = "monopole", lubrication = false }
magnetic = { field = [0.0, 0.0, 1.0], permeability = 3.0 }
time = { step = 0.1, steps = 1 }
species = [{ radius = 1.0, count = 2, magnetic_susceptibility = 0.01 }]
"#;

/// In line with the field two moments attract each other by `3 mu_0 m^2 / (2 pi r^4)`, side by side they repel by half
/// of it.
#[test]
fn pairs_attract_in_line_and_repel_side_by_side() {
    let (separation, chi) = (8.0_f64, 0.01);
    for (axis, sign) in [(Vector::Z, -1.0), (Vector::X, 0.5)] {
        let other = Vector::new(20.0, 21.0, 22.0) + axis * separation;
        let places = format!(
            "particles={{ initial = 'positions', positions = [[20, 21, 22], [{}, {}, {}]] }}",
            other.x, other.y, other.z
        );
        let model = model_of(PAIR, &[&places]);
        let suspension = Suspension::start(&model, &Comm::alone()).unwrap();
        let moment = 4.0 * PI * chi / (3.0 + chi);
        let force = 3.0 * 3.0 * moment * moment / (2.0 * PI * separation.powi(4)) * sign;
        let velocities = suspension.particles().columns.iter().find(|column| column.name == VELOCITY).unwrap();
        let velocities: &[Vector] = bytemuck::cast_slice(&velocities.values);
        let approach = (velocities[1] - velocities[0]).dot(axis);
        // Relative mobility of Gaussian forces along the line of centres.
        let mobility = 1.0 / (6.0 * PI) - 1.0 / (4.0 * PI * separation) * (1.0 - 2.0 / (PI * separation.powi(2)));
        let expected = 2.0 * force * mobility;
        assert!((approach / expected - 1.0).abs() < 0.02, "{axis}: {approach} and {expected}");
    }
}

/// Velocity at which the second of two spheres of [`PAIR`], `distance` apart along x, moves away from the first.
fn parting(keys: &[&str], distance: f64) -> f64 {
    let places =
        format!("particles={{ initial = 'positions', positions = [[20, 21, 22], [{}, 21, 22]] }}", 20.0 + distance);
    let model = model_of(PAIR, &[&[&*places][..], keys].concat());
    let suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let velocities = suspension.particles().columns.iter().find(|column| column.name == VELOCITY).unwrap();
    let velocities: &[Vector] = bytemuck::cast_slice(&velocities.values);
    velocities[1].x - velocities[0].x
}

/// Near contact the forces of susceptible spheres are exact: here those over `mu_0 H^2` of 120 multipoles about both
/// centres, by `exact_force` of `scripts/validate dipoles`. Images in the box have fields of 1e-4, and the tangent that
/// ends the table of exact forces at a gap of two radii is some 1e-3 of them.
#[test]
#[ignore = "heavy"]
fn near_pairs_have_the_exact_forces() {
    let in_line = [(1.0, 2.01, -0.429569), (10.0, 2.01, -17.012666), (10.0, 2.5, -1.668789), (1e6, 2.05, -32.367517)];
    let side_by_side = [(1.0, 2.01, 0.118859), (10.0, 2.05, 0.810987), (1e6, 2.5, 0.759057)];
    for (field, cases) in
        [("magnetic.field=[1.0, 0.0, 0.0]", &in_line[..]), ("magnetic.field=[0.0, 1.0, 0.0]", &side_by_side)]
    {
        for &(chi, distance, exact) in cases {
            let species = format!("species=[{{ radius = 1.0, count = 2, magnetic_susceptibility = {chi} }}]");
            let found = parting(&[field, &species], distance);
            // Unit forces that part them, on spheres whose moments have none.
            let pulled = "species=[{ name = 'one', radius = 1.0, count = 1, force = [-1.0, 0.0, 0.0], \
                          magnetic_susceptibility = 1e-9 }, { name = 'other', radius = 1.0, count = 1, \
                          force = [1.0, 0.0, 0.0], magnetic_susceptibility = 1e-9 }]";
            let force = found / parting(&[field, pulled], distance) / 3.0;
            assert!((force / exact - 1.0).abs() < 4e-3, "{chi} at {distance}: {force}, not {exact}");
        }
    }
}

/// The couple of a near pair in an oblique field is that of the field on its moments, those near contact included, and
/// so is the antisymmetric part of the stress.
#[test]
fn the_stress_of_a_near_pair_has_the_torque_of_the_field() {
    let places = "particles={ initial = 'positions', positions = [[20, 21, 22], [21.3, 22.2, 23.2]] }";
    let keys = [
        places,
        "magnetic.field=[0.3, -0.8, 1.1]",
        "species=[{ radius = 1.0, count = 2, magnetic_susceptibility = 8.0 }]",
    ];
    let suspension = Suspension::start(&model_of(PAIR, &keys), &Comm::alone()).unwrap();
    let stress = suspension.stress(1)[0].of("magnetic");
    let twist = Vector::new(
        stress.y_axis.z - stress.z_axis.y,
        stress.z_axis.x - stress.x_axis.z,
        stress.x_axis.y - stress.y_axis.x,
    );
    let vectors = |name: &str| {
        let column = suspension.particles().columns.iter().find(|column| column.name == name).unwrap();
        bytemuck::cast_slice::<f64, Vector>(&column.values).iter().copied().sum::<Vector>()
    };
    let moment = vectors("induced magnetic moment") + vectors("magnetic moment near contact");
    let torque = moment.cross(Vector::new(0.3, -0.8, 1.1)) * 3.0 / 60.0_f64.powi(3);
    assert!(vectors("magnetic moment near contact").length() > 0.1);
    assert!((twist + torque).length() < 1e-4 * torque.length(), "{twist} and {torque}");
}

/// Spheres of both kinds of moments in rotating and alternating fields, in shear.
const MIXED: &str = r#"
seed = 3
box.edges = [9.0, 9.0, 9.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.3 }
hydrodynamics = { tolerance = 1e-4 }
repulsion = { strength = 20.0 }
magnetic = { field = [1.0, 0.0, 0.3], frequency = 2.0, rotation_axis = [0.0, 0.0, 1.0], permeability = 0.7 }
electric = { field = [0.0, 1.0, 0.0], frequency = 3.0, permittivity = 2.0 }
time = { step = 0.05, steps = 4 }
statistics.every = 1
[[species]]
name = "soft"
radius = 1.0
count = 9
magnetic_susceptibility = 4.0
permittivity = 9.0
[[species]]
name = "hard"
radius = 1.4
count = 4
orientation = "random"
magnetic_moment = 9.0
electric_moment = 3.0
"#;

#[test]
#[ignore = "heavy"]
fn runs_are_resumed_with_the_same_bits() {
    for keys in [
        &[][..],
        &["time.integrator=adaptive"],
        &["time.integrator=implicit"],
        &["fluid.thermal_energy=0.1", "time.integrator=brownian"],
    ] {
        resumes_with_the_same_bits(&model_of(MIXED, keys), &format!("{keys:?}"));
    }
}

/// Positions, velocities and stresses at the end.
fn state(keys: &[&str], ranks: usize) -> (Vec<Vector>, Vec<Vector>, [Tensor; 2]) {
    ended(&model_of(MIXED, keys), ranks, |suspension| {
        let mut particles = suspension.gathered(None);
        let stress = suspension.stress(2);
        let sum = |name: &str| stress.iter().fold(Tensor::ZERO, |sum, one| sum + one.of(name));
        let velocities = particles.vectors(VELOCITY).to_vec();
        (particles.positions.into_vec(), velocities, ["magnetic", "electric"].map(sum))
    })
}

fn apart(a: &[Vector], b: &[Vector]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
}

#[test]
fn ranks_do_not_matter() {
    let alone = state(&[], 1);
    for ranks in [2, 3] {
        let found = state(&[], ranks);
        assert!(apart(&alone.0, &found.0) < 1e-5 && apart(&alone.1, &found.1) < 1e-4);
        for (one, other) in alone.2.iter().zip(&found.2) {
            let size = one.to_cols_array().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
            assert!(((*one - *other).to_cols_array()).iter().all(|entry| entry.abs() < 1e-3 * size));
        }
    }
}

/// With fields eight times as large and constants a 64th, forces and motions have the same bits.
#[test]
fn units_of_fields_do_not_matter() {
    let scaled = state(
        &[
            "magnetic.field=[8.0, 0.0, 2.4]",
            "magnetic.permeability=0.0109375",
            "species[1].magnetic_moment=72.0",
            "electric.field=[0.0, 8.0, 0.0]",
            "electric.permittivity=0.03125",
            "species[0].permittivity=0.140625",
            "species[1].electric_moment=0.375",
        ],
        1,
    );
    let usual = state(&[], 1);
    // The field along z is rounded.
    assert!(apart(&usual.0, &scaled.0) < 1e-12 && apart(&usual.1, &scaled.1) < 1e-10);
}

/// The antisymmetric part of the stress balances the torque of the applied field: `sum m x H_0` over the volume.
#[test]
fn the_stress_has_the_torque_of_the_field() {
    let model = model_of(COMPASS, &["box.edges=[12.0, 12.0, 12.0]"]);
    let suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let stress = suspension.stress(1)[0].of("magnetic");
    // mu_0 m x H = 3 * 4 * 2 (x cross z) = -24 y, and the tensor is -A/2 with A v = T x v.
    let exact = 24.0 / 12.0_f64.powi(3);
    let twist = Vector::new(
        stress.y_axis.z - stress.z_axis.y,
        stress.z_axis.x - stress.x_axis.z,
        stress.x_axis.y - stress.y_axis.x,
    );
    assert!((twist - Vector::Y * exact).length() < 1e-4 * exact, "{twist} and {exact}");
    let turning = suspension.particles().columns.iter().find(|column| column.name == ANGULAR_VELOCITY).unwrap();
    let turning: &[Vector] = bytemuck::cast_slice(&turning.values);
    assert!((turning[0].y + 24.0 / (8.0 * PI)).abs() < 0.01);
}
