//! User-defined forces and torques, in addition to those of the model.

use crate::support::model_of;
use domain::{Comm, Particles, Tensor, Vector};
use simulation::{AppliedLoads, LoadFunction, NeighbourList, UserLoads};
use std::cell::RefCell;
use std::error::Error;
use std::rc::Rc;
use suspension::{Model, Suspension};

const SCENE: &str = r#"
seed = 3
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.5 }
hydrodynamics = { tolerance = 1e-4, method = "direct", iteration_tolerance = 1e-9 }
time = { step = 0.05, steps = 3 }
species = [{ radius = 1.0, count = 12 }]
"#;

const FORCE: Vector = Vector::new(1.0, 0.5, -6.0);
const TORQUE: Vector = Vector::new(0.0, 2.0, 1.0);

/// The same force and torque on all particles.
fn constant(force: Vector, torque: Vector) -> LoadFunction {
    Box::new(move |positions, _| {
        let (forces, torques) = (vec![force; positions.len()], vec![torque; positions.len()]);
        Ok(AppliedLoads { forces, torques, ..AppliedLoads::default() })
    })
}

/// Pulls each sphere towards its initial position, with a stiffness that grows in time.
fn springs(places: Vec<Vector>) -> LoadFunction {
    Box::new(move |positions, time| {
        let forces = positions.iter().zip(&places).map(|(x, x0)| (3.0 + time) * (*x0 - *x)).collect();
        Ok(AppliedLoads { forces, ..AppliedLoads::default() })
    })
}

/// Invalid loads for a number of particles.
type Wrong = fn(usize) -> Result<AppliedLoads, Box<dyn Error>>;

fn take_steps(suspension: &mut Suspension, steps: u64) {
    for _ in 0..steps {
        suspension.step().unwrap();
    }
}

fn run(model: &Model, ranks: usize, loads: fn() -> Vec<LoadFunction>) -> Particles {
    let all = Comm::threads(ranks, |comm| {
        let mut suspension = Suspension::start(model, &comm).unwrap();
        for loads in loads() {
            suspension.add_loads(loads).unwrap();
        }
        take_steps(&mut suspension, model.steps);
        suspension.gathered(Some(&["velocity", "angular_velocity"]))
    });
    all.into_iter().next().unwrap()
}

fn largest_difference(one: &Particles, other: &Particles) -> f64 {
    let all = |p: &Particles| {
        let places = p.positions.iter().flat_map(Vector::to_array).collect::<Vec<_>>();
        places.into_iter().chain(p.columns.iter().flat_map(|c| c.values.clone())).collect::<Vec<_>>()
    };
    assert_eq!((one.steps.clone(), all(one).len()), (other.steps.clone(), all(other).len()));
    all(one).iter().zip(all(other)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Two functions that each give half of a species' load are equivalent to that load, in every stage of every
/// integrator.
#[test]
#[ignore = "heavy"]
fn a_constant_load_is_that_of_the_species() {
    let load = format!("species=[{{ radius = 1.0, count = 12, force = {FORCE}, torque = {TORQUE} }}]");
    let halves = || vec![constant(FORCE / 2.0, TORQUE / 2.0), constant(FORCE / 2.0, TORQUE / 2.0)];
    for way in ["time.integrator=\"adams-bashforth\"", "time.integrator=\"adaptive\"", "hydrodynamics.lubrication=true"]
    {
        let expected = run(&model_of(SCENE, &[way, &load]), 1, Vec::new);
        for ranks in [1, 3] {
            let difference = largest_difference(&expected, &run(&model_of(SCENE, &[way]), ranks, halves));
            // Tolerance: stresslets differ within the tolerance of the iteration.
            assert!(difference < 1e-7, "{difference:e} with {way} on {ranks} ranks");
        }
    }
}

#[test]
fn point_forces_alone_take_forces() {
    let [points, load] = ["hydrodynamics.multipoles=\"monopole\"", "species[0].force=[1.0, 0.5, -6.0]"];
    let expected = run(&model_of(SCENE, &[points, load]), 1, Vec::new);
    let found = run(&model_of(SCENE, &[points]), 1, || vec![constant(FORCE, Vector::ZERO)]);
    assert!(largest_difference(&expected, &found) < 1e-12);
}

/// A Runge-Kutta step, then two Adams-Bashforth steps.
#[test]
fn functions_hear_the_time_of_each_evaluation() {
    let model = model_of(SCENE, &["time.order=2"]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let times = Rc::new(RefCell::new(Vec::new()));
    let heard = times.clone();
    suspension
        .add_loads(Box::new(move |_, time| {
            heard.borrow_mut().push(time);
            Ok(AppliedLoads::default())
        }))
        .unwrap();
    take_steps(&mut suspension, 3);
    let steps = [0.0, 0.5, 0.5, 1.0, 1.0, 2.0, 3.0];
    assert_eq!(*times.borrow(), steps.map(|step| step * 0.05));
}

/// A sphere that is pulled through a face of the box has a continuous position.
#[test]
fn positions_know_no_periodicity() {
    let fast = "species=[{ radius = 1.0, count = 1, force = [0.0, 0.0, -2000.0] }]";
    let model = model_of(SCENE, &[fast, "flow={ kind = \"none\" }"]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let heights = Rc::new(RefCell::new(Vec::new()));
    let heard = heights.clone();
    suspension
        .add_loads(Box::new(move |positions: &[Vector], _| {
            heard.borrow_mut().push(positions[0].z);
            Ok(AppliedLoads::default())
        }))
        .unwrap();
    take_steps(&mut suspension, 6);
    let heights = heights.borrow();
    let fallen = heights[0] - heights.last().unwrap();
    assert!(fallen > 14.0, "through the whole box, not by {fallen}");
    assert!(heights.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 6.0), "{heights:?}");
}

#[test]
fn runs_go_on_bit_for_bit() {
    for way in ["time.integrator=\"adams-bashforth\"", "time.integrator=\"adaptive\""] {
        let model = model_of(SCENE, &[way]);
        let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
        let places = whole.gathered(Some(&[])).positions;
        whole.add_loads(springs(places.to_vec())).unwrap();
        take_steps(&mut whole, 3);
        let mut resumed = Suspension::resume(&model, Some(whole.state()), &Comm::alone()).unwrap();
        resumed.add_loads(springs(places.into_vec())).unwrap();
        take_steps(&mut whole, 3);
        take_steps(&mut resumed, 3);
        assert_eq!(whole.state(), resumed.state(), "{way}");
    }
}

#[test]
fn loads_that_are_none_leave_everything_as_it_was() {
    let cases: [(Wrong, &str); 3] = [
        (|_| Err("no such spring".into()), "no such spring"),
        (
            |_| Ok(AppliedLoads { torques: vec![FORCE; 5], ..AppliedLoads::default() }),
            "it gave 5 torques for 12 particles; it needs to give one for each",
        ),
        (
            |n| Ok(AppliedLoads { forces: vec![Vector::new(0.0, f64::NAN, 0.0); n], ..AppliedLoads::default() }),
            "its forces have [0, NaN, 0] on particle 0; they need to be finite",
        ),
    ];
    let model = model_of(SCENE, &[]);
    for (wrong, message) in cases {
        for ranks in [1, 2] {
            Comm::threads(ranks, |comm| {
                let mut suspension = Suspension::start(&model, &comm).unwrap();
                let before = suspension.state();
                let error = suspension.add_loads(Box::new(move |positions, _| wrong(positions.len()))).unwrap_err();
                assert_eq!(error.to_string(), format!("step 0: a force of one's own: {message}"));
                assert_eq!(suspension.state(), before);
                let from_the_third_stage = move |positions: &[Vector], time| {
                    if time > 0.05 { wrong(positions.len()) } else { Ok(AppliedLoads::default()) }
                };
                suspension.add_loads(Box::new(from_the_third_stage)).unwrap();
                suspension.step().unwrap();
                let before = suspension.state();
                let error = suspension.step().unwrap_err();
                assert_eq!(error.to_string(), format!("step 1: a force of one's own: {message}"));
                assert_eq!(suspension.state(), before);
            });
        }
    }
}

/// Springs between near spheres.
fn pair_springs(cutoff: f64) -> UserLoads {
    let function = |near: &NeighbourList, _: f64| Ok(near.separations.iter().map(|d| 0.5 * *d).collect());
    UserLoads::OfPairs { cutoff, function: Box::new(function) }
}

/// Forces of pairs and their moments are the same on any number of ranks, and add up to those of all pairs.
#[test]
fn forces_of_pairs_have_their_stress() {
    let model = model_of(SCENE, &["time.steps=2"]);
    let found = [1, 3].map(|ranks| {
        let all = Comm::threads(ranks, |comm| {
            let mut suspension = Suspension::start(&model, &comm).unwrap();
            assert!(!suspension.has_applied_stress());
            suspension.add_own_loads(pair_springs(4.0)).unwrap();
            take_steps(&mut suspension, 2);
            let (stress, all) = (suspension.stress(1)[0].of("applied"), suspension.gathered(Some(&["velocity"])));
            let near = comm.is_first().then(|| NeighbourList::find(&all, suspension.cell(), [true; 3], 4.0).unwrap());
            let of_pair =
                |d: &Vector| Tensor::from_cols(*d * d.x, *d * d.y, *d * d.z) * (0.5 / suspension.cell().volume());
            let expected = near.map(|near| near.separations.iter().map(of_pair).fold(Tensor::ZERO, |sum, m| sum + m));
            (stress, expected, all)
        });
        all.into_iter().next().unwrap()
    });
    let [(one, expected, particles), (three, _, others)] = found;
    let size = one.to_cols_array().map(f64::abs).into_iter().fold(0.0, f64::max);
    assert!(size > 1e-3 && (one - expected.unwrap()).to_cols_array().iter().all(|left| left.abs() < 1e-12 * size));
    assert!((one - three).to_cols_array().iter().all(|left| left.abs() < 1e-6 * size));
    assert!(largest_difference(&particles, &others) < 1e-6);
}

#[test]
fn forces_of_pairs_go_on_bit_for_bit() {
    let model = model_of(SCENE, &["time.steps=4"]);
    let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
    whole.add_own_loads(pair_springs(4.0)).unwrap();
    take_steps(&mut whole, 2);
    let mut resumed = Suspension::resume(&model, Some(whole.state()), &Comm::alone()).unwrap();
    assert!(resumed.has_applied_stress());
    resumed.add_own_loads(pair_springs(4.0)).unwrap();
    take_steps(&mut whole, 2);
    take_steps(&mut resumed, 2);
    assert_eq!(whole.state(), resumed.state());
}
