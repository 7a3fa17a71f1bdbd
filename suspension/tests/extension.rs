//! Extensional flows in boxes that repeat indefinitely.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Particles, Tensor, Vector};
use suspension::{Extension, Model, Suspension};

/// Spheres that pass each other closely, one across the faces of the box.
const PASSING: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
flow = { kind = "planar-extension", rate = 1.0 }
hydrodynamics = { lubrication = true, tolerance = 1e-5, iteration_tolerance = 1e-9 }
particles = { initial = "positions", positions = [[5.0, 1.6, 6.0], [5.6, -0.9, 6.5], [3.0, 6.0, 2.0]] }
time = { step = 0.02, steps = 40, ADVANCE }
[[species]]
radius = 1.0
count = 3
"#;

const METHODS: [&str; 3] =
    ["order = 4", r#"integrator = "adaptive", tolerance = 1e-6"#, r#"integrator = "implicit", tolerance = 1e-6"#];

/// Each kind with its key in a scene.
const KINDS: [(Extension, &str); 3] = [
    (Extension::Planar, r#"flow.kind="planar-extension""#),
    (Extension::Uniaxial, r#"flow.kind="uniaxial-extension""#),
    (Extension::Biaxial, r#"flow.kind="biaxial-extension""#),
];

const CONTACTS: &str = "contacts={friction=0.5,roughness=0.02,stiffness=1e4}";

fn passing(method: &str, keys: &[&str]) -> Model {
    model_of(&PASSING.replace("ADVANCE", method), keys)
}

/// One sphere and its images.
fn alone(method: &str, keys: &[&str]) -> Model {
    let text = PASSING.replace("ADVANCE", method).replace("lubrication = true, ", "").replace("count = 3", "count = 1");
    let all = "[[5.0, 1.6, 6.0], [5.6, -0.9, 6.5], [3.0, 6.0, 2.0]]";
    model_of(&text.replace(all, "[[4.0, 3.0, 2.0]]"), keys)
}

/// Velocities relative to the flow, in the order of the ids.
fn relative(suspension: &Suspension) -> Vec<Vector> {
    let velocities = suspension.velocities_in_flow();
    let mut all: Vec<_> = suspension.particles().ids.iter().zip(velocities).collect();
    all.sort_by_key(|(id, _)| **id);
    all.into_iter().map(|(_, velocity)| velocity).collect()
}

fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

fn largest(vectors: impl Iterator<Item = Vector>) -> f64 {
    vectors.map(Vector::length).fold(0.0, f64::max)
}

/// The unwrapped position is stretched by the flow, through more than 12 periods of the lattice, up to round-off
/// amplified by the flow.
#[test]
fn a_single_sphere_is_carried_by_the_flow() {
    for ((kind, flow), method) in KINDS.into_iter().flat_map(|kind| METHODS.map(|method| (kind, method))) {
        let keys = ["hydrodynamics={multipoles=\"monopole\"}", "time.step=0.05", "time.steps=240", flow];
        let model = alone(method, &keys);
        let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
        for step in 1..=model.steps {
            suspension.step().unwrap();
            let strain = 0.05 * step as f64;
            let stretch = kind.stretch(strain);
            let particles = suspension.particles();
            let found = particles.positions[0] + suspension.cell().lattice(particles.steps[0]);
            let exact = stretch * Vector::new(4.0, 3.0, 2.0);
            let off = (found - exact).length() / stretch.x;
            assert!(off < 1e-12, "{flow}, {method}, strain {strain}: {found} is not {exact}");
        }
        assert!((suspension.shear()[1] - 12.0).abs() < 1e-12);
    }
}

/// A sphere far from its images increases the viscosity by 2.5 times its volume fraction in any flow; images change
/// this by about a hundredth.
#[test]
fn a_dilute_suspension_has_the_viscosity_of_einstein() {
    let fraction = 4.0 / 3.0 * std::f64::consts::PI / 20.0_f64.powi(3);
    for flow in KINDS.map(|(_, flow)| flow).into_iter().chain([r#"flow.kind="shear""#]) {
        let model = alone("order = 2", &["box.edges=[20.0,20.0,20.0]", "time.steps=9", flow, "flow.rate=0.7"]);
        let driving = ended(&model, 1, |suspension| model.flow.driving_stress(&suspension.stress(1)[0].total(), 1));
        assert!((driving / 0.7 / (2.5 * fraction) - 1.0).abs() < 0.01, "{flow}: {driving}");
    }
}

/// Just after the start the box takes other vectors of the same lattice; the motions do not change.
#[test]
fn other_vectors_of_the_lattice_change_nothing() {
    let model = passing("order = 2", &["time.step=1e-8", "time.steps=1"]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let velocities = |suspension: &Suspension| suspension.gathered(None).vectors("velocity").to_vec();
    let (cell, before) = (*suspension.cell(), relative(&suspension));
    let whole = velocities(&suspension);
    suspension.step().unwrap();
    let moved = (suspension.cell().lattice_vectors()[0] - cell.lattice_vectors()[0]).length();
    assert!(moved > 1.0, "the vectors are others: {moved}");
    let after = relative(&suspension);
    let error = largest(after.iter().zip(&before).map(|(&a, &b)| a - b));
    assert!(error < 1e-5 * largest(before.iter().copied()), "{error}");
    assert!(velocities(&suspension) != whole, "it was computed anew");
}

/// The same at the end of half a period of the lattice in uniaxial and biaxial extension: motions relative to the flow
/// are those just before.
#[test]
fn a_period_of_the_lattice_changes_nothing() {
    let half = 0.5 * 1.324_717_957_244_746_f64.ln();
    for (flow, half) in [(KINDS[1].1, half), (KINDS[2].1, 0.5 * half)] {
        let before_the_end = format!("flow.rate=[[0.0,{}],[0.1,1e-6]]", (half - 2.5e-7) / 0.1);
        let model = passing("order = 2", &[flow, &before_the_end, "time.step=0.1", "time.steps=5"]);
        let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
        let mut found = Vec::new();
        for _ in 0..5 {
            suspension.step().unwrap();
            found.push((suspension.cell().lattice_vectors()[0], relative(&suspension)));
        }
        let moved = (found[4].0 - found[1].0).length();
        assert!(moved > 1.0, "{flow}: the vectors are others: {moved}");
        let error = largest(found[4].1.iter().zip(&found[1].1).map(|(&after, &before)| after - before));
        assert!(error < 1e-5 * largest(found[1].1.iter().copied()), "{flow}: {error}");
    }
}

/// The choice of the origin does not affect relative motion, with or without contacts.
#[test]
#[ignore = "heavy"]
fn relative_motion_does_not_depend_on_the_origin() {
    // Displaced by (3.1, 7.7, -2.3).
    let moved = "particles.positions=[[8.1, 9.3, 3.7], [8.7, 6.8, 4.2], [6.1, 13.7, -0.3]]";
    let planar = METHODS.into_iter().map(|method| (method, None)).chain([(METHODS[2], Some(CONTACTS))]);
    let others = KINDS[1..].iter().flat_map(|kind| [(METHODS[0], Some(kind.1)), (METHODS[2], Some(kind.1))]);
    for (method, more) in planar.chain(others) {
        let at = |place: &[&str]| {
            let model = passing(method, &[place, more.as_slice()].concat());
            ended(&model, 1, |suspension| {
                let all = suspension.gathered(None);
                [1, 2].map(|other| suspension.cell().nearest_image(all.positions[other] - all.positions[0]))
            })
        };
        let [here, there] = [at(&[]), at(&[moved])];
        let error = largest(here.iter().zip(&there).map(|(&a, &b)| a - b));
        assert!(error < 1e-4, "{method} {more:?}: {error}");
    }
}

/// Stokes flow is reversible: smooth spheres return to their positions, through changes of the box's vectors.
#[test]
fn smooth_spheres_come_back_when_the_flow_is_reversed() {
    let all = METHODS
        .map(|method| (method, KINDS[0].1))
        .into_iter()
        .chain(KINDS[1..].iter().map(|kind| (METHODS[2], kind.1)));
    for (method, flow) in all {
        let model = passing(method, &["flow.reversal_at=[0.6]", "time.steps=60", flow]);
        let before = Suspension::start(&model, &Comm::alone()).unwrap().gathered(None);
        let (after, [rate, strain]) = ended(&model, 1, |suspension| (suspension.gathered(None), suspension.shear()));
        assert!((rate + 1.0).abs() < 1e-15 && strain.abs() < 1e-12);
        let error = largest(after.positions.iter().zip(&before.positions).map(|(&a, &b)| a - b));
        assert!(error < 2e-4, "{flow}, {method}: {error}");
        assert_eq!(after.steps, before.steps);
    }
}

#[test]
#[ignore = "heavy"]
fn ranks_agree() {
    let planar = [(METHODS[0], None), (METHODS[1], None), (METHODS[2], Some(CONTACTS))];
    let planar = planar.map(|(method, more)| (method, more, [KINDS[0].1, "time.steps=30"]));
    let others = [
        (METHODS[0], None, [KINDS[1].1, "time.steps=16"]),
        (METHODS[2], Some(CONTACTS), [KINDS[2].1, "time.steps=16"]),
    ];
    for (method, more, [flow, steps]) in planar.into_iter().chain(others) {
        // A tolerance that requires a double-precision grid: in single precision the order of the ranks' sums would
        // matter.
        let keys = [&["hydrodynamics.tolerance=1e-7", steps, flow], more.as_slice()].concat();
        let model = passing(method, &keys);
        let alone = run(&model, 1);
        for ranks in [2, 3, 7] {
            let together = run(&model, ranks);
            let error = largest(alone.positions.iter().zip(&together.positions).map(|(&a, &b)| a - b));
            assert!(error < 1e-7 && together.steps == alone.steps, "{flow}, {method}, {ranks} ranks: {error}");
        }
    }
}

/// Resumed at every step, also at changes of the box's vectors or of the rate.
#[test]
#[ignore = "heavy"]
fn a_resumed_run_has_the_same_bits() {
    let with_heat = PASSING.replace("viscosity = 1.0", "viscosity = 1.0\nfluid.thermal_energy = 0.1");
    let brownian = (with_heat.replace("ADVANCE", r#"integrator = "brownian""#), None);
    let [fixed, adaptive, implicit] = METHODS.map(|method| PASSING.replace("ADVANCE", method));
    let cases = [(fixed, None), (adaptive, None), (implicit.clone(), None), (implicit, Some(CONTACTS)), brownian];
    for ((text, more), flow) in cases.into_iter().flat_map(|case| KINDS.map(|kind| (case.clone(), kind.1))) {
        let keys = [&["flow.reversal_at=[0.6]", "time.step=0.1", "time.steps=12", flow], more.as_slice()].concat();
        let model = model_of(&text, &keys);
        let comm = Comm::alone();
        let mut whole = Suspension::start(&model, &comm).unwrap();
        let mut vectors = Vec::new();
        for step in 0..model.steps {
            let mut resumed = Suspension::resume(&model, Some(whole.state()), &comm).unwrap();
            assert_eq!(resumed.shear().map(f64::to_bits), whole.shear().map(f64::to_bits));
            assert_eq!(resumed.cell(), whole.cell());
            whole.step().unwrap();
            resumed.step().unwrap();
            assert_eq!(whole.gathered(None), resumed.gathered(None), "{text} {flow} {more:?}, after step {step}");
            vectors.push(whole.cell().lattice_vectors()[0]);
        }
        let turned = vectors.windows(2).filter(|pair| (pair[1] - pair[0]).length() > 4.0).count();
        assert!(turned > 1, "{flow}: the box took other vectors {turned} times");
    }
}

/// Smooth spheres return to their positions after each period of an oscillating strain.
#[test]
fn smooth_spheres_come_back_after_a_period() {
    let period = std::f64::consts::PI;
    let flow = r#"flow={kind="planar-extension",oscillation={amplitude=0.6,frequency=2.0}}"#;
    let step = format!("time.step={}", period / 150.0);
    for method in METHODS {
        let model = passing(method, &[flow, &step, "time.steps=150"]);
        let before = Suspension::start(&model, &Comm::alone()).unwrap().gathered(None);
        let after = run(&model, 1);
        let error = largest(after.positions.iter().zip(&before.positions).map(|(&a, &b)| a - b));
        assert!(error < 1e-3, "{method}: {error}");
    }
}

/// Output velocities include the background flow.
#[test]
fn velocities_have_the_flow_in_them() {
    let model = passing("order = 2", &["time.steps=3"]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let gradient = Tensor::from_diagonal(Vector::new(1.0, -1.0, 0.0));
    for _ in 0..3 {
        suspension.step().unwrap();
        let mut all = suspension.gathered(None);
        let relative = relative(&suspension);
        let places = all.positions.clone();
        let whole = all.vectors("velocity");
        let error = largest((0..3).map(|i| whole[i] - relative[i] - gradient * places[i]));
        assert!(error < 1e-13, "{error}");
        assert!(largest(relative.into_iter()) < 2.0, "spheres go about with the flow");
    }
}
