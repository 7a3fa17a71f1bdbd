//! Runs of near spheres: accuracy, safety, and identical results on any number of ranks and after a restart.

use crate::support::model_of;
use domain::{Comm, Particles, Vector};
use suspension::{Model, StepError, Suspension};

/// Two spheres pressed together, with a third one between them.
const PRESSED: &str = r#"
box.edges = [16.0, 16.0, 16.0]
fluid.viscosity = 1.0
particles = { initial = "positions", positions = [[5.0, 5.0, 5.0], [9.0, 5.5, 5.5], [7.0, 5.5, 5.2]] }
hydrodynamics = { tolerance = 1e-3, lubrication = true }
time = { step = 0.1, steps = 4, integrator = "adaptive", tolerance = 1e-3 }
[[species]]
name = "pushed right"
radius = 1.0
count = 1
force = [20.0, 1.0, 0.0]
[[species]]
name = "pushed left"
radius = 1.0
count = 1
force = [-20.0, 0.0, 1.0]
[[species]]
name = "between"
radius = 0.9
count = 1
"#;

/// Chain of equal, touching spheres that settles.
const CHAIN: &str = r#"
box.edges = [16.0, 16.0, 16.0]
fluid.viscosity = 1.0
gravity.acceleration = [0.0, 0.6, -1.0]
particles = { initial = "positions", positions = [[4.0, 8.0, 8.0], [6.0, 8.0, 8.0], [8.0, 8.0, 8.0], [8.0, 10.0, 8.0]] }
hydrodynamics = { tolerance = 1e-3, lubrication = true }
repulsion.strength = 5.0
time = { step = 0.2, steps = 3, integrator = "adaptive", tolerance = 1e-3 }
[[species]]
radius = 1.0
count = 4
density_difference = 4.5
"#;

/// Particles after all steps, and the error that ended the run early, if any.
fn run(model: &Model, ranks: usize) -> (Particles, Option<StepError>) {
    let all = Comm::threads(ranks, |comm| {
        let mut suspension = Suspension::start(model, &comm).unwrap();
        let failed = (0..model.steps).find_map(|_| suspension.step().err());
        (suspension.gathered(None), failed)
    });
    all.into_iter().next().unwrap()
}

fn gap(particles: &Particles, i: usize, j: usize) -> f64 {
    let distance = (particles.positions[j] - particles.positions[i]).length();
    distance - particles.radii[i] - particles.radii[j]
}

fn difference(a: &Particles, b: &Particles) -> f64 {
    a.positions.iter().zip(&b.positions).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max)
}

#[test]
fn spheres_pressed_together_come_near_and_never_touch() {
    let (particles, failed) = run(&model_of(PRESSED, &[]), 1);
    assert!(failed.is_none(), "{}", failed.unwrap());
    for (i, j) in [(0, 2), (2, 1)] {
        let gap = gap(&particles, i, j);
        assert!(gap > 0.0 && gap < 0.08, "spheres {i} and {j}: {gap}");
    }
}

/// Forces that press the spheres together on a line, from positions a few steps apart.
const HEAD_ON: [&str; 4] = [
    "time.step=1.0",
    "particles.positions=[[5.8, 8.0, 8.0], [9.8, 8.0, 8.0], [7.8, 8.0, 8.0]]",
    "species[0].force=[200.0, 0.0, 0.0]",
    "species[1].force=[-200.0, 0.0, 0.0]",
];

#[test]
fn spheres_pressed_together_for_long_stay_apart() {
    let (particles, failed) = run(&model_of(PRESSED, &HEAD_ON), 1);
    assert!(failed.is_none(), "{}", failed.unwrap());
    for (i, j) in [(0, 2), (2, 1)] {
        let gap = gap(&particles, i, j);
        // From a tenth below the minimum gap of 1e-6 mean radii (the tolerance of moving spheres apart) to a hundredth
        // of the error tolerance (the error of gaps that count as that large).
        assert!(gap > 0.85e-6 && gap < 1e-5, "spheres {i} and {j}: {gap}");
    }
}

#[test]
fn without_lubrication_what_no_step_can_follow_is_an_error_that_says_what_to_do() {
    let alone = [&HEAD_ON[..], &["hydrodynamics.lubrication=false"]].concat();
    let (_, failed) = run(&model_of(PRESSED, &alone), 1);
    let message = failed.expect("they collide").to_string();
    assert!(message.contains("come together faster") && message.contains("repulsion.strength"), "{message}");
}

#[test]
fn a_cluster_of_touching_spheres_settles() {
    let (particles, failed) = run(&model_of(CHAIN, &[]), 1);
    assert!(failed.is_none(), "{}", failed.unwrap());
    assert!(particles.positions.iter().all(|p| p.is_finite()));
    for (i, j) in [(0, 1), (1, 2), (2, 3)] {
        assert!(gap(&particles, i, j) > -1e-9, "spheres {i} and {j} overlap");
    }
}

#[test]
fn ranks_and_threads_agree() {
    // Tolerances that require a double-precision grid: in single precision the order of the ranks' sums would matter.
    let tight = ["hydrodynamics.tolerance=1e-6", "hydrodynamics.iteration_tolerance=1e-10", "time.steps=2"];
    let model = model_of(PRESSED, &tight);
    let (alone, _) = run(&model, 1);
    let (again, _) = run(&model, 1);
    assert_eq!(alone, again, "the same bits whatever thread does what");
    for ranks in [2, 3, 13] {
        let (together, _) = run(&model, ranks);
        assert!(difference(&alone, &together) < 1e-8, "{ranks} ranks: {}", difference(&alone, &together));
    }
}

#[test]
fn a_resumed_run_has_the_same_bits() {
    let model = model_of(CHAIN, &[]);
    let comm = Comm::alone();
    let mut whole = Suspension::start(&model, &comm).unwrap();
    whole.step().unwrap();
    let mut resumed = Suspension::resume(&model, Some(whole.state()), &comm).unwrap();
    for _ in 0..2 {
        whole.step().unwrap();
        resumed.step().unwrap();
    }
    assert_eq!(whole.gathered(None), resumed.gathered(None));
}

/// One sphere that moves around another without touching it, compared with much shorter steps.
#[test]
fn the_error_follows_the_tolerance() {
    let place = |tolerance: &str| run(&model_of(PRESSED, &[tolerance, "time.gap_fraction=0.5"]), 1).0.positions[2];
    let exact = place("time.tolerance=1e-7");
    let errors = ["time.tolerance=1e-3", "time.tolerance=1e-5"].map(|t| (place(t) - exact).length());
    // A few substeps, each with an error of at most the tolerance, and the limit of the gaps.
    assert!(errors[0] < 5e-3 && errors[1] < 0.3 * errors[0] + 1e-4, "{errors:?}");
    assert!(exact.distance(Vector::new(7.0, 5.5, 5.2)) > 1e-3, "it moves");
}

/// Two spheres that are pressed together and roll about each other.
const ROLLING: &str = r#"
box.edges = [16.0, 16.0, 16.0]
fluid.viscosity = 1.0
particles = { initial = "positions", positions = [[6.0, 8.0, 8.0], [7.91077, 8.59107, 8.0]] }
hydrodynamics = { tolerance = 1e-3, iteration_tolerance = 1e-7, lubrication = true }
time = { step = 0.25, steps = 4, integrator = "adaptive" }
[[species]]
name = "pushed right"
radius = 1.0
count = 1
force = [20.0, 0.0, 0.0]
[[species]]
name = "pushed left"
radius = 1.0
count = 1
force = [-20.0, 0.0, 0.0]
"#;

/// Half the gap fraction and an eighth of the tolerance halve the substeps; the gap, at most 1e-4, is always so small
/// that it counts as large as the tolerance.
#[test]
fn the_order_is_three_where_gaps_are_below_the_tolerance() {
    let at = |fraction: f64| {
        let control = [format!("time.gap_fraction={fraction}"), format!("time.tolerance={}", fraction.powi(3) / 8.0)];
        let (particles, failed) = run(&model_of(ROLLING, &[&control[0], &control[1]]), 1);
        assert!(failed.is_none(), "{}", failed.unwrap());
        assert!(gap(&particles, 0, 1) < fraction.powi(3) / 8.0);
        particles
    };
    let exact = at(0.1);
    let errors = [0.4, 0.2].map(|fraction| difference(&at(fraction), &exact));
    let order = (errors[0] / errors[1]).log2();
    assert!(order > 2.7 && errors[1] < 1e-4, "order {order} from {errors:?}");
}

/// Two spheres that pass each other in unbounded shear, with the defaults of `[time]`.
const PASSING: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
particles = { initial = "positions", positions = [[-1.5, 0.05, 0.0], [1.5, -0.05, 0.0]] }
flow = { kind = "shear", rate = 1.0 }
hydrodynamics = { tolerance = 1e-5, lubrication = true }
time = { step = 0.05, steps = 370, integrator = "adaptive" }
[[species]]
radius = 1.0
count = 2
"#;

/// The exact path is symmetric. Its smallest gap is 2.58e-5, a quarter of the gap below which the error bound is
/// constant; an error of a hundredth of the latter changes the offset by 0.006.
#[test]
fn a_pair_leaves_at_the_offset_at_which_it_came() {
    let model = model_of(PASSING, &[]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let mut apart: Vec<Vector> = Vec::new();
    while apart.last().is_none_or(|last| last.x < 3.1) && apart.len() < model.steps as usize {
        suspension.step().unwrap();
        let places = suspension.gathered(None).positions;
        apart.push(places[0] - places[1]);
    }
    let passed = apart.windows(2).find(|both| both[1].x >= 3.0).expect("it passes");
    let offset = passed[0].y + (3.0 - passed[0].x) / (passed[1].x - passed[0].x) * (passed[1].y - passed[0].y);
    assert!((offset - 0.1).abs() < 0.001, "{offset}");
}
