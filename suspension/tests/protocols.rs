//! Rates of shear that change in the course of a run.

#[path = "support/ended.rs"]
mod ended;
mod support;

use domain::{Comm, Particles, Vector};
use ended::ended;
use support::model_of;
use suspension::{Model, Suspension};

/// Spheres that pass each other closely in a shear flow that is reversed, one across the faces of the box.
const PASSING: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 2.0, reversal_at = [1.2] }
hydrodynamics = { lubrication = true, tolerance = 1e-5, iteration_tolerance = 1e-9 }
particles = { initial = "positions", positions = [[5.0, 11.6, 6.0], [7.2, 0.6, 6.5], [3.0, 6.0, 2.0]] }
time = { step = 0.02, steps = 60, ADVANCE }
[[species]]
radius = 1.0
count = 3
"#;

const METHODS: [&str; 3] =
    ["order = 4", r#"integrator = "adaptive", tolerance = 1e-6"#, r#"integrator = "implicit", tolerance = 1e-6"#];

fn passing(method: &str, keys: &[&str]) -> Model {
    model_of(&PASSING.replace("ADVANCE", method), keys)
}

fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

fn largest(vectors: impl Iterator<Item = Vector>) -> f64 {
    vectors.map(Vector::length).fold(0.0, f64::max)
}

/// Stokes flow is reversible: smooth spheres come back to where they were.
#[test]
fn smooth_spheres_come_back_when_the_flow_is_reversed() {
    for method in METHODS {
        let model = passing(method, &[]);
        let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
        let before = suspension.gathered(None);
        let mut farthest = 0.0_f64;
        for _ in 0..model.steps {
            suspension.step().unwrap();
            let now = suspension.gathered(None).positions;
            farthest = farthest.max(largest(now.iter().zip(&before.positions).map(|(&a, &b)| a - b)));
        }
        assert!((suspension.shear()[0] + 2.0).abs() < 1e-15);
        assert!(suspension.shear()[1].abs() < 1e-12 && farthest > 0.5, "strain {}", suspension.shear()[1]);
        let after = suspension.gathered(None);
        let error = largest(after.positions.iter().zip(&before.positions).map(|(&a, &b)| a - b));
        assert!(error < 2e-4, "{method}: {error}");
        assert_eq!(after.steps, before.steps);
    }
}

/// What touched does not come back: the pair is left farther apart.
#[test]
fn rough_spheres_do_not_come_back() {
    let positions = "particles.positions=[[5.0, 6.4, 6.0], [7.0, 5.6, 6.0], [1.0, 1.0, 1.0]]";
    let with = |key: &str| {
        let keys = [positions, "flow.rate=1.0", "flow.reversal_at=[2.0]", "time.steps=200", key];
        let model = passing(r#"integrator = "implicit""#, &keys);
        let places = run(&model, 1).positions;
        (places[1] - places[0] - Vector::new(2.0, -0.8, 0.0)).length()
    };
    let [smooth, rough] = [with("time.tolerance=1e-5"), with("contacts={friction=0.5,roughness=0.02,stiffness=1e5}")];
    assert!(smooth < 0.03 && rough > 0.5, "{smooth} {rough}");
}

/// A table says the same as strains of reversal, and a flow that stops moves nothing.
#[test]
fn a_table_of_rates_is_followed() {
    let reversed = run(&passing(METHODS[0], &[]), 1);
    let table = passing(METHODS[0], &["flow={kind=\"shear\",rate=[[0.0,2.0],[0.6,-2.0]]}"]);
    assert_eq!(run(&table, 1), reversed);
    let stopped = passing(METHODS[0], &["flow={kind=\"shear\",rate=[[0.0,2.0],[0.2,0.0]]}", "time.steps=20"]);
    let [at_stop, later] = [10, 20].map(|steps| {
        let mut suspension = Suspension::start(&stopped, &Comm::alone()).unwrap();
        (0..steps).for_each(|_| suspension.step().unwrap());
        suspension.gathered(None).positions
    });
    assert!(largest(at_stop.iter().zip(&later).map(|(&a, &b)| a - b)) < 1e-12);
}

#[test]
fn ranks_agree() {
    for method in METHODS {
        // A tolerance that needs a grid in f64: in f32 the order of the ranks' sums would show.
        let tight = ["hydrodynamics.tolerance=1e-7", "time.steps=40", "flow.reversal_at=[0.8]"];
        let model = passing(method, &tight);
        let alone = run(&model, 1);
        for ranks in [2, 7] {
            let together = run(&model, ranks);
            let error = largest(alone.positions.iter().zip(&together.positions).map(|(&a, &b)| a - b));
            assert!(error < 1e-7, "{method}, {ranks} ranks: {error}");
        }
    }
}

/// Resumed on any step, that of the reversal too.
#[test]
fn a_resumed_run_has_the_same_bits() {
    for method in METHODS {
        let model = passing(method, &["flow.reversal_at=[0.2, 0.4]", "time.steps=14"]);
        let comm = Comm::alone();
        let mut whole = Suspension::start(&model, &comm).unwrap();
        for step in 0..model.steps {
            let mut resumed = Suspension::resume(&model, Some(whole.state()), &comm).unwrap();
            assert_eq!(resumed.shear().map(f64::to_bits), whole.shear().map(f64::to_bits));
            whole.step().unwrap();
            resumed.step().unwrap();
            assert_eq!(whole.gathered(None), resumed.gathered(None), "{method}, after step {step}");
        }
    }
}
