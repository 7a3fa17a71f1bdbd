//! Implicit repulsion: order, stiffness, and identical results on any number of ranks and after a restart.

use crate::support::model_of;
use domain::{Comm, Particles};
use suspension::{Model, Suspension};

/// Two spheres pressed together against their repulsion that roll about each other in a shear flow, one of them across
/// a face of the box; a third sphere is far away.
const PRESSED: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.5, lees_edwards = true }
particles = { initial = "positions", positions = [[6.0, 11.5, 6.0], [7.9, 0.4, 6.3], [3.0, 6.0, 2.0]] }
hydrodynamics = { tolerance = 1e-3, iteration_tolerance = 1e-8 }
repulsion = { strength = 100.0, range = 0.2 }
time = { step = 0.1, steps = 6, integrator = "implicit", tolerance = 0.9, gap_fraction = 0.9 }
[[species]]
name = "pushed right"
radius = 1.0
count = 1
force = [20.0, 0.0, 0.0]
[[species]]
name = "pushed left"
radius = 1.0
count = 2
force = [-20.0, 0.0, 0.0]
"#;

const LUBRICATED: &str = "hydrodynamics.lubrication=true";
const POINTS: &str = "hydrodynamics.multipoles=\"monopole\"";

fn run(model: &Model, ranks: usize) -> (Particles, f64) {
    let all = Comm::threads(ranks, |comm| {
        let mut suspension = Suspension::start(model, &comm).unwrap();
        let mut evaluations = 0.0;
        for _ in 0..model.steps {
            suspension.step().unwrap();
            evaluations += suspension.report().evaluations as f64;
        }
        (suspension.gathered(None), evaluations)
    });
    all.into_iter().next().unwrap()
}

fn places(particles: &Particles, model: &Model) -> Vec<domain::Vector> {
    let cell = domain::PeriodicBox::sheared(model.cell.edges(), 0.5 * model.end()).unwrap();
    particles.positions.iter().zip(&particles.steps).map(|(&x, &steps)| x + cell.lattice(steps)).collect()
}

fn difference(a: &[domain::Vector], b: &[domain::Vector]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max)
}

/// Half the step has a quarter of the error, and the result converges to that of the adaptive method of order 3.
#[test]
fn the_order_is_two_with_every_kind_of_hydrodynamics() {
    for kind in [POINTS, "", LUBRICATED] {
        let with = |keys: &[&str]| {
            let keys: Vec<&str> = keys.iter().copied().chain([kind]).filter(|key| !key.is_empty()).collect();
            let model = model_of(PRESSED, &keys);
            places(&run(&model, 1).0, &model)
        };
        let exact = with(&["time.integrator=\"adaptive\"", "time.tolerance=1e-9", "time.gap_fraction=0.02"]);
        let steps = [["time.step=0.0125", "time.steps=48"], ["time.step=0.00625", "time.steps=96"]];
        let errors = steps.map(|keys| difference(&with(&keys), &exact));
        let order = (errors[0] / errors[1]).log2();
        assert!((1.6..2.6).contains(&order) && errors[1] < 5e-4, "{kind}: order {order} from {errors:?}");
    }
}

/// With a barrier that is a hundred times stiffer, spheres come to rest where short steps bring them, with a fraction
/// of the evaluations of explicit steps at the same tolerance.
#[test]
fn stiff_repulsion_limits_steps_less() {
    let stiff = [
        "flow.rate=0.0",
        "repulsion.strength=1e4",
        "particles.positions=[[5.0, 6.0, 6.0], [7.15, 6.0, 6.0], [1.0, 1.0, 1.0]]",
        "time.steps=6",
        "time.step=0.5",
        "time.tolerance=1e-3",
    ];
    for kind in [POINTS, LUBRICATED] {
        let with = |key: &str| {
            let keys: Vec<&str> = stiff.iter().copied().chain([kind, key]).collect();
            let (particles, evaluations) = run(&model_of(PRESSED, &keys), 1);
            ((particles.positions[1] - particles.positions[0]).length() - 2.0, evaluations)
        };
        let (gap, evaluations) = with("time.gap_fraction=0.9");
        let (_, explicit) = with("time.integrator=\"adaptive\"");
        let (exact, _) = with("time.tolerance=1e-6");
        // A single pair would rest at a gap of 0.2 - 0.2 (20 / 1e4)^(1/2) = 0.191.
        assert!((gap - exact).abs() < 1e-3 && (0.18..0.2).contains(&exact), "{kind}: gap {gap}, short steps {exact}");
        assert!(evaluations < 0.2 * explicit, "{kind}: {evaluations} evaluations, explicit {explicit}");
    }
}

#[test]
#[ignore = "heavy"]
fn ranks_agree() {
    for kind in [POINTS, "hydrodynamics.lubrication=false", LUBRICATED] {
        // A tolerance that requires a double-precision grid: in single precision the order of the ranks' sums would
        // matter.
        let tight = ["hydrodynamics.tolerance=1e-6", "hydrodynamics.iteration_tolerance=1e-10"];
        let model = model_of(PRESSED, &[kind, tight[0], tight[1], "time.tolerance=1e-3", "time.steps=3"]);
        let (alone, _) = run(&model, 1);
        for ranks in [2, 3, 7] {
            let (together, _) = run(&model, ranks);
            let error = difference(&alone.positions, &together.positions);
            assert!(error < 1e-8, "{kind}, {ranks} ranks: {error}");
        }
    }
}

/// Resumed after each step; the lattice of the box is reset in one of them.
#[test]
fn a_resumed_run_has_the_same_bits() {
    for kind in [POINTS, "hydrodynamics.lubrication=false", LUBRICATED] {
        let model = model_of(PRESSED, &[kind, "time.tolerance=1e-3", "flow.rate=1.5"]);
        let comm = Comm::alone();
        let mut whole = Suspension::start(&model, &comm).unwrap();
        for step in 0..model.steps {
            let mut resumed = Suspension::resume(&model, Some(whole.state()), &comm).unwrap();
            whole.step().unwrap();
            resumed.step().unwrap();
            assert_eq!(whole.gathered(None), resumed.gathered(None), "{kind}, after step {step}");
        }
    }
}

/// Spheres with lubrication, none of which is near another.
#[test]
fn spheres_that_are_far_apart_need_no_near_field() {
    let apart = "particles.positions=[[2.0, 2.0, 2.0], [8.0, 8.0, 2.0], [5.0, 5.0, 8.0]]";
    for integrator in ["implicit", "adaptive", "adams-bashforth"] {
        let key = format!("time.integrator=\"{integrator}\"");
        let fixed = integrator == "adams-bashforth";
        let text =
            if fixed { PRESSED.replace(", tolerance = 0.9, gap_fraction = 0.9", "") } else { PRESSED.to_owned() };
        let keys = [apart, key.as_str(), "time.step=0.01"];
        let place = |kind: &[&str]| run(&model_of(&text, &[&keys[..], kind].concat()), 1).0.positions;
        let error = difference(&place(&[LUBRICATED, "hydrodynamics.lubrication_cutoff=0.5"]), &place(&[]));
        assert!(error < 1e-6, "{integrator}: {error}");
    }
}
