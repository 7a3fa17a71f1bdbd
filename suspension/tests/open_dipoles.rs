//! Spheres with moments in unbounded fluid, and spheres that saturate.

use crate::support::ended::ended;
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, Vector};
use std::f64::consts::PI;
use suspension::{Suspension, VELOCITY};

/// A cluster that moves out of its first box, in a rotating field.
const CLUSTER: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
particles = { initial = "positions", positions = [[1, 1, 1], [3.1, 1, 1], [5.3, 1.2, 1], [1, 3.2, 1.4], [9, 9, 9]] }
hydrodynamics = { tolerance = 1e-4 }
repulsion = { strength = 20.0 }
magnetic = { field = [6.0, 0.0, 0.3], frequency = 2.0, rotation_axis = [0.0, 0.0, 1.0] }
time = { step = 0.05, steps = 6 }
[[species]]
name = "soft"
radius = 1.0
count = 3
magnetic_susceptibility = 14.0
magnetic_saturation = 3.0
[[species]]
name = "hard"
radius = 1.0
count = 2
orientation = "random"
magnetic_moment = 30.0
"#;

fn positions(ranks: usize) -> Vec<Vector> {
    ended(&model_of(CLUSTER, &[]), ranks, |suspension| suspension.gathered(None).positions.into_vec())
}

#[test]
#[ignore = "heavy"]
fn runs_in_open_space_are_resumed_with_the_same_bits() {
    for keys in [&[][..], &["time.integrator=implicit"]] {
        resumes_with_the_same_bits(&model_of(CLUSTER, keys), &format!("{keys:?}"));
    }
}

#[test]
#[ignore = "heavy"]
fn ranks_do_not_matter_in_open_space() {
    let alone = positions(1);
    for ranks in [2, 3] {
        let found = positions(ranks);
        assert!(alone.iter().zip(&found).all(|(a, b)| (*a - *b).length() < 1e-5));
    }
}

/// Two spheres of monopoles in unbounded fluid, in line with a field.
const PAIR: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
hydrodynamics = { tolerance = 1e-6, multipoles = "monopole", lubrication = false }
magnetic = { field = [0.0, 0.0, 1.0] }
time = { step = 0.1, steps = 1 }
"#;

/// Velocity at which the second of two spheres moves away from the first, `distance` below.
fn parting(keys: &[&str], distance: f64) -> f64 {
    let places = format!("particles={{ initial = 'positions', positions = [[0, 0, 0], [0, 0, {distance}]] }}");
    let suspension = Suspension::start(&model_of(PAIR, &[&[&*places], keys].concat()), &Comm::alone()).unwrap();
    let velocities = suspension.particles().columns.iter().find(|column| column.name == VELOCITY).unwrap();
    let velocities: &[Vector] = bytemuck::cast_slice(&velocities.values);
    velocities[1].z - velocities[0].z
}

/// Force between two spheres: their velocity over that under unit forces.
fn force(keys: &[&str], distance: f64) -> f64 {
    let one = |name: &str, force: f64| {
        format!(
            "{{ name = '{name}', radius = 1.0, count = 1, force = [0.0, 0.0, {force:?}], \
             magnetic_susceptibility = 1e-9 }}"
        )
    };
    let pulled = format!("species=[{}, {}]", one("one", -1.0), one("other", 1.0));
    parting(keys, distance) / parting(&[&keys[1..], &[&*pulled]].concat(), distance)
}

/// Permanent moments attract each other as points do, `3 mu_0 m^2 / (2 pi r^4)`, down to contact; there is no image.
#[test]
#[ignore = "heavy"]
fn permanent_moments_have_the_forces_of_points_down_to_contact() {
    let moments = "species=[{ radius = 1.0, count = 2, magnetic_moment = 5.0, orientation = 'aligned', \
                   orientation_axis = [0.0, 0.0, 1.0] }]";
    for distance in [2.001, 2.1, 4.0, 30.0_f64] {
        let found = force(&[moments, "hydrodynamics.multipoles=dipole"], distance);
        let exact = -3.0 * 25.0 / (2.0 * PI * distance.powi(4));
        // The tolerance is relative to the gradient of a sphere's own field.
        let allowed = 1e-4 * exact.abs() + 1e-6 * 25.0 / (4.0 * PI);
        assert!((found - exact).abs() < allowed, "{distance}: {found}, not {exact}");
    }
}

/// In strong fields two spheres have the forces of their largest moments, in weak ones those without saturation.
#[test]
#[ignore = "heavy"]
fn forces_of_spheres_that_saturate_have_both_limits() {
    let species = |saturation: &str| {
        format!("species=[{{ radius = 1.0, count = 2, magnetic_susceptibility = 5.0{saturation} }}]")
    };
    for distance in [2.05, 3.0] {
        let linear = force(&[&species("")], distance);
        let weak = force(&[&species(", magnetic_saturation = 1e6")], distance);
        assert!((weak / linear - 1.0).abs() < 1e-4, "{distance}");
        let strong = force(&[&species(", magnetic_saturation = 1e-4")], distance);
        let moment = 4.0 / 3.0 * PI * 1e-4;
        let exact = -3.0 * moment * moment / (2.0 * PI * distance.powi(4));
        assert!((strong / exact - 1.0).abs() < 1e-3, "{distance}: {strong}, not {exact}");
    }
}
