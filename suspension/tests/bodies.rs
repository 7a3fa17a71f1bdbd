//! Rigid bodies in runs.

use crate::support::ended::{ranks_agree, run};
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, Particles, PeriodicBox, Quaternion, Vector};
use simulation::{Rearrangement, Simulation};
use std::f64::consts::PI;
use suspension::{ANGULAR_VELOCITY, BODY, ORIENTATION, ParticleStress, Suspension, SuspensionRun, VELOCITY};

/// Bodies and spheres near each other, which rotate about changing axes.
const FEW: &str = r#"
seed = 4
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 0.4 }
particles = { initial = "positions", positions = [[1.0, 10.0, 4.0], [8.0, 8.2, 4.4]] }
hydrodynamics = { tolerance = 1e-2, iteration_tolerance = 1e-9 }
time = { step = 0.1, steps = 12 }
[[species]]
radius = 1.0
count = 2
[[bodies]]
shape = "doublet"
radius = 1.0
positions = [[4.0, 4.0, 4.0], [6.4, 6.0, 3.6]]
torque = [0.0, 20.0, 4.0]
[[bodies]]
name = "club"
spheres = [{ position = [0.0, 0.0, 0.0], radius = 0.8 }, { position = [0.0, 0.0, 1.5], radius = 0.6 }]
positions = [[11.5, 11.8, 9.0]]
force = [3.0, 0.0, -9.0]
"#;

/// Keys of all integrators, the Brownian one first.
pub const INTEGRATORS: [&[&str]; 5] = [
    &["fluid.thermal_energy=0.05", "hydrodynamics.lubrication=true"],
    &["time.order=4"],
    &["time.order=2", "hydrodynamics.lubrication=true"],
    &["time.integrator=\"adaptive\"", "hydrodynamics.lubrication=true"],
    &["time.integrator=\"implicit\"", "hydrodynamics.lubrication=true", "contacts={friction=0.5}"],
];

/// A box with walls, in which the bodies are away from them.
const WALLS: &str = "box={edges=[12.0,12.0,12.0],boundaries=[\"periodic\",\"periodic\",\"walls\"]}";

fn orientations(particles: &Particles) -> Vec<Quaternion> {
    particles.rows::<4>(ORIENTATION).expect("orientations").iter().map(|q| Quaternion::from_array(*q)).collect()
}

/// Largest deviation of the distances within bodies, and of the orientations, from those of rigid bodies.
fn deformation(cell: &PeriodicBox, particles: &Particles) -> f64 {
    let (bodies, turns) = (particles.rows::<1>(BODY).expect("bodies"), orientations(particles));
    let pairs = [[2, 3], [4, 5], [6, 7]];
    let apart = pairs.into_iter().zip([2.0, 2.0, 1.5]).map(|([i, j], expected)| {
        assert_eq!(bodies[i].map(f64::to_bits), bodies[j].map(f64::to_bits));
        let separation = cell.nearest_image(particles.positions[i] - particles.positions[j]);
        let turned = (turns[i] * turns[j].inverse()).log().length();
        (separation.length() - expected).abs() + turned
    });
    apart.fold(0.0, f64::max)
}

/// Spheres of a body keep their distances to round-off by all integrators, also across the faces of the sheared box.
#[test]
#[ignore = "heavy"]
fn bodies_stay_rigid() {
    for keys in INTEGRATORS {
        let driven = ["time.steps=60", "flow={kind=\"poiseuille\",pressure_gradient=0.1}", WALLS];
        let still = ["time.steps=60", "flow={kind=\"none\"}"];
        for keys in [[keys, &["time.steps=60"]].concat(), [keys, &still].concat(), [keys, &driven].concat()] {
            let model = model_of(FEW, &keys);
            let start = run(&model_of(FEW, &[&keys[..], &["time.steps=0"]].concat()), 1);
            let end = run(&model, 1);
            let [before, after] = [orientations(&start), orientations(&end)];
            let turned = [2, 4].map(|row| before[row].axis().dot(after[row].axis()));
            assert!(turned.iter().any(|cosine| *cosine < 0.8), "{keys:?}: {turned:?}");
            let cell = PeriodicBox::sheared(model.cell.edges(), model.flow.rate() * model.end()).unwrap();
            let error = deformation(&cell, &end);
            assert!(error < 1e-12, "{keys:?}: {error:e}");
        }
    }
}

/// A run that is resumed after any step has the bits of one that is not, for all integrators.
#[test]
fn a_resumed_run_has_the_same_bits() {
    for keys in INTEGRATORS {
        let model = model_of(FEW, &[keys, &["time.steps=4", "statistics={every=1}"]].concat());
        resumes_with_the_same_bits(&model, &format!("{keys:?}"));
    }
}

#[test]
#[ignore = "heavy"]
fn ranks_and_threads_agree() {
    for keys in INTEGRATORS {
        let model = model_of(FEW, &[keys, &["time.steps=3"]].concat());
        let alone = ranks_agree(&model, 1e-7, &format!("{keys:?}"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        assert_eq!(pool.install(|| run(&model, 1)), alone, "{keys:?}");
    }
}

/// A doublet of touching spheres in unbounded fluid.
const DOUBLET: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
particles.initial = "random"
hydrodynamics = { tolerance = 1e-3, lubrication = true }
time = { step = 0.1, steps = 0 }
[[bodies]]
shape = "doublet"
radius = 1.0
positions = [[0.0, 0.0, 0.0]]
orientation = "aligned"
orientation_axis = [1.0, 0.0, 0.0]
"#;

/// Sum of the velocities of the two spheres, and their angular velocity.
fn motion(keys: &[&str]) -> [Vector; 2] {
    let mut particles = run(&model_of(DOUBLET, keys), 1);
    let sum = particles.vectors(VELOCITY).iter().sum();
    [sum, particles.vectors(ANGULAR_VELOCITY)[0]]
}

/// Along and across its axis, a doublet settles by 1/0.64514 and 1/0.72466 as fast as its spheres would if each were
/// alone (Happel & Brenner 1965), and it rotates in a shear flow as a spheroid whose aspect ratio is 1.9816.
#[test]
fn a_doublet_moves_as_the_exact_one() {
    for (force, exact) in [("[1.0, 0.0, 0.0]", 0.64514), ("[0.0, 1.0, 0.0]", 0.72466)] {
        let [sum, _] = motion(&[&format!("bodies[0].force={force}")]);
        let resistance = 1.0 / (6.0 * PI * sum.length());
        assert!((resistance / exact - 1.0).abs() < 4e-3, "{force}: {resistance}, not {exact}");
    }
    for (axis, factor) in [("[1.0, 0.0, 0.0]", 1.0 - 0.59406), ("[0.0, 1.0, 0.0]", 1.0 + 0.59406)] {
        let [_, turning] = motion(&["flow={kind='shear',rate=1.0}", &format!("bodies[0].orientation_axis={axis}")]);
        assert!((turning.z + 0.5 * factor).abs() < 3e-3, "{axis}: {turning}, not {factor}");
    }
}

/// The stress of a body under a torque and its rotation in a strain are related by the reciprocal theorem,
/// `S : E = -T . Omega`, with the part of the forces that keep the body rigid; and those make the stress of a strain
/// along the axis larger.
#[test]
fn the_stress_of_a_body_is_reciprocal_to_its_rotation() {
    let stress_of = |keys: &[&str]| {
        let model = model_of(DOUBLET, &[&["box={edges=[10.0,10.0,10.0]}"], keys].concat());
        let suspension = Suspension::start(&model, &Comm::alone()).unwrap();
        let turning = suspension.particles().rows::<3>(ANGULAR_VELOCITY).unwrap()[0][2];
        let [stress] = &suspension.stress(1)[..] else { panic!("one species") };
        let volume = model.cell.volume();
        (stress.total().y_axis.x * volume, stress.of(ParticleStress::CONSTRAINT).y_axis.x * volume, turning)
    };
    let sheared = "flow={kind='shear',rate=1.0}";
    let (_, _, turning) = stress_of(&[sheared]);
    let (by_torque, constraint, _) = stress_of(&["bodies[0].torque=[0.0,0.0,7.0]"]);
    let expected = -7.0 * (turning + 0.5);
    assert!((by_torque / expected - 1.0).abs() < 0.01, "{by_torque}, not {expected}");
    assert!((constraint / expected).abs() > 0.1, "{constraint} of {expected}");
    let (along, constraint, _) = stress_of(&[sheared, "bodies[0].orientation_axis=[1.0,1.0,0.0]"]);
    assert!(constraint > 0.05 * along && along > 0.0, "{constraint} of {along}");
}

/// A Brownian doublet has the translational and rotational diffusivities of its mobility in the same box.
#[test]
fn a_doublet_diffuses_as_it_moves() {
    let periodic = ["box={edges=[8.0,8.0,8.0]}", "hydrodynamics={tolerance=1e-2,lubrication=true}"];
    let under = |load: &str| motion(&[&periodic[..], &[load]].concat());
    let pulled = ["[1.0,0.0,0.0]", "[0.0,1.0,0.0]"].map(|f| 0.5 * under(&format!("bodies[0].force={f}"))[0].length());
    let turned = ["[1.0,0.0,0.0]", "[0.0,1.0,0.0]"].map(|t| under(&format!("bodies[0].torque={t}"))[1].length());
    let keys = ["time={step=0.05,steps=800}", "fluid.thermal_energy=0.7", "seed=8"];
    let model = model_of(DOUBLET, &[&periodic[..], &keys].concat());
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let (mut before, mut sums) = (suspension.particles().clone(), [0.0; 2]);
    for _ in 0..model.steps {
        suspension.step_seen(false).unwrap();
        let now = suspension.particles().clone();
        let moved = |row: usize| model.cell.nearest_image(now.positions[row] - before.positions[row]);
        let rotation = (orientations(&now)[0] * orientations(&before)[0].inverse()).log();
        sums[0] += (0.5 * (moved(0) + moved(1))).length_squared();
        sums[1] += rotation.length_squared();
        before = now;
    }
    for (sum, [along, across]) in sums.into_iter().zip([pulled, turned]) {
        let (found, expected) = (sum / (2.0 * 0.7 * model.end()), along + 2.0 * across);
        let error = (2.0 / (3.0 * model.steps as f64)).sqrt();
        assert!((found / expected - 1.0).abs() < 3.5 * error + 0.02, "{found}, not {expected} +- {error}");
    }
}

/// Bodies are those of the scene: a state of another is refused, and so are places that a user sets.
#[test]
fn states_keep_their_bodies() {
    let model = model_of(FEW, &["time.steps=1"]);
    let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    let other = model_of(FEW, &["time.steps=1", "bodies[0].gap=0.1"]);
    let refused = Suspension::resume(&other, Some(run.state()), &Comm::alone()).err().expect("another shape");
    assert!(refused.to_string().contains("other bodies"), "{refused}");
    let (state, moved) = (run.state(), Rearrangement { positions: vec![(2, Vector::ONE)], ..Rearrangement::default() });
    assert!(run.rearranged(state, &moved).unwrap_err().to_string().contains("rigid bodies"));
}
