//! Spheres with orientations.

use crate::support::ended::ended;
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{AxisRotation, Comm, Particles, Quaternion, Random, Vector};
use simulation::{Rearrangement, Simulation};
use suspension::{ANGULAR_VELOCITY, Model, ORIENTATION, Suspension, SuspensionRun};

/// A sphere in unbounded fluid that is sheared.
const ALONE: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 1.0 }
particles = { initial = "positions", positions = [[0.0, 0.0, 0.0]] }
hydrodynamics = { tolerance = 1e-3, iteration_tolerance = 1e-12 }
time = { step = 4.1887902047863905, steps = 3000 }
species = [{ radius = 1.0, count = 1, orientation = "aligned", orientation_axis = [0.0, 2.0, 1.0] }]
"#;

fn orientations(particles: &Particles) -> Vec<Quaternion> {
    let column = particles.columns.iter().find(|column| column.name == ORIENTATION).expect("orientations");
    let (all, _) = column.values.as_chunks::<4>();
    all.iter().map(|q| Quaternion::from_array(*q)).collect()
}

/// Angle between two orientations.
fn angle(a: Quaternion, b: Quaternion) -> f64 {
    (a * b.inverse()).log().length()
}

fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

/// A sphere in shear rotates at half the rate, within the tolerance of the method, here by 1,000 turns in 3 steps each.
/// Orientations are exact for its angular velocity, which is constant up to the error of iteration, by all integrators.
#[test]
fn a_sphere_in_shear_turns_at_half_the_rate() {
    let start = Quaternion::between(Vector::Z, Vector::new(0.0, 2.0, 1.0));
    for keys in [
        &["time.order=4"][..],
        &["time.order=2", "time.steps=60"],
        &["time.integrator=adaptive", "time.steps=20", "time.step=0.5"],
        &["time.integrator=implicit", "time.steps=20", "time.step=0.5"],
    ] {
        let model = model_of(ALONE, keys);
        let mut particles = run(&model, 1);
        let (end, turning) = (orientations(&particles)[0], particles.vectors(ANGULAR_VELOCITY)[0]);
        assert!((turning + 0.5 * Vector::Z).length() < 1e-3, "{keys:?}: {turning}");
        let error = angle(end, Quaternion::exp(turning * model.end()) * start);
        assert!(error < 1e-8, "{keys:?}: {error}");
    }
}

/// Spheres near each other, which rotate about changing axes under forces and torques.
const THREE: &str = r#"
seed = 4
box.edges = [9.0, 9.0, 9.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.2 }
particles = { initial = "positions", positions = [[3.0, 4.0, 4.0], [5.3, 4.2, 4.4], [4.0, 6.2, 3.6]] }
hydrodynamics = { method = "dense", tolerance = 1e-6, iteration_tolerance = 1e-11 }
time = { step = 0.05, steps = 16 }
[[species]]
radius = 1.0
count = 2
force = [1.0, 0.0, -3.0]
torque = [8.0, -12.0, 4.0]
orientation = "random"
[[species]]
radius = 1.2
count = 1
torque = [0.0, 16.0, 10.0]
orientation = "aligned"
orientation_axis = [1.0, 0.0, 0.0]
"#;

/// Largest angle between the orientations of two runs.
fn farthest(a: &[Quaternion], b: &[Quaternion]) -> f64 {
    a.iter().zip(b).map(|(a, b)| angle(*a, *b)).fold(0.0, f64::max)
}

/// Orientations of interacting spheres have the order of the steps, as positions have, and variable steps lead to the
/// same orientations within their tolerance.
#[test]
fn orientations_have_the_order_of_the_step() {
    let at_end = |keys: &[&str]| orientations(&run(&model_of(THREE, keys), 1));
    let exact = at_end(&["time.step=0.00625", "time.steps=128"]);
    for order in [2, 3, 4] {
        let error = |step: f64, steps: u64| {
            let [step, steps, order] =
                [format!("time.step={step}"), format!("time.steps={steps}"), format!("time.order={order}")];
            farthest(&at_end(&[&step, &steps, &order]), &exact)
        };
        let (coarse, fine) = (error(0.05, 16), error(0.025, 32));
        let found = (coarse / fine).log2();
        assert!(found > f64::from(order) - 0.6 && coarse < 0.05, "order {found}, not {order}: {coarse}, {fine}");
    }
    for integrator in ["adaptive", "implicit"] {
        let name = format!("time.integrator={integrator}");
        let error = |tolerance: &str| farthest(&at_end(&[&name, tolerance, "time.step=0.8", "time.steps=1"]), &exact);
        let (coarse, fine) = (error("time.tolerance=1e-3"), error("time.tolerance=1e-5"));
        assert!(coarse < 0.03 && fine < 0.5 * coarse && fine < 1e-3, "{integrator}: {coarse}, {fine}");
    }
}

const INTEGRATORS: [&[&str]; 5] = [
    &["time.order=3"],
    &["time.integrator=\"adaptive\""],
    &["time.integrator=\"implicit\""],
    &["fluid.thermal_energy=0.05", "time.brownian=\"drifter-corrector\""],
    &["fluid.thermal_energy=0.05", "time.brownian=\"random-finite-difference\""],
];

/// A run that is resumed after any step has the bits of one that is not, for all integrators, in statistics too.
#[test]
fn a_resumed_run_has_the_same_bits() {
    for keys in INTEGRATORS {
        let keys = [keys, &["time.steps=5", "statistics={every=1}"]].concat();
        let model = model_of(THREE, &keys);
        resumes_with_the_same_bits(&model, &format!("{keys:?}"));
    }
}

/// Ranks agree as for positions, and threads to the last bit.
#[test]
#[ignore = "heavy"]
fn ranks_and_threads_agree() {
    for keys in INTEGRATORS {
        let model = model_of(THREE, &[keys, &["time.steps=4"]].concat());
        let alone = run(&model, 1);
        // The finite difference of random motions is accurate to 3%, and may depend on the ranks.
        let allowed = if keys.iter().any(|key| key.contains("finite")) { 2e-3 } else { 1e-6 };
        for ranks in [2, 3, 7] {
            let apart = farthest(&orientations(&alone), &orientations(&run(&model, ranks)));
            assert!(apart < allowed, "{keys:?} on {ranks} ranks: {apart:e}");
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        assert_eq!(pool.install(|| run(&model, 1)), alone, "{keys:?}");
    }
}

/// Without orientations there is no column of them, and with them spheres move as without, bit for bit, unless the
/// length of steps is limited by their rotation.
#[test]
fn spheres_move_as_without_orientations() {
    let is_other = |line: &&str| !line.starts_with("orientation");
    let bare = THREE.lines().filter(is_other).collect::<Vec<_>>().join("\n");
    let of = |keys: &[&str]| [model_of(&bare, keys), model_of(THREE, keys)].map(|model| run(&model, 1));
    for keys in [INTEGRATORS[0], INTEGRATORS[3], INTEGRATORS[4]] {
        let [bare, oriented] = of(&[keys, &["time.steps=4"]].concat());
        assert!(bare.columns.iter().all(|column| !column.name.contains("orientation") && column.width != 4));
        assert!(bare.columns.iter().all(|column| !column.name.contains("past angular")));
        assert_eq!(bare.positions, oriented.positions);
        for column in &bare.columns {
            assert!(oriented.columns.contains(column), "{}", column.name);
        }
    }
}

/// Random orientations depend on the seed and the id alone, and a species without orientations has zeros.
#[test]
fn starts_are_the_same_on_any_ranks() {
    let keys = ["time.steps=0", "species=[{radius=0.5,count=40,orientation=\"random\"},{radius=0.4,count=7}]"];
    let model = model_of(THREE, &[&keys[..], &["particles={initial=\"random\"}"]].concat());
    let alone = orientations(&run(&model, 1));
    for ranks in [2, 3, 7] {
        assert_eq!(orientations(&run(&model, ranks)), alone, "{ranks} ranks");
    }
    assert!(alone[..40].iter().all(|q| (q.length() - 1.0).abs() < 1e-14));
    assert!(alone[40..].iter().all(|q| *q == Quaternion::NONE));
    let distinct = alone[..40].windows(2).filter(|pair| angle(pair[0], pair[1]) > 1e-3).count();
    assert_eq!(distinct, 39);
    let mean: Vector = alone[..40].iter().map(|q| q.axis()).sum::<Vector>() / 40.0;
    assert!(mean.length() < 0.5, "{mean}");
    assert_ne!(Quaternion::random(&mut Random::new(4, 0)), alone[0], "positions and orientations are independent");
}

/// The rotation of a Brownian sphere has the diffusivity kT / (8 pi mu a^3), times its rotational mobility in a
/// periodic box over that of an isolated sphere, 1 - 4 pi / 3 (a / L)^3 = 0.96649 at 5 radii.
#[test]
fn a_sphere_rotates_at_random_as_fast_as_it_rotates() {
    let scene = r#"
seed = 3
box.edges = [5.0, 5.0, 5.0]
fluid = { viscosity = 0.5, thermal_energy = 2.0 }
particles = { initial = "positions", positions = [[1.0, 4.0, 2.0]] }
hydrodynamics.tolerance = 1e-3
time = { step = 0.01, steps = 1500 }
species = [{ radius = 1.0, count = 1, orientation = "random" }]
"#;
    for (scheme, steps) in [("drifter-corrector", 2000), ("random-finite-difference", 600)] {
        let [scheme, keyed] = [format!("time.brownian={scheme}"), format!("time.steps={steps}")];
        let model = model_of(scene, &[&scheme, &keyed]);
        let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
        let (mut before, mut sum) = (orientations(suspension.particles())[0], 0.0);
        for _ in 0..model.steps {
            suspension.step_seen(false).unwrap();
            let now = orientations(suspension.particles())[0];
            sum += (now * before.inverse()).log().length_squared();
            before = now;
        }
        let alone = 2.0 / (8.0 * std::f64::consts::PI * 0.5);
        let found = sum / (6.0 * model.end()) / alone;
        let error = 0.96649 * (2.0 / (3.0 * model.steps as f64)).sqrt();
        assert!((found - 0.96649).abs() < 3.5 * error, "{scheme}: {found} +- {error}");
    }
}

/// With walls across another axis than z, axes are those with walls across z, rotated, and random orientations are the
/// same in the axes of the user.
#[test]
fn orientations_are_in_the_axes_of_the_user() {
    let of = |axis: usize| {
        let back = AxisRotation::to_last(axis).inverse();
        let edges = back.list([9.0, 8.0, 10.0]);
        let vector = |v: [f64; 3]| back.vector(v.into()).to_array();
        let places = [[3.0, 4.0, 4.0], [5.3, 4.2, 4.4]].map(|v| back.place(v.into(), edges.into()).to_array());
        let keys = [
            format!("box={{edges={edges:?},boundaries={:?}}}", back.list(["periodic", "periodic", "walls"])),
            format!("particles={{initial='positions',positions={places:?}}}"),
            format!("species[0].torque={:?}", vector([0.3, -0.8, 0.4])),
            format!("species[1].orientation_axis={:?}", vector([1.0, 0.5, 0.0])),
            "species[0].count=1".to_owned(),
            "species[0].force=[0,0,0]".to_owned(),
            format!("species[1].torque={:?}", vector([0.1, 0.5, -0.2])),
            "flow={kind='none'}".to_owned(),
            "hydrodynamics={tolerance=1e-4,iteration_tolerance=1e-11}".to_owned(),
        ];
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        let frame = |steps: &str| {
            let model = model_of(THREE, &[&keys[..], &[steps]].concat());
            let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
            (1..=model.steps).for_each(|step| run.advance(step).unwrap());
            let rows = run.observe();
            let place = run.quantities().iter().position(|quantity| quantity.name == "orientation").unwrap();
            (orientations(&run.frame().particles), rows[place].clone())
        };
        let ([start, end], row) = ([frame("time.steps=0").0, frame("time.steps=3").0], frame("time.steps=3").1);
        assert!((Vector::from_slice(&row[5..]) - end[1].axis()).length() < 1e-14 && row.len() == 10);
        (start, back.inverse().vector(end[1].axis()))
    };
    let (start, upright) = of(2);
    for axis in [0, 1] {
        let (found, rotated) = of(axis);
        assert!(angle(found[0], start[0]) < 1e-14, "random orientations");
        assert!((rotated - upright).length() < 1e-9, "{axis}: {rotated}, not {upright}");
    }
}

/// A user changes orientations: they are those of the user, normalised, and everything else is as before.
#[test]
fn orientations_are_as_the_user_sets_them() {
    let model = model_of(THREE, &["time.steps=3"]);
    let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    run.advance(1).unwrap();
    let wanted = Quaternion::exp(Vector::new(0.2, -0.5, 0.4));
    let of = |q| Rearrangement { orientations: vec![(1, q)], ..Rearrangement::default() };
    let state = run.state();
    let doubled = Quaternion { w: 2.0 * wanted.w, v: 2.0 * wanted.v };
    let changed = run.rearranged(state, &of(doubled)).unwrap();
    let resumed = SuspensionRun::resume(&model, Some(changed), &Comm::alone()).unwrap();
    let (before, after) = (orientations(&run.frame().particles), orientations(&resumed.frame().particles));
    assert!(angle(after[1], wanted) < 1e-15 && [after[0], after[2]] == [before[0], before[2]]);
    let state = run.state();
    assert!(run.rearranged(state, &of(Quaternion::NONE)).unwrap_err().to_string().contains("needs a quaternion"));
}
