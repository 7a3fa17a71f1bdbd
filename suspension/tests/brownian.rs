//! Runs with Brownian motion.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Particles, Vector};
use simulation::Simulation;
use suspension::{Model, Suspension, SuspensionRun};

const ALONE: &str = r#"
seed = 3
box.edges = [5.0, 5.0, 5.0]
fluid = { viscosity = 0.5, thermal_energy = 2.0 }
particles = { initial = "positions", positions = [[1.0, 4.0, 2.0]] }
hydrodynamics.tolerance = 1e-3
time = { step = 0.01, steps = 3000 }
[[species]]
radius = 1.0
count = 1
"#;

/// The diffusivity of a sphere in a periodic box is `1 - 2.8373 a/L + 4 (a/L)^3 ...` times that of an isolated one:
/// 0.46454 at 5 radii.
#[test]
fn a_sphere_diffuses_as_fast_as_it_moves() {
    let model = model_of(ALONE, &[]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let place = |suspension: &Suspension| {
        let particles = suspension.particles();
        particles.positions[0] + suspension.cell().lattice(particles.steps[0])
    };
    let (mut before, mut sum) = (place(&suspension), 0.0);
    for _ in 0..model.steps {
        suspension.step().unwrap();
        let now = place(&suspension);
        sum += (now - before).length_squared();
        before = now;
    }
    let alone = 2.0 / (6.0 * std::f64::consts::PI * 0.5);
    let found = sum / (6.0 * model.end()) / alone;
    let error = 0.46454 * (2.0 / (3.0 * model.steps as f64)).sqrt();
    assert!((found - 0.46454).abs() < 3.5 * error, "{found} +- {error}");
    assert!(suspension.clipped() < 1e-12);
}

/// Spheres in shear, some of them near each other, across the faces of the box.
const SHEARED: &str = r#"
seed = 5
box.edges = [10.0, 9.0, 9.0]
fluid = { viscosity = 1.0, thermal_energy = 0.5 }
flow = { kind = "shear", rate = 4.0 }
repulsion = { strength = 30.0, range = 0.2 }
hydrodynamics = { lubrication = true, tolerance = 1e-3 }
particles = { initial = "positions", positions = [[5.0, 8.6, 4.0], [7.2, 0.6, 4.5], [3.0, 4.0, 2.0], [8.0, 5.0, 8.0]] }
time = { step = 0.01, steps = 20 }
[[species]]
radius = 1.0
count = 3
[[species]]
radius = 1.4
count = 1
"#;

/// The same between walls, and in unbounded fluid.
const WALLS: [&str; 2] =
    [r#"box={edges=[10.0,9.0,9.6],boundaries=["periodic","periodic","walls"]}"#, r#"flow={kind="shear",rate=0.4}"#];
const OPEN: [&str; 2] = [r#"box={boundaries=["open","open","open"]}"#, r#"flow={kind="none"}"#];

fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

/// The scheme with two evaluations.
const TWO: &str = r#"time.brownian="random-finite-difference""#;
const TIGHT: &str = "hydrodynamics.tolerance=1e-5";

#[test]
#[ignore = "heavy"]
fn a_resumed_run_has_the_same_bits() {
    let steady = r#"flow={kind="shear",rate=4.0}"#;
    let oscillating = r#"flow={kind="shear",oscillation={amplitude=0.8,frequency=9.0}}"#;
    let midpoint = r#"time.brownian="drifter-corrector""#;
    let periodic = [[steady, midpoint], [oscillating, midpoint], [steady, TWO], [oscillating, TWO]].map(Vec::from);
    let bounded =
        [WALLS, OPEN].into_iter().flat_map(|of| [midpoint, TWO].map(|scheme| [of[0], of[1], scheme].to_vec()));
    for keys in periodic.into_iter().chain(bounded) {
        let model = model_of(SHEARED, &keys);
        let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
        for step in 0..model.steps {
            let mut resumed = Suspension::resume(&model, Some(whole.state()), &Comm::alone()).unwrap();
            whole.step().unwrap();
            resumed.step().unwrap();
            assert_eq!(whole.gathered(None), resumed.gathered(None), "after step {step}");
        }
    }
}

/// Steps whose motions are not evaluated for output lead to the same positions, bit for bit.
#[test]
fn steps_are_the_same_unseen() {
    let places = |scheme: &str, is_seen: bool| {
        let mut suspension = Suspension::start(&model_of(SHEARED, &[scheme]), &Comm::alone()).unwrap();
        (0..3).for_each(|_| suspension.step_seen(is_seen).unwrap());
        suspension.gathered(None).positions
    };
    for scheme in [r#"time.brownian="drifter-corrector""#, TWO] {
        assert_eq!(places(scheme, true), places(scheme, false), "{scheme}");
    }
}

#[test]
#[ignore = "heavy"]
fn ranks_agree() {
    for of in [&[][..], &WALLS, &OPEN] {
        let model = model_of(SHEARED, &[&["hydrodynamics.tolerance=1e-7", "time.steps=6"], of].concat());
        let alone = run(&model, 1);
        for ranks in [2, 7] {
            let error = largest_distance(&alone, &run(&model, ranks));
            assert!(error < 1e-6, "{of:?}, {ranks} ranks: {error}");
        }
    }
}

fn largest_distance(a: &Particles, b: &Particles) -> f64 {
    a.positions.iter().zip(&b.positions).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max)
}

/// The finite difference of random motions is accurate to 3%, and the end of its iteration may depend on the ranks: so
/// the drift in 6 steps, about 0.02 in each, agrees to that accuracy.
#[test]
fn ranks_agree_by_two_evaluations() {
    let model = model_of(SHEARED, &["hydrodynamics.tolerance=1e-7", "time.steps=6", TWO]);
    let alone = run(&model, 1);
    for ranks in [2, 7] {
        let error = largest_distance(&alone, &run(&model, ranks));
        assert!(error < 2e-3, "{ranks} ranks: {error}");
    }
}

/// With the same random numbers both schemes take the same steps up to their drift and higher orders of the step: the
/// difference per step is small compared with a step, and decreases by more than half if steps are four times shorter.
#[test]
fn both_schemes_move_spheres_alike() {
    let distances = |step: f64| {
        let ends = ["time.steps=1", "time.steps=0"].map(str::to_owned);
        let step = format!("time.step={step}");
        let [midpoint, two] = [r#"time.brownian="drifter-corrector""#, TWO]
            .map(|scheme| run(&model_of(SHEARED, &[TIGHT, &ends[0], &step, scheme]), 1));
        let start = run(&model_of(SHEARED, &[&ends[1], &step]), 1);
        [largest_distance(&midpoint, &two), largest_distance(&midpoint, &start)]
    };
    let [[apart, far], [apart_then, far_then]] = [4e-5, 1e-5].map(distances);
    assert!(
        apart < 0.2 * far && apart_then < 0.2 * far_then && apart_then < 0.5 * apart,
        "{apart} {far} {apart_then} {far_then}"
    );
}

/// With two evaluations the Brownian stress has its own column and contributes to the viscosity; with the midpoint
/// scheme it has none.
#[test]
fn stress_by_heat_is_told_apart() {
    let row = |scheme: &str| {
        let model = model_of(SHEARED, &["time.steps=2", scheme]);
        let mut observed = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
        (0..2).for_each(|step| observed.advance(step + 1).unwrap());
        let names: Vec<_> = observed.quantities().into_iter().map(|quantity| quantity.name).collect();
        names.into_iter().zip(observed.observe()).collect::<Vec<_>>()
    };
    let two = row(TWO);
    let of = |name: &str| &two.iter().find(|(found, _)| found == name).unwrap().1;
    let xy = |name: &str| of(name)[1] + of(name)[7];
    let parts = ["stress_stresslet", "stress_lubrication", "stress_repulsion", "stress_brownian"];
    let sum: f64 = parts.into_iter().map(xy).sum();
    assert!(xy("stress_brownian").abs() > 1e-8);
    let found = of("relative_viscosity")[0];
    assert!((found - 1.0 - sum / 4.0).abs() < 1e-12 * found.abs(), "{found} is not that of {sum}");
    assert!(row(r#"time.brownian="drifter-corrector""#).iter().all(|(name, _)| *name != "stress_brownian"));
}

/// The osmotic pressure is the sum of that of an ideal gas and of the repulsion.
#[test]
fn the_osmotic_pressure_is_that_of_a_gas_and_of_forces() {
    let model = model_of(SHEARED, &["flow={kind=\"none\"}", "time.steps=3", "repulsion.range=1.0"]);
    let mut observed = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    (0..3).for_each(|step| observed.advance(step + 1).unwrap());
    let place = observed.quantities().iter().position(|quantity| quantity.name == "osmotic_pressure").unwrap();
    let found = observed.observe()[place][0];
    let stress = observed.suspension().stress(2);
    let pushed: f64 = stress.iter().map(|s| s.of("repulsion")).map(|s| s.x_axis.x + s.y_axis.y + s.z_axis.z).sum();
    let expected = 4.0 * 0.5 / (10.0 * 9.0 * 9.0) - pushed / 3.0;
    assert!(pushed < 0.0 && (found / expected - 1.0).abs() < 1e-12, "{found} is not {expected}");
}

/// Another seed gives other positions; spheres with forces alone move, too.
#[test]
fn seeds_matter() {
    let places = |keys: &[&str]| run(&model_of(SHEARED, keys), 1).positions;
    assert_ne!(places(&["time.steps=2"]), places(&["time.steps=2", "seed=6"]));
    let forces_alone = ["time.steps=2", "hydrodynamics={multipoles=\"monopole\",tolerance=1e-3}"];
    assert!(places(&forces_alone).iter().all(|place: &Vector| place.is_finite()));
}

/// Rows of the time series of a run, by name, and the warnings at its end.
fn told(model: &Model, ranks: usize) -> (Vec<[f64; 3]>, Vec<String>) {
    let names = ["overlapping_pairs", "pairs_at_least_gap", "deepest_overlap"];
    let mut all = Comm::threads(ranks, |comm| {
        let mut observed = SuspensionRun::start(model, None, &comm).unwrap();
        let quantities = observed.quantities();
        let place = |name| quantities.iter().position(|quantity| quantity.name == name).unwrap();
        let rows = (0..model.steps).map(|_| {
            observed.advance(model.steps).unwrap();
            let row = observed.observe();
            names.map(|name| row[place(name)][0])
        });
        (rows.collect(), observed.warnings())
    });
    all.swap_remove(0)
}

/// Two near spheres separated by lubrication alone, in steps whose noise ignores lubrication; then with repulsion and
/// shorter steps, also with solves at the present positions instead of half a step of noise ahead.
#[test]
fn runs_in_which_spheres_overlap_say_so() {
    let near = &[
        "repulsion.strength=1e-3",
        "time.step=0.02",
        r#"flow={kind="shear",rate=0.1}"#,
        "particles.positions=[[5.0,8.6,4.0],[7.005,8.6,4.0],[3.0,4.0,2.0],[8.0,5.0,7.0]]",
    ][..];
    let (rows, said) = told(&model_of(SHEARED, near), 1);
    let with_overlap = rows.iter().filter(|[pairs, ..]| *pairs > 0.0).count();
    assert!(with_overlap > 2, "{rows:?}");
    assert!(rows.iter().all(|[pairs, at_floor, depth]| pairs <= at_floor && (*pairs > 0.0) == (*depth > 0.0)));
    let deepest = rows.iter().fold(0.0, |most: f64, [.., depth]| most.max(*depth));
    let said = said.iter().find(|said| said.contains("solved for")).unwrap();
    let expected = format!("spheres overlapped in {with_overlap} of 20 steps where");
    assert!(said.starts_with(&expected) && said.contains("random-finite-difference") && deepest > 0.0, "{said}");
    let (on_ranks, _) = told(&model_of(SHEARED, near), 3);
    assert!(rows.iter().zip(&on_ranks).all(|(a, b)| a[..2] == b[..2] && (a[2] - b[2]).abs() < 1e-4), "{on_ranks:?}");
    let calm = ["particles.positions=[[5.0,8.6,4.0],[7.6,8.6,4.0],[3.0,4.0,2.0],[8.0,5.0,7.0]]", "time.step=5e-4"];
    for more in [&calm[..], &[calm[0], calm[1], TWO]] {
        let (rows, said) = told(&model_of(SHEARED, more), 1);
        assert_eq!((rows, said), (vec![[0.0; 3]; 20], Vec::new()), "{more:?}");
    }
}

/// Nearly touching spheres among random ones in shear are not driven into each other. This did happen when a pair
/// overlapped: by more than a radius with two evaluations, since the effect of shear on a pair at the minimum gap
/// changes over their small displacement.
#[test]
fn spheres_that_nearly_touch_come_apart_in_shear() {
    const CROWDED: &str = r#"
box.edges = [6.9, 6.9, 6.9]
fluid = { viscosity = 1.0, thermal_energy = 1.0 }
flow = { kind = "shear", rate = 0.1 }
repulsion = { strength = 60.0, range = 0.4 }
hydrodynamics = { lubrication = true, tolerance = 1e-2 }
time = { step = 0.0377, steps = 20 }
[[species]]
radius = 1.0
count = 24
"#;
    for (seed, scheme) in
        [1, 2, 4].into_iter().flat_map(|seed| [(seed, r#"time.brownian="drifter-corrector""#), (seed, TWO)])
    {
        let (rows, _) = told(&model_of(CROWDED, &[scheme, &format!("seed={seed}")]), 1);
        let deepest = rows.iter().fold(0.0, |most: f64, [.., depth]| most.max(*depth));
        assert!(deepest < 0.3, "{scheme}, seed {seed}: {deepest}");
    }
}
