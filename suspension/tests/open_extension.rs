//! Extensional flows of unbounded fluid.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Boundaries, Bytes, Comm, PeriodicBox, Tensor, Vector};
use fcm::Loads;
use lubrication::LubricationRange;
use std::f64::consts::PI;
use suspension::{Extension, Mobility, MobilityParameters, Model, Suspension};

/// Spheres of two sizes that the flow separates; the box follows.
const DRAWN: &str = r#"
seed = 2
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.5
flow = { kind = "planar-extension", rate = 0.8 }
repulsion = { strength = 20.0, range = 0.1 }
hydrodynamics = { lubrication = true, tolerance = 1e-3, iteration_tolerance = 1e-8 }
particles = { initial = "cloud", radius = 4.5 }
time = { step = 0.1, steps = 12, ADVANCE }
[[species]]
radius = 1.0
count = 9
force = [0.1, 0.0, -2.0]
[[species]]
radius = 1.5
count = 2
"#;

const METHODS: [&str; 3] = ["order = 4", r#"integrator = "adaptive""#, r#"integrator = "implicit""#];

/// Each kind with its key in a scene.
const KINDS: [(Extension, &str); 3] = [
    (Extension::Planar, r#"flow.kind="planar-extension""#),
    (Extension::Uniaxial, r#"flow.kind="uniaxial-extension""#),
    (Extension::Biaxial, r#"flow.kind="biaxial-extension""#),
];

fn drawn(method: &str, keys: &[&str]) -> Model {
    model_of(&DRAWN.replace("ADVANCE", method), keys)
}

/// Free spheres of radius 1 at given positions.
fn free(method: &str, places: &[[f64; 3]], keys: &[&str]) -> Model {
    let all = [
        format!("species=[{{radius=1.0, count={}}}]", places.len()),
        format!("particles={{initial=\"positions\", positions={places:?}}}"),
        "hydrodynamics.tolerance=1e-4".to_owned(),
    ];
    let keys: Vec<&str> = all.iter().map(String::as_str).chain(keys.iter().copied()).collect();
    drawn(method, &keys)
}

/// An isolated sphere moves with the flow at any position, without angular velocity and with the stresslet
/// `20/3 pi mu a^3 E`, for any step length and also with changes of the rate.
#[test]
fn a_sphere_alone_goes_with_the_flow() {
    let start = [3.0, 50.0, -7.0];
    let protocols = [("flow.rate=0.4", 0.48, 0.4), ("flow.rate=[[0.0, 0.4], [0.6, -0.2]]", 0.12, -0.2)];
    for ((kind, flow), method) in KINDS.into_iter().flat_map(|kind| METHODS.map(|method| (kind, method))) {
        for (rate, strain, last) in protocols {
            let model = free(method, &[start], &[flow, rate, "time.step=0.3", "time.steps=4"]);
            let (place, spin, velocity, stresslet) = ended(&model, 1, |suspension| {
                let mut all = suspension.gathered(None);
                let stresslet: [f64; 5] = all.column("stresslet", 5).values[..].try_into().unwrap();
                (all.positions[0], all.vectors("angular_velocity")[0], all.vectors("velocity")[0], stresslet)
            });
            let rates = kind.rates();
            let exact = kind.stretch(strain) * Vector::from_array(start);
            // Tolerance of the velocity of the flow over a radius, amplified by the flow farther out.
            assert!((place - exact).length() < 1e-3, "{flow} {method}: {place}, not {exact}");
            assert!((velocity - last * rates * place).length() < 1e-4, "{flow} {method}: {velocity}");
            assert!(spin.length() < 1e-4 * 0.4, "{flow} {method}: {spin}");
            let expected = 20.0 / 3.0 * PI * 1.5 * last * rates;
            let found = domain::Traceless(stresslet).tensor();
            let error = found - Tensor::from_diagonal(expected);
            assert!(
                error.col(0).length() + error.col(1).length() < 1e-3 * expected.length(),
                "{flow} {method}: {found}"
            );
        }
    }
}

/// The motion of a pair relative to the flow equals that of the mobility at the same positions, to the tolerance of the
/// flow over a radius.
#[test]
fn a_pair_moves_as_its_mobility_says() {
    let axis = Vector::new(2.0, 1.0, 2.0) / 3.0;
    for (kind, flow) in KINDS {
        for gap in [0.01, 1.0] {
            let places = [Vector::new(4.0, -3.0, 1.0), Vector::new(4.0, -3.0, 1.0) + axis * (2.0 + gap)];
            let model = free(
                METHODS[0],
                &places.map(|x| x.to_array()),
                &[flow, "repulsion.strength=0.0", "hydrodynamics.tolerance=1e-5"],
            );
            let run = Suspension::start(&model, &Comm::alone()).unwrap();
            let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap().with_boundaries(Boundaries::Open).unwrap();
            let lubrication = Some(LubricationRange::default());
            let usual = MobilityParameters::new(cell, 1.5, vec![1.0; 2]);
            let parameters = MobilityParameters { tolerance: 1e-5, lubrication, ..usual };
            let mut mobility = Mobility::new(parameters, Bytes::default(), &Comm::alone()).unwrap();
            mobility.place(&places).unwrap();
            let expected = mobility.apply(&Loads::default(), &kind.flow(0.8)).unwrap().motion.velocities;
            for (found, expected) in run.velocities_in_flow().iter().zip(&expected) {
                let error = (*found - *expected).length();
                assert!(error < 1e-5 * 0.8, "{flow}, gap {gap}: {found} is not {expected}");
            }
            assert!(expected[0].length() > 0.02 && (expected[0] + expected[1]).length() < 1e-5);
        }
    }
}

#[test]
#[ignore = "heavy"]
fn ranks_agree_in_open_extension() {
    for (method, (_, flow)) in METHODS.into_iter().zip(KINDS) {
        let model = drawn(method, &[flow, "time.steps=8"]);
        let all = [1, 2, 3, 7]
            .map(|ranks| ended(&model, ranks, |suspension| (suspension.gathered(None), suspension.cell().edges())));
        let (alone, edges) = &all[0];
        let first = Suspension::start(&model, &Comm::alone()).unwrap().cell().edges();
        assert!(*edges != first, "the box has changed with the flow: {edges}");
        for (particles, own) in &all {
            let errors = alone.positions.iter().zip(&particles.positions).map(|(a, b)| (a - b).length());
            assert!(own == edges && errors.fold(0.0, f64::max) < 1e-6, "{flow}");
        }
    }
}

/// Resumed at any step, also at a change of the rate.
#[test]
#[ignore = "heavy"]
fn a_resumed_run_has_the_same_bits() {
    for (method, (_, flow)) in METHODS.into_iter().zip(KINDS) {
        for rate in
            ["flow.rate=[[0.0, 0.8], [0.3, -0.5]]", "flow={kind=\"KIND\", oscillation={amplitude=0.4, frequency=2.0}}"]
        {
            let rate = rate.replace("KIND", flow.trim_start_matches("flow.kind=\"").trim_end_matches('"'));
            let model = drawn(method, &[flow, &rate, "time.steps=6"]);
            let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
            for step in 0..model.steps {
                let mut resumed = Suspension::resume(&model, Some(whole.state()), &Comm::alone()).unwrap();
                assert_eq!(resumed.shear().map(f64::to_bits), whole.shear().map(f64::to_bits));
                whole.step().unwrap();
                resumed.step().unwrap();
                assert_eq!(whole.gathered(None), resumed.gathered(None), "{flow}, {method}, after step {step}");
            }
        }
    }
}

/// Smooth spheres without forces return to their positions when the flow is reversed.
#[test]
fn spheres_come_back_when_the_flow_is_reversed() {
    let places = [[0.0, 4.0, 0.0], [0.7, -4.0, 0.5], [5.0, 1.0, 3.0]];
    for (_, flow) in KINDS {
        let keys = [
            flow,
            "flow.rate=0.8",
            "flow.reversal_at=[0.8]",
            "time.step=0.02",
            "time.steps=100",
            "repulsion.strength=0.0",
        ];
        let model = free("order = 4", &places, &keys);
        let found = ended(&model, 1, |suspension| suspension.gathered(None).positions);
        let errors = found.iter().zip(places).map(|(&x, start)| (x - Vector::from_array(start)).length());
        assert!(errors.fold(0.0, f64::max) < 1e-3, "{flow}: {found:?}");
    }
}
