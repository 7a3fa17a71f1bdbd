//! Particle stress.

use crate::support::model_of;
use domain::{Comm, Tensor, Vector};
use std::f64::consts::PI;
use suspension::{ParticleStress, Suspension};

const SCENE: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 2.0
flow = { kind = "shear", rate = 0.5, lees_edwards = true }
hydrodynamics = { tolerance = 1e-5 }
time = { step = 0.1, steps = 1 }
[[species]]
name = "one"
radius = 1.0
count = 1
[[species]]
name = "other"
radius = 1.5
count = 1
"#;

fn stress(overrides: &[&str], ranks: usize) -> Vec<ParticleStress> {
    let model = model_of(SCENE, overrides);
    let all = Comm::threads(ranks, |comm| Suspension::start(&model, &comm).unwrap().stress(model.species.len()));
    all.into_iter().next().unwrap()
}

fn places(separation: Vector) -> String {
    let [x, y, z] = separation.to_array();
    // The pair lies across two faces of the box.
    let second = (Vector::new(11.8, 11.9, 6.0) + separation).to_array();
    assert!(x * y * z != 0.0);
    format!("particles={{ initial = 'positions', positions = [[11.8, 11.9, 6.0], {second:?}] }}")
}

#[test]
fn one_sphere_gives_einsteins_viscosity() {
    let alone = "species=[{ radius = 1.0, count = 1 }]";
    let total = stress(&[alone, "box.edges=[40, 40, 40]"], 1)[0].total();
    let fraction = 4.0 / 3.0 * PI / 40.0_f64.powi(3);
    let intrinsic = total.col(0)[1] / (2.0 * 0.5 * fraction);
    // Images change it by a multiple of the volume fraction, 6.5e-5.
    assert!((intrinsic - 2.5).abs() < 1e-3, "{intrinsic}");
    assert!((total.col(0)[0] + total.col(1)[1] + total.col(2)[2]).abs() < 1e-12 * total.col(0)[1]);
}

#[test]
fn repulsion_is_minus_the_pair_moment_over_the_volume_on_any_ranks() {
    let separation = 2.55 * Vector::new(0.48, 0.6, 0.64);
    let (reach, contact) = (2.5_f64 * 1.05, 2.5_f64);
    let depth = (reach.powi(2) - 2.55_f64.powi(2)) / (reach.powi(2) - contact.powi(2));
    let force = 7.0 / contact * depth * depth;
    let expected = Tensor::from_cols(separation * separation.x, separation * separation.y, separation * separation.z);
    let expected = expected * (-force / 12.0_f64.powi(3));
    for ranks in [1, 2, 3, 13] {
        let found = stress(&[&places(separation), "repulsion={ strength = 7.0, range = 0.1 }"], ranks);
        for one in &found {
            let difference = one.of("repulsion") * 2.0 - expected;
            assert!(difference.abs_diff_eq(Tensor::ZERO, 1e-12), "{:?} is not {expected:?}", one.of("repulsion"));
        }
    }
}

#[test]
fn lubrication_adds_its_part_on_any_ranks() {
    let near = places(2.51 * Vector::new(0.48, 0.6, 0.64));
    let alone = stress(&[&near, "hydrodynamics.lubrication=true"], 1);
    let without = stress(&[&near], 1);
    assert!(without.iter().all(|s| s.of("lubrication") == Tensor::ZERO && s.of("repulsion") == Tensor::ZERO));
    let viscous = |all: &[ParticleStress]| all.iter().map(|s| s.total().col(0)[1]).sum::<f64>();
    let added: f64 = alone.iter().map(|s| s.of("lubrication").col(0)[1]).sum();
    assert!(added > 0.02 * viscous(&without) && viscous(&alone) > viscous(&without), "{added}");
    for ranks in [2, 3] {
        for (here, there) in alone.iter().zip(&stress(&[&near, "hydrodynamics.lubrication=true"], ranks)) {
            assert!((here.total() - there.total()).abs_diff_eq(Tensor::ZERO, 1e-6 * viscous(&alone)));
        }
    }
}
