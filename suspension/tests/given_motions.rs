//! Bodies whose motions are given.

use crate::bodies::INTEGRATORS;
use crate::support::ended::{ranks_agree, run};
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, Quaternion, Vector};
use simulation::Simulation;
use std::f64::consts::PI;
use suspension::{ANGULAR_VELOCITY, Model, ORIENTATION, SuspensionRun, VELOCITY};

/// A doublet of touching spheres, and one sphere which is a body as well.
const PAIR: &str = r#"
fluid.viscosity = 1.0
particles.initial = "random"
hydrodynamics = { tolerance = 1e-3, lubrication = true }
time = { step = 0.1, steps = 0 }
[[bodies]]
name = "doublet"
shape = "doublet"
radius = 1.0
positions = [[4.0, 4.0, 4.0]]
orientation = "aligned"
orientation_axis = [1.0, 0.0, 0.0]
"#;

/// A driven doublet and a roller among free spheres.
const FEW: &str = r#"
seed = 4
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.4 }
particles = { initial = "positions", positions = [[1.0, 10.0, 4.0], [8.0, 8.2, 4.4]] }
hydrodynamics = { tolerance = 1e-2, iteration_tolerance = 1e-9 }
time = { step = 0.1, steps = 5 }
[[species]]
radius = 1.0
count = 2
[[bodies]]
name = "roller"
spheres = [{ position = [0.0, 0.0, 0.0], radius = 0.8 }]
positions = [[6.4, 4.0, 5.0], [10.0, 4.0, 10.0]]
angular_velocity = ["free", 0.5, "free"]
velocity = ["free", 0.2, 0.0]
[[bodies]]
name = "doublet"
shape = "doublet"
radius = 1.0
positions = [[3.4, 4.4, 4.0]]
orientation = "aligned"
orientation_axis = [1.0, 1.0, 0.3]
angular_velocity = [0.3, 0.0, 0.4]
"#;

/// The mean driving force and torque of the first kind with a given motion, at the start of a run.
fn driving_loads(model: &Model) -> [Vector; 2] {
    let mut run = SuspensionRun::start(model, None, &Comm::alone()).unwrap();
    let (quantities, row) = (run.quantities(), run.observe());
    ["driving_force", "driving_torque"].map(|name| {
        let place = quantities.iter().position(|quantity| quantity.name == name).expect("a given motion");
        Vector::from_slice(&row[place][..3])
    })
}

/// Moving along its axis, across it, and rotating about each, a doublet in unbounded fluid takes the loads of the exact
/// two-sphere functions.
#[test]
fn a_driven_doublet_takes_the_exact_loads() {
    let open = "box.boundaries=[\"open\",\"open\",\"open\"]";
    let cases = [
        ("velocity=[0.5,0.0,0.0]", [1.0, 0.0, 0.0], 2.0 * 0.64514 * 6.0 * PI * 0.5, 0),
        ("velocity=[0.0,0.5,0.0]", [0.0, 1.0, 0.0], 2.0 * 0.72466 * 6.0 * PI * 0.5, 0),
        ("angular_velocity=[0.5,0.0,0.0]", [1.0, 0.0, 0.0], 2.0 * 0.90154 * 8.0 * PI * 0.5, 1),
        ("angular_velocity=[0.0,0.5,\"free\"]", [0.0, 1.0, 0.0], 3.7401 * 8.0 * PI * 0.5, 1),
    ];
    for (given, along, exact, which) in cases {
        let loads = driving_loads(&model_of(PAIR, &[open, &format!("bodies[0].{given}")]));
        let expected = Vector::from_array(along) * exact;
        assert!((loads[which] - expected).length() < 4e-3 * exact, "{given}: {}, not {expected}", loads[which]);
        assert!(loads[1 - which].length() < 1e-3 * exact, "{given}: {loads:?}");
    }
}

/// The force that a given velocity takes is that which causes the velocity, in addition to the weight; loads along
/// components that are free are zero.
#[test]
fn the_driving_load_is_the_one_that_causes_the_motion() {
    let walls = "box={edges=[9.0,9.0,9.0],boundaries=[\"periodic\",\"periodic\",\"walls\"]}";
    let flow = "flow={kind=\"poiseuille\",pressure_gradient=0.5}";
    let keys = [walls, flow, "bodies[0].orientation_axis=[1.0,0.4,0.2]", "hydrodynamics.iteration_tolerance=1e-9"];
    let free = model_of(PAIR, &[&keys[..], &["bodies[0].force=[2.0,1.0,-3.0]"]].concat());
    let mut moved = run(&free, 1);
    let velocity = 0.5 * moved.vectors(VELOCITY).iter().sum::<Vector>();
    let turning = moved.vectors(ANGULAR_VELOCITY)[0];
    let given = [
        format!("bodies[0].velocity=[{:e},{:e},\"free\"]", velocity.x, velocity.y),
        format!("bodies[0].angular_velocity=[\"free\",\"free\",{:e}]", turning.z),
        "bodies[0].force=[0.5,0.0,-3.0]".to_owned(),
    ];
    let given = given.each_ref().map(String::as_str);
    let [force, torque] = driving_loads(&model_of(PAIR, &[&keys[..], &given].concat()));
    assert!((force - Vector::new(1.5, 1.0, 0.0)).length() < 1e-5, "{force}");
    assert!(torque.length() < 1e-5, "{torque}");
}

/// An obstacle stays where it is in a flow between walls, and a body that rotates at a given rate has rotated by the
/// angle of that rate, by all integrators.
#[test]
fn given_motions_are_kept_by_all_integrators() {
    let walls = "box={edges=[9.0,9.0,9.0],boundaries=[\"periodic\",\"periodic\",\"walls\"]}";
    for keys in INTEGRATORS {
        for flow in ["flow={kind=\"poiseuille\",pressure_gradient=0.5}", "flow={kind=\"shear\",rate=0.7}"] {
            let given = ["bodies[0].velocity=[0.0,0.0,0.0]", "bodies[0].angular_velocity=[0.0,0.6,0.8]"];
            let model = model_of(PAIR, &[keys, &given, &["time.steps=12", walls, flow]].concat());
            let end = run(&model, 1);
            let centre = 0.5 * (end.positions[0] + end.positions[1]);
            assert!((centre - Vector::splat(4.0)).length() < 1e-12, "{keys:?}, {flow}: {centre}");
            let start = Quaternion::between(Vector::Z, Vector::X);
            let expected = Quaternion::exp(Vector::new(0.0, 0.6, 0.8) * model.end()) * start;
            let orientation = Quaternion::from_array(end.rows::<4>(ORIENTATION).unwrap()[0]);
            let error = (orientation * expected.inverse()).log().length();
            assert!(error < 1e-12, "{keys:?}, {flow}: {error:e}");
        }
    }
}

#[test]
fn a_resumed_run_has_the_same_bits() {
    for keys in INTEGRATORS {
        let model = model_of(FEW, &[keys, &["time.steps=4", "statistics={every=1}"]].concat());
        resumes_with_the_same_bits(&model, &format!("{keys:?}"));
    }
}

#[test]
#[ignore = "heavy"]
fn given_motions_are_the_same_on_any_ranks() {
    for keys in INTEGRATORS {
        ranks_agree(&model_of(FEW, keys), 1e-7, &format!("{keys:?}"));
    }
}

/// Given motions and the loads that they take rotate with the axes of the user.
#[test]
fn walls_across_another_axis_give_the_same_loads() {
    let keys = |boundaries: &str, body: [&str; 3]| {
        let [velocity, spin, axis] = body;
        model_of(
            PAIR,
            &[
                &format!("box={{edges=[9.0,9.0,9.0],boundaries={boundaries}}}"),
                &format!("bodies[0].velocity={velocity}"),
                &format!("bodies[0].angular_velocity={spin}"),
                &format!("bodies[0].orientation_axis={axis}"),
                "hydrodynamics.iteration_tolerance=1e-9",
            ],
        )
    };
    let upright =
        keys("[\"periodic\",\"periodic\",\"walls\"]", ["[0.3,0.1,\"free\"]", "[\"free\",0.2,-0.4]", "[1.0,0.3,0.5]"]);
    // (x, y, z) of the box is (y, z, x) of the user.
    let turned =
        keys("[\"walls\",\"periodic\",\"periodic\"]", ["[\"free\",0.3,0.1]", "[-0.4,\"free\",0.2]", "[0.5,1.0,0.3]"]);
    for (a, b) in driving_loads(&upright).into_iter().zip(driving_loads(&turned)) {
        assert!((a - Vector::new(b.y, b.z, b.x)).length() < 1e-6 * a.length(), "{a} {b}");
    }
}
