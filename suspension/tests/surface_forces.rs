//! Attraction and screened repulsion.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::Vector;
use lubrication::SurfaceForce;

/// A pair with attraction and repulsion that comes to rest.
const PAIR: &str = r#"
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
repulsion = { strength = 40.0, screening_length = 0.02, radius_power = 1 }
particles = { initial = "positions", positions = [[6.0, 7.0, 7.0], [8.4, 7.0, 7.0]] }
time = { step = 0.05, steps = 600, integrator = "implicit" }
[[species]]
radius = 1.0
count = 1
[[species]]
radius = 1.3
count = 1
"#;

const ATTRACTIONS: [(&str, SurfaceForce); 2] = [
    (
        r#"attraction={kind="van-der-waals",hamaker=0.05}"#,
        SurfaceForce::VanDerWaals { hamaker: 0.05, closest: 0.01, range: 1.0 },
    ),
    (
        r#"attraction={kind="depletion",osmotic_pressure=10.0,depletant_radius=0.2}"#,
        SurfaceForce::Depletion { pressure: 10.0, thickness: 0.2 },
    ),
];

const METHODS: [&str; 3] =
    ["hydrodynamics.lubrication=true", "hydrodynamics.lubrication=false", "time={step=0.03,steps=1000}"];

#[test]
#[ignore = "heavy"]
fn a_pair_comes_to_rest_where_its_forces_balance() {
    let radii = [1.0, 1.3];
    let repulsion = SurfaceForce::Screened { strength: 40.0, radius_power: 1, length: 0.02 };
    for (key, attraction) in ATTRACTIONS {
        let sum = |gap: f64| {
            let apart = Vector::X * (2.3 + gap);
            (repulsion.force(apart, radii) + attraction.force(apart, radii)).x
        };
        // Repulsion dominates at contact, attraction farther out.
        let (mut near, mut far) = (0.0, 0.15);
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            if sum(middle) < 0.0 { near = middle } else { far = middle }
        }
        for (k, method) in METHODS.into_iter().enumerate() {
            if k == 2 && key.contains("depletion") {
                continue;
            }
            let (gap, stress) = ended(&model_of(PAIR, &[key, method]), 1, |suspension| {
                let places = suspension.gathered(None).positions;
                let stress = suspension
                    .stress(2)
                    .into_iter()
                    .map(|stress| ["repulsion", "attraction"].map(|name| stress.of(name)));
                ((places[1] - places[0]).length() - 2.3, stress.reduce(|a, b| [a[0] + b[0], a[1] + b[1]]).unwrap())
            });
            assert!((gap - near).abs() < 0.01 * near, "{key} {method}: {gap} is not {near}");
            let [repelled, attracted] = stress.map(|stress| stress.x_axis.x);
            assert!(repelled < 0.0 && (repelled / attracted + 1.0).abs() < 0.05, "{repelled} {attracted}");
        }
    }
}

#[test]
fn ranks_agree() {
    let keys = [ATTRACTIONS[0].0, METHODS[0], "hydrodynamics.tolerance=1e-7", "time.steps=20"];
    let places = |ranks| ended(&model_of(PAIR, &keys), ranks, |suspension| suspension.gathered(None).positions);
    let alone = places(1);
    for ranks in [2, 7] {
        let error = places(ranks).iter().zip(&alone).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max);
        assert!(error < 1e-8, "{ranks} ranks: {error}");
    }
}
