//! Runs on several numbers of ranks, with interrupted steps, and against exact solutions.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Interrupt, Particles, Vector};
use simulation::{AppliedLoads, Simulation};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use suspension::{ANGULAR_VELOCITY, Model, STRESSLET, StepError, Suspension, SuspensionRun, VELOCITY, longest_step};

const SCENE: &str = r#"
seed = 3
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.5, lees_edwards = false }
repulsion = { strength = 20.0, range = 0.1 }
gravity.acceleration = [0.0, 0.0, -1.0]
hydrodynamics = { tolerance = 1e-5, method = "direct", iteration_tolerance = 1e-9 }
time = { step = 0.05, steps = 6 }
[[species]]
name = "small"
radius = 1.0
count = 20
density_difference = 2.0
[[species]]
name = "large"
radius = 1.5
count = 6
"#;

fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

fn model(overrides: &[&str]) -> Model {
    model_of(SCENE, overrides)
}

#[test]
#[ignore = "heavy"]
fn ranks_agree() {
    let model = model(&[]);
    let alone = run(&model, 1);
    for ranks in [2, 3, 4, 7, 13, 16] {
        agree(&alone, &run(&model, ranks), &format!("{ranks} ranks"));
    }
}

/// 26 spheres; and two spheres on a grid with fewer planes and lines along each axis than ranks.
#[test]
#[ignore = "heavy"]
fn more_ranks_than_particles_or_planes_agree() {
    let two = "species=[{ radius = 1.0, count = 2, density_difference = 1.0 }]";
    for overrides in [&["time.steps=1"][..], &["time.steps=1", two, "box.edges=[7, 6, 8]"]] {
        let model = model(overrides);
        agree(&run(&model, 1), &run(&model, 64), "64 ranks");
    }
}

fn agree(alone: &Particles, together: &Particles, what: &str) {
    assert_eq!((&together.ids, &together.steps), (&alone.ids, &alone.steps));
    for (column, other) in alone.columns.iter().zip(&together.columns) {
        let largest = column.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let difference = column.values.iter().zip(other.values.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Tolerance: sums in another order, and stresslets within the tolerance of the iteration.
        assert!(difference <= 1e-8 * largest, "{} on {what}: {difference:e}", column.name);
    }
}

/// The scene chooses the dense method, and a sheared run agrees with that on a grid, on any number of ranks.
#[test]
fn a_run_with_a_dense_matrix_is_that_on_a_grid() {
    let with = |method| model(&["time.steps=2", "flow.lees_edwards=true", method]);
    let [grid, dense] = ["hydrodynamics.method=split", "hydrodynamics.method=dense"].map(with);
    let alone = run(&dense, 1);
    agree(&alone, &run(&dense, 3), "3 ranks");
    let [exact, found] = [alone, run(&grid, 1)].map(|mut particles| particles.vectors(VELOCITY).to_vec());
    let largest = exact.iter().map(|v| v.length()).fold(0.0, f64::max);
    let difference = exact.iter().zip(&found).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max);
    assert!(difference > 0.0 && difference < 1e-4 * largest, "{difference:e} of {largest}");
}

/// Each step reports its evaluations of the mobility, at least four in a Runge-Kutta step and one more for each
/// iteration, and the divergence due to round-off.
#[test]
fn a_step_tells_its_evaluations_and_its_divergence() {
    let model = model(&["time.steps=1"]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    suspension.step().unwrap();
    let report = suspension.report();
    assert!(report.evaluations > 4 && report.evaluations < 1000, "{}", report.evaluations);
    let divergence = report.divergence.unwrap();
    assert!(divergence > 0.0 && divergence < 1e-10, "{divergence:e}");
}

/// A single weightless sphere moves with the flow and rotates with half its vorticity.
#[test]
fn a_sphere_in_shear_is_carried_and_turned() {
    let overrides =
        ["species=[{ radius = 1.0, count = 1 }]", "particles.initial=positions", "particles.positions=[[1, 4, 2]]"];
    let mut particles = run(&model(&overrides), 1);
    let x = 1.0 + 0.5 * 4.0 * 0.3;
    // The only disturbance is due to the dipoles of the periodic images, and vanishes at the centre by symmetry.
    assert!((particles.positions[0] - Vector::new(x, 4.0, 2.0)).length() < 1e-4);
    assert!((particles.vectors(ANGULAR_VELOCITY)[0].z + 0.25).abs() < 0.25 * 0.02);
    let expected = 20.0 / 3.0 * std::f64::consts::PI * 0.25;
    let stresslet = particles.column(STRESSLET, 5).values[1];
    // The stresslet of an isolated sphere is 20/3 pi mu a^3 E; images change it by about the volume fraction, 0.15%.
    assert!((stresslet / expected - 1.0).abs() < 0.01, "{stresslet} for {expected}");
}

#[test]
fn weight_is_density_difference_times_volume_times_gravity() {
    let overrides = [
        "species=[{ radius = 1.5, count = 1, density_difference = 2.0 }]",
        "flow.kind=none",
        "flow={ kind = 'none' }",
        "time.steps=0",
        "box.edges=[40, 40, 40]",
        "hydrodynamics.tolerance=1e-3",
        "hydrodynamics.method=auto",
    ];
    let mut particles = run(&model(&overrides), 1);
    let a = 1.5_f64;
    // Stokes' velocity 2/9 (density difference) g a^2 / mu, with Hasimoto's correction for periodic images.
    let hasimoto = 1.0 - 2.837_297 * a / 40.0 + 4.0 * (a / 40.0).powi(3);
    let expected = -2.0 / 9.0 * 2.0 * a * a * hasimoto;
    let found = particles.vectors(VELOCITY)[0];
    assert!((found.z / expected - 1.0).abs() < 2e-3, "{found} for {expected}");
}

#[test]
fn what_cannot_start_says_why() {
    let start = |overrides: &[&str]| {
        let model = model(overrides);
        Comm::threads(2, |comm| Suspension::start(&model, &comm).err().map(|e| format!("{e:#}")).unwrap())
    };
    let two = "species=[{ radius = 1.0, count = 2 }]";
    let overlap = start(&[two, "particles={ initial = 'positions', positions = [[1, 1, 1], [1, 1, 2.5]] }"]);
    assert!(
        overlap[0].contains("two spheres overlap at the start, by 0.5 (0.5 of the smallest radius)"),
        "{}",
        overlap[0]
    );
    assert_eq!(overlap[0], overlap[1], "every rank knows");
}

/// With user-defined forces far too large for the time step a particle flies off; every rank gets the error, and none
/// waits.
#[test]
fn a_particle_that_is_nowhere_is_named() {
    let model = model(&["flow={ kind = 'none' }"]);
    let messages = Comm::threads(3, |comm| {
        let mut suspension = Suspension::start(&model, &comm).unwrap();
        let far = |positions: &[Vector], _: f64| {
            Ok(AppliedLoads { forces: vec![Vector::X * 1e30; positions.len()], ..AppliedLoads::default() })
        };
        suspension.add_loads(Box::new(far)).unwrap();
        (0..5).find_map(|_| suspension.step().err()).unwrap().to_string()
    });
    assert!(
        messages[0].contains("step 0: particle ") && messages[0].contains("try a smaller time.step"),
        "{messages:?}"
    );
    assert!(messages.iter().all(|m| *m == messages[0]));
}

/// By symmetry the spheres of a lattice move exactly with the flow; after a strain of one the sheared box and its
/// lattice are the initial ones.
#[test]
fn a_lattice_sheared_through_a_period_returns_to_its_start() {
    let model = model_of(
        r#"
box.edges = [6.0, 6.0, 6.0]
fluid.viscosity = 1.0
particles = { initial = "lattice", lattice = "simple-cubic" }
flow = { kind = "shear", rate = 0.5, lees_edwards = true }
hydrodynamics = { tolerance = 1e-5 }
time = { step = 0.1, steps = 20 }
[[species]]
name = "sphere"
radius = 1.0
count = 8
"#,
        &[],
    );
    let start = Suspension::start(&model, &Comm::alone()).unwrap().gathered(None);
    let end = run(&model, 2);
    let cell = domain::PeriodicBox::new(model.cell.edges()).unwrap();
    for (before, after) in start.positions.iter().zip(&end.positions) {
        let carried = *before + domain::Vector::X * before.y;
        // Forty evaluations with relative errors of 1e-5 of velocities up to 3, in steps of 0.1.
        assert!(cell.nearest_image(*after - carried).length() < 2e-4, "{before} went to {after}, not {carried}");
    }
}

/// The choice of a sphere's image in the scene changes nothing except the count of its lattice steps, in a sheared box
/// whose lattice is reset.
#[test]
fn trajectories_do_not_depend_on_the_image_that_a_sphere_starts_from() {
    let places = [[1.0, 1.0, 1.0], [3.4, 1.5, 1.2], [6.5, 6.0, 5.0], [5.0, 7.6, 1.0]];
    let steps = [[0.0, 0.0, 0.0], [2.0, 0.0, -1.0], [0.0, 1.0, 0.0], [-1.0, -2.0, 3.0]];
    let moved = |image: usize| {
        let place = |(p, s): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|d| p[d] + 8.0 * s[d] * image as f64);
        let list: Vec<[f64; 3]> = places.iter().zip(&steps).map(place).collect();
        let text = format!(
            r#"
box.edges = [8.0, 8.0, 8.0]
fluid.viscosity = 1.0
particles = {{ initial = "positions", positions = {list:?} }}
flow = {{ kind = "shear", rate = 1.0, lees_edwards = true }}
repulsion = {{ strength = 20.0, range = 0.2 }}
hydrodynamics = {{ tolerance = 1e-3 }}
time = {{ step = 0.02, steps = 35 }}
[[species]]
radius = 1.0
count = 4
"#
        );
        run(&model_of(&text, &[]), 1)
    };
    let [here, there] = [0, 1].map(moved);
    for (a, b) in here.positions.iter().zip(&there.positions) {
        assert!((*a - *b).length() < 1e-11, "{a} is not {b}");
    }
    assert_ne!(here.steps, there.steps);
}

/// Two spheres at a gap of 0.04, pressed together by forces equal to their repulsion at contact.
const PRESSED: [&str; 5] = [
    r#"species=[{ name = "left", radius = 1.0, count = 1, force = [20.0, 0.0, 0.0] },
                { name = "right", radius = 1.0, count = 1, force = [-20.0, 0.0, 0.0] }]"#,
    r#"flow={ kind = "none" }"#,
    "hydrodynamics={ tolerance = 1e-3 }",
    "particles.initial=positions",
    "particles.positions=[[5, 7, 7], [7.04, 7, 7]]",
];

/// Last change of the gap of the two, for steps that are a fraction of the longest stable step.
fn last_change(fraction: f64, more: &[&str]) -> f64 {
    let with = |step: f64| model(&[&PRESSED, more, &[&format!("time.step={step}")]].concat());
    let is_warned_of =
        |model: &Model| !SuspensionRun::start(model, None, &Comm::alone()).unwrap().start_warnings().is_empty();
    let short = with(1e-3);
    assert!(!is_warned_of(&short));
    let longest = longest_step(&short).unwrap();
    assert_eq!([longest, longest.next_up()].map(|step| is_warned_of(&with(step))), [false, true]);
    let model = with(fraction * longest);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let mut gaps = [0.0; 2];
    for _ in 0..80 {
        suspension.step().unwrap();
        gaps = [gaps[1], suspension.report().smallest_gap];
    }
    (gaps[1] - gaps[0]).abs()
}

/// The longest step follows from the mobility in unbounded fluid, which is a tenth larger than that in the box.
#[test]
fn pairs_that_repulsion_holds_are_steady_up_to_the_longest_step() {
    for more in [&[][..], &["hydrodynamics.multipoles=monopole"], &["time.order=3"], &["time.order=2"]] {
        assert!(last_change(0.8, more) < 1e-6, "{more:?}");
        assert!(last_change(1.5, more) > 1e-3, "{more:?}");
    }
}

#[test]
fn overlaps_are_told_with_what_helps() {
    let model = model(&[&PRESSED[..], &["repulsion.strength=0", "time.step=0.1"]].concat());
    let mut observed = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    observed.observe();
    assert_eq!(observed.warnings(), [""; 0]);
    observed.advance(1).unwrap();
    observed.observe();
    let warning = observed.warnings().remove(0);
    assert!(warning.starts_with("spheres overlap in 1 of 2 rows of the time series, by "), "{warning}");
    assert!(warning.ends_with("at most; try a larger repulsion.strength or a shorter time.step"), "{warning}");
}

/// An interrupt that is requested from a rank's check number `looks` (from 0) on, until it is called off.
fn interrupt_after(looks: usize) -> (Interrupt, Arc<AtomicBool>) {
    let (left, called_off) = (AtomicUsize::new(looks), Arc::new(AtomicBool::new(false)));
    let seen = called_off.clone();
    let one_less = move || left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
    (Interrupt::when(move || one_less().is_err() && !seen.load(Ordering::Relaxed)), called_off)
}

/// Runs a scene, with each step interrupted once at each of the given checks on the last rank before it is completed.
/// Returns the number of interruptions as well.
fn run_with_interruptions(
    model: &Model,
    ranks: usize,
    looks: &(impl Iterator<Item = usize> + Clone + Sync),
) -> (Particles, usize) {
    let all = Comm::threads(ranks, |comm| {
        let mut suspension = Suspension::start(model, &comm).unwrap();
        let mut interrupted = 0;
        for _ in 0..model.steps {
            let before = (suspension.gathered(None), *suspension.cell());
            let step = suspension.clock().step();
            for looks in looks.clone() {
                let (interrupt, called_off) = interrupt_after(looks);
                suspension.listen(if comm.rank() + 1 == ranks { interrupt } else { Interrupt::NEVER });
                match suspension.step() {
                    Err(StepError::Interrupted(_)) => interrupted += 1,
                    // The step had fewer checks.
                    taken => {
                        taken.unwrap();
                        break;
                    }
                }
                called_off.store(true, Ordering::Relaxed);
                assert_eq!((suspension.gathered(None), *suspension.cell()), before, "after {looks} looks");
            }
            if suspension.clock().step() == step {
                suspension.listen(Interrupt::NEVER);
                suspension.step().unwrap();
            }
        }
        (suspension.gathered(None), interrupted)
    });
    all.into_iter().next().unwrap()
}

#[test]
#[ignore = "heavy"]
fn an_interrupted_step_is_not_taken_and_leaves_no_trace() {
    let lees_edwards = ["flow.lees_edwards=true", "flow.rate=7.0", "time.steps=4", "hydrodynamics.tolerance=1e-2"];
    let adaptive = ["time.integrator=adaptive", "hydrodynamics.lubrication=true", "time.step=0.2", "time.steps=2"];
    let monopoles = ["hydrodynamics.multipoles=monopole", "time.steps=3"];
    let both = [&lees_edwards[..], &adaptive].concat();
    for (overrides, ranks) in [(&lees_edwards[..], 1), (&lees_edwards, 3), (&both, 1), (&both, 2), (&monopoles, 2)] {
        let model = model(overrides);
        let (particles, interrupted) = run_with_interruptions(&model, ranks, &(0..40).step_by(3));
        assert!(interrupted >= 3, "{interrupted}");
        assert_eq!(particles, run(&model, ranks), "{overrides:?} on {ranks} ranks");
    }
}
