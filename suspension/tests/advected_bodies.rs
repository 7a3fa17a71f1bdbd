//! Bodies and swimmers in flows that carry particles: extensions, oscillations, and flows under a given stress.

use crate::support::ended::{ended, ranks_agree, run};
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, PeriodicBox, Tensor, Vector};
use suspension::{ANGULAR_VELOCITY, Model, ParticleStress, Suspension, VELOCITY};

/// Spheres near each other, one across the faces of the box; `SPHERES` are free, or bodies of one sphere each.
const NEAR: &str = r"
box.edges = [9.0, 9.0, 9.0]
fluid.viscosity = 1.3
hydrodynamics = { lubrication = true, tolerance = 1e-4, iteration_tolerance = 1e-10 }
time = { step = 0.05, steps = 4 }
";

const FREE: &str = r#"
particles = { initial = "positions", positions = [[5.0, 1.6, 6.0], [5.6, -0.5, 6.5], [3.0, 3.0, 5.0]] }
[[species]]
radius = 1.0
count = 3
force = [0.0, 0.5, 2.0]
"#;

const SINGLE: &str = r"
[[bodies]]
spheres = [{ position = [0.0, 0.0, 0.0], radius = 1.0 }]
positions = [[5.0, 1.6, 6.0], [5.6, -0.5, 6.5], [3.0, 3.0, 5.0]]
force = [0.0, 0.5, 2.0]
";

const DOUBLETS: &str = r#"
[[bodies]]
shape = "doublet"
radius = 1.0
positions = [[5.0, 1.6, 6.0], [4.0, 5.6, 6.3]]
orientations = [[0.7, 0.3, 0.5, 0.1], [0.6, -0.2, 0.1, 0.7]]
torque = [0.0, 3.0, 1.0]
"#;

const SWIMMERS: &str = r#"
particles = { initial = "positions", positions = [[1.0, 2.0, 3.0], [7.2, 3.4, 2.4], [3.0, 8.0, 8.0]] }
[[species]]
radius = 1.0
count = 3
orientation = "random"
swimming = { speed = 1.0, beta = -2.0 }
"#;

const STRESS: &str = r#"flow={kind="shear",control="stress",stress=2.0}"#;

const FLOWS: [&str; 4] = [
    r#"flow={kind="planar-extension",rate=0.7}"#,
    r#"flow={kind="uniaxial-extension",rate=0.7}"#,
    r#"flow={kind="shear",oscillation={amplitude=0.4,frequency=5.0}}"#,
    STRESS,
];

const INTEGRATORS: [&str; 3] = [
    "time.order=3",
    "time={integrator=\"adaptive\",tolerance=1e-7,step=0.05,steps=4}",
    "time={integrator=\"implicit\",tolerance=1e-5,step=0.05,steps=4}",
];

/// Integrators of a flow: under a given stress steps are implicit.
fn integrators(flow: &str) -> &'static [&'static str] {
    if flow == STRESS { &INTEGRATORS[2..] } else { &INTEGRATORS }
}

fn model(of: &str, keys: &[&str]) -> Model {
    model_of(&format!("{NEAR}{of}"), keys)
}

/// A body of one sphere is a free sphere. Integrators that adapt their steps take others, as bodies rotate.
#[test]
fn bodies_of_single_spheres_are_carried_as_free_ones() {
    for flow in FLOWS {
        for integrator in integrators(flow) {
            let [free, single] = [FREE, SINGLE].map(|of| run(&model(of, &[flow, integrator]), 1));
            let apart = free.positions.iter().zip(&single.positions).map(|(a, b)| (*a - *b).length());
            let apart = apart.fold(0.0, f64::max);
            let allowed = if integrator == &INTEGRATORS[0] { 1e-7 } else { 2e-5 };
            assert!(apart < allowed, "{flow}, {integrator}: {apart:e}");
        }
    }
}

/// Distance of the two spheres of each doublet.
fn lengths(suspension: &Suspension) -> Vec<f64> {
    let (all, cell): (_, PeriodicBox) = (suspension.gathered(None), *suspension.cell());
    all.positions.chunks(2).map(|pair| cell.nearest_image(pair[1] - pair[0]).length()).collect()
}

/// Through many shapes of the box.
#[test]
fn doublets_stay_rigid_in_flows_that_deform_their_box() {
    for flow in FLOWS {
        let model = model(DOUBLETS, &[flow, "time.steps=25", "hydrodynamics.tolerance=1e-2"]);
        let lengths = ended(&model, 1, |suspension| lengths(suspension));
        assert!(lengths.iter().all(|length| (length - 2.0).abs() < 1e-11), "{flow}: {lengths:?}");
    }
}

/// A doublet of touching spheres rotates in a strain as a spheroid with `(r^2 - 1)/(r^2 + 1) = 0.59406`, and its centre
/// moves with the flow.
#[test]
fn a_doublet_turns_in_an_extension_as_a_spheroid() {
    const ONE: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
flow = { kind = "planar-extension", rate = 0.5 }
hydrodynamics = { lubrication = true, tolerance = 1e-4 }
time = { step = 0.1, steps = 0 }
[[bodies]]
shape = "doublet"
radius = 1.0
positions = [[3.0, 1.0, -2.0]]
orientation = "aligned"
orientation_axis = [1.0, 1.0, 0.0]
"#;
    let mut particles = run(&model_of(ONE, &[]), 1);
    let turning = particles.vectors(ANGULAR_VELOCITY)[0];
    let expected = Vector::Z * (-0.59406 * 0.5);
    assert!((turning - expected).length() < 2e-3 * 0.5, "{turning}, not {expected}");
    let mean = 0.5 * particles.vectors(VELOCITY).iter().sum::<Vector>();
    let centre = 0.5 * (particles.positions[0] + particles.positions[1]);
    let flow = Vector::new(0.5 * centre.x, -0.5 * centre.y, 0.0);
    assert!((mean - flow).length() < 1e-6, "{mean}, not {flow}");
}

/// Shear stress of a suspension and its rate.
fn stress_and_rate(suspension: &mut Suspension) -> [f64; 2] {
    let parts: Vec<ParticleStress> = suspension.stress(1);
    let [rate, _] = suspension.shear();
    let total: Tensor = parts[0].total();
    [1.3 * rate + total.y_axis.x, rate]
}

/// Under a given stress the whole has that stress, with the forces that keep bodies rigid and that of swimming, and a
/// flow with the rate that was found has the same stress.
#[test]
fn a_given_stress_is_that_of_the_flow_with_its_rate() {
    for of in [DOUBLETS, SWIMMERS] {
        let [stress, rate] = stress_and_rate(&mut Suspension::start(&model(of, &[STRESS]), &Comm::alone()).unwrap());
        assert!((stress - 2.0).abs() < 1e-3, "{stress} at {rate}");
        let given = format!("flow={{kind=\"shear\",rate={rate:e}}}");
        let [again, _] = stress_and_rate(&mut Suspension::start(&model(of, &[&given]), &Comm::alone()).unwrap());
        assert!((again - stress).abs() < 1e-5, "{again}, not {stress}");
        for integrator in integrators(STRESS) {
            let [stress, _] = ended(&model(of, &[STRESS, integrator]), 1, stress_and_rate);
            assert!((stress - 2.0).abs() < 5e-3, "{integrator}: {stress}");
        }
    }
}

/// Swimmers beside bodies swim as beside free spheres, if the bodies are single spheres.
#[test]
fn swimmers_swim_beside_bodies_as_beside_spheres() {
    const SWIMMER: &str = r#"
particles = { initial = "positions", positions = [[7.4, 1.8, 6.2], [1.0, 7.0, 2.0]PLACES] }
[[species]]
radius = 1.0
count = 2
orientation = "aligned"
orientation_axis = [-1.0, 0.2, 0.1]
swimming = { speed = 1.0, beta = 2.0 }
"#;
    let (species, body) = (&FREE[FREE.find("[[species]]").unwrap()..], SINGLE);
    let places = ", [5.0, 1.6, 6.0], [5.6, -0.5, 6.5], [3.0, 3.0, 5.0]";
    let beside_free = format!("{}{species}", SWIMMER.replace("PLACES", places));
    let beside_bodies = format!("{}{body}", SWIMMER.replace("PLACES", ""));
    for keys in [INTEGRATORS[0], INTEGRATORS[2]] {
        let [free, bodies] = [&beside_free, &beside_bodies].map(|of| run(&model(of, &[keys]), 1));
        let apart = free.positions.iter().zip(&bodies.positions).map(|(a, b)| (*a - *b).length());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-6, "{keys}: {apart:e}");
    }
    resumes_with_the_same_bits(&model(&beside_bodies, &["time.steps=3"]), "swimmers beside bodies");
}

#[test]
#[ignore = "heavy"]
fn ranks_agree_and_resumed_runs_have_the_same_bits() {
    for flow in FLOWS {
        for integrator in integrators(flow) {
            let name = format!("{flow}, {integrator}");
            let model = model(DOUBLETS, &[flow, integrator, "time.steps=2", "hydrodynamics.tolerance=1e-2"]);
            ranks_agree(&model, 1e-6, &name);
            resumes_with_the_same_bits(&model, &name);
        }
    }
}
