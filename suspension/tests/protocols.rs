//! Shear rates that change during a run.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Particles, PeriodicBox, Vector};
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

/// Stokes flow is reversible: smooth spheres return to their positions.
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

/// Contacts are irreversible: a rough pair ends up farther apart.
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

/// A table of rates is equivalent to strains of reversal, and a flow that has stopped moves nothing.
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
#[ignore = "heavy"]
fn ranks_agree() {
    let turned = ["flow.reversal_at=[0.8]", OSCILLATION];
    for (method, flow) in METHODS.into_iter().zip([turned[0], turned[1], turned[1]]) {
        // A tolerance that requires a double-precision grid: in single precision the order of the ranks' sums would
        // matter.
        let model = passing(method, &["hydrodynamics.tolerance=1e-7", "time.steps=40", flow]);
        let alone = run(&model, 1);
        for ranks in [2, 7] {
            let together = run(&model, ranks);
            let error = largest(alone.positions.iter().zip(&together.positions).map(|(&a, &b)| a - b));
            assert!(error < 1e-7, "{method}, {ranks} ranks: {error}");
        }
    }
}

/// Resumed at every step, also at a reversal.
#[test]
fn a_resumed_run_has_the_same_bits() {
    let turned = ["flow.reversal_at=[0.2, 0.4]", OSCILLATION];
    for (method, flow) in METHODS.into_iter().flat_map(|method| turned.map(|flow| (method, flow))) {
        let model = passing(method, &[flow, "time.steps=14"]);
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

/// The strain is 0.8 sin(2 t).
const OSCILLATION: &str = r#"flow={kind="shear",oscillation={amplitude=0.8,frequency=2.0}}"#;

/// Smooth spheres return to their positions after each period, and the choice of the origin does not affect the
/// positions in between.
#[test]
#[ignore = "heavy"]
fn smooth_spheres_come_back_after_a_period() {
    let period = std::f64::consts::PI;
    let step = format!("time.step={}", period / 150.0);
    let moved = "particles.positions=[[5.0, 1.6, 6.0], [7.2, 2.6, 6.5], [3.0, 8.0, 2.0]]";
    for method in METHODS {
        let start = passing(method, &[OSCILLATION, &step, "time.steps=1"]);
        let before = Suspension::start(&start, &Comm::alone()).unwrap().gathered(None);
        let at = |steps: &str, keys: &[&str]| run(&passing(method, &[&[OSCILLATION, &step, steps], keys].concat()), 1);
        let [middle, end, later] = ["time.steps=37", "time.steps=150", "time.steps=300"].map(|steps| at(steps, &[]));
        let distance =
            |a: &Particles, b: &Particles| largest(a.positions.iter().zip(&b.positions).map(|(&a, &b)| a - b));
        assert!(distance(&middle, &before) > 0.5);
        let errors = [&end, &later].map(|after| distance(after, &before));
        assert!(errors[0] < 1e-3 && errors[1] < 2.0 * errors[0] + 1e-4, "{method}: {errors:?}");
        let elsewhere = at("time.steps=37", &[moved]);
        let between = |p: &Particles| {
            let strain = 0.8 * (2.0 * 37.0 * period / 150.0).sin();
            let cell = PeriodicBox::sheared(Vector::splat(12.0), strain).unwrap();
            cell.nearest_image(p.positions[1] - p.positions[0])
        };
        let error = (between(&elsewhere) - between(&middle)).length();
        assert!(error < 1e-4, "{method}: {error}");
    }
}

/// Spheres under a given shear stress.
fn under(stress: f64, keys: &[&str]) -> Model {
    let flow = format!(r#"flow={{kind="shear",control="stress",stress={stress}}}"#);
    passing(METHODS[2], &[&[flow.as_str(), "time.tolerance=1e-4"], keys].concat())
}

/// Total shear stress, in a fluid of viscosity 1.
fn shear_stress(suspension: &Suspension) -> f64 {
    suspension.shear()[0] + suspension.stress(1)[0].total().y_axis.x
}

/// The stress at a given rate, when given instead, leads to that rate, also with contacts and repulsion. It stays at
/// its value while the rate changes.
#[test]
fn a_stress_gives_the_rate_that_needed_it() {
    let forces = ["repulsion={strength=20.0,range=0.1}", "contacts={friction=0.5,roughness=0.02,stiffness=1e4}"];
    for keys in [&forces[..0], &forces[..1], &forces[..]] {
        let at_rate = |steps: &str| {
            let keys = [&["flow={kind=\"shear\",rate=0.7}", steps], keys].concat();
            ended(&passing(METHODS[2], &keys), 1, |suspension| shear_stress(suspension))
        };
        let stress = at_rate("time.steps=0");
        let mut suspension = Suspension::start(&under(stress, keys), &Comm::alone()).unwrap();
        let [rate, _] = suspension.shear();
        assert!((rate / 0.7 - 1.0).abs() < 5e-3, "{rate}");
        let (mut time, mut sum) = (0, 0.0);
        for _ in 0..30 {
            suspension.step().unwrap();
            assert!(
                (shear_stress(&suspension) / stress - 1.0).abs() < 0.02,
                "{} not {stress}",
                shear_stress(&suspension)
            );
            (time, sum) = (time + 1, sum + suspension.shear()[0]);
        }
        let mean = suspension.shear()[1] / (0.02 * f64::from(time));
        assert!((sum / f64::from(time) / mean - 1.0).abs() < 0.02, "the strain is the integral of the rate");
    }
}

#[test]
#[ignore = "heavy"]
fn stresses_go_on_after_a_resume_and_on_any_ranks() {
    let keys = ["contacts={friction=0.5,roughness=0.02,stiffness=1e4}", "time.steps=12"];
    let model = under(1.5, &keys);
    let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
    for step in 0..model.steps {
        let mut resumed = Suspension::resume(&model, Some(whole.state()), &Comm::alone()).unwrap();
        assert_eq!(resumed.shear().map(f64::to_bits), whole.shear().map(f64::to_bits));
        whole.step().unwrap();
        resumed.step().unwrap();
        assert_eq!(whole.gathered(None), resumed.gathered(None), "after step {step}");
    }
    let tight = under(1.5, &[&keys[..], &["hydrodynamics.tolerance=1e-7"]].concat());
    let [alone, two, seven] = [1, 2, 7].map(|ranks| run(&tight, ranks));
    for together in [two, seven] {
        let error = largest(alone.positions.iter().zip(&together.positions).map(|(&a, &b)| a - b));
        assert!(error < 1e-7, "{error}");
    }
}
