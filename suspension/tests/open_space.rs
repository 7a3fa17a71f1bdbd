//! Runs in unbounded fluid, with a box that follows the spheres.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Interrupt, Vector};
use lubrication::two_sphere::{Function, TwoSphere};
use simulation::Simulation;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};
use suspension::{Asked, Ranks, Suspension, SuspensionRun, VELOCITY, outline};

const PAIR: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 2.0
hydrodynamics = { lubrication = true, tolerance = 1e-4 }
particles = { initial = "cloud", radius = 5.0 }
time = { step = 0.5, steps = 12 }
[[species]]
radius = 1.0
count = 2
force = [3.0, -1.0, -20.0]
"#;

/// Two equal spheres that settle at an angle keep their separation: the velocity is that of the exact mobility, and
/// steps along a straight line have no error.
#[test]
fn a_pair_falls_as_the_exact_one() {
    let (force, axis) = (Vector::new(3.0, -1.0, -20.0), Vector::new(2.0, 1.0, 2.0) / 3.0);
    for (gap, far, allowed) in [(1e-3, 0.0, 1e-3), (0.1, -1e5, 1e-3), (1.0, 300.0, 1e-3), (5.0, 0.0, 3e-4)] {
        let exact = TwoSphere::with_ratio(1.0).unwrap().mobility(gap).unwrap();
        let together = |function| exact[function][0][0] + exact[function][0][1];
        let along = axis * axis.dot(force);
        let velocity = (along * together(Function::XA) + (force - along) * together(Function::YA)) / (12.0 * PI);
        let first = Vector::splat(far);
        let places = [first, first + axis * (2.0 + gap)].map(|x| x.to_array());
        let key = format!("particles={{initial=\"positions\", positions={places:?}}}");
        let found = ended(&model_of(PAIR, &[&key]), 1, |suspension| suspension.gathered(None).positions);
        for (found, start) in found.iter().zip(places) {
            let error = (*found - Vector::from_array(start)) / 6.0 - velocity;
            assert!(error.length() < allowed * velocity.length(), "gap {gap}: {error} of {velocity}");
        }
    }
}

const CLOUD: &str = r#"
seed = 1
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
particles = { initial = "cloud", radius = 30.0, minimum_gap = 0.1 }
time = { step = 0.1, steps = 0 }
[[species]]
radius = 1.0
count = 200
force = [0.0, 0.0, -18.84955592153876]
"#;

/// The mean velocity of a random cloud over that of a single sphere is `6 N a / 5 R + 1`. For 200 spheres in a ball of
/// 30 radii it scatters by 2%, and the minimum gap reduces it by some tenths of a per cent.
#[test]
fn a_cloud_falls_as_its_formula_says() {
    let formula = 6.0 * 200.0 / (5.0 * 30.0) + 1.0;
    let found = [1, 2, 3, 4].map(|seed| {
        ended(&model_of(CLOUD, &[&format!("seed={seed}")]), 1, |suspension| {
            let all = suspension.gathered(None);
            let centre = all.positions.iter().sum::<Vector>() / 200.0;
            assert!(all.positions.iter().all(|x| x.length() < 30.0) && centre.length() < 4.0, "{centre}");
            all.clone().vectors(VELOCITY).iter().map(|v| -v.z).sum::<f64>() / 200.0
        })
    });
    let mean = found.iter().sum::<f64>() / 4.0;
    assert!((mean / formula - 1.0).abs() < 0.025, "{found:?}, not {formula}");
}

/// A few spheres of two sizes that are separated by a shear flow, with repulsion and lubrication: the box grows
/// repeatedly.
const SHEARED: &str = r#"
seed = 2
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.5
flow = { kind = "shear", rate = 0.8 }
gravity.acceleration = [0.1, 0.0, -1.0]
repulsion = { strength = 20.0, range = 0.1 }
hydrodynamics = { lubrication = true, tolerance = 1e-3, iteration_tolerance = 1e-8 }
particles = { initial = "cloud", radius = 4.5 }
time = { step = 0.1, steps = 12 }
[[species]]
radius = 1.0
count = 9
density_difference = 1.0
[[species]]
radius = 1.5
count = 2
density_difference = 2.0
"#;

#[test]
#[ignore = "heavy"]
fn ranks_agree_in_open_fluid() {
    let model = model_of(SHEARED, &[]);
    let all = [1, 2, 3, 7].map(|ranks| {
        ended(&model, ranks, |suspension| {
            let edges = suspension.cell().edges();
            (suspension.gathered(None), edges, suspension.report().smallest_gap)
        })
    });
    let (alone, edges, gap) = &all[0];
    let first = ended(&model_of(SHEARED, &["time.steps=0"]), 1, |suspension| suspension.cell().edges());
    assert!(*edges != first, "the box has changed with the shear: {edges}");
    for (particles, own, own_gap) in &all {
        assert_eq!((own, particles.len()), (edges, 11));
        assert!(*gap > 0.0 && (own_gap - gap).abs() < 1e-6);
        let errors = alone.positions.iter().zip(&particles.positions).map(|(a, b)| (a - b).length());
        assert!(errors.fold(0.0, f64::max) < 1e-6);
    }
}

/// Resumed at any step, before or after a change of the box, a run continues bit for bit.
#[test]
fn a_run_in_open_fluid_resumes_bit_for_bit() {
    for key in ["time.order=4", "time.integrator=\"implicit\""] {
        let model = model_of(SHEARED, &[key]);
        let mut straight = Suspension::start(&model, &Comm::alone()).unwrap();
        let mut states = Vec::new();
        let mut edges = Vec::new();
        for _ in 0..8 {
            straight.step().unwrap();
            states.push(straight.state());
            edges.push(straight.cell().edges());
        }
        edges.dedup();
        assert!(edges.len() > 2, "{edges:?}");
        for state in [&states[1], &states[5]] {
            let mut resumed = Suspension::resume(&model, Some(state.clone()), &Comm::alone()).unwrap();
            assert_eq!(resumed.caution(), None);
            while resumed.clock().step() < 8 {
                resumed.step().unwrap();
            }
            assert_eq!(straight.gathered(None), resumed.gathered(None), "{key}");
        }
    }
}

/// A step that is interrupted at any check after the box has changed has no effect, and the state is consistent.
#[test]
fn an_interrupted_step_goes_back_to_the_box_before() {
    let model = model_of(SHEARED, &["time.step=0.8"]);
    for ranks in [1, 3] {
        Comm::threads(ranks, |comm| {
            let mut suspension = Suspension::start(&model, &comm).unwrap();
            let seen = |suspension: &mut Suspension| {
                (suspension.gathered(None), *suspension.cell(), suspension.plan(), suspension.report().smallest_gap)
            };
            let before = seen(&mut suspension);
            for most in [1, 2, 4, 7] {
                let looks = AtomicUsize::new(0);
                suspension.listen(Interrupt::when(move || looks.fetch_add(1, Ordering::Relaxed) >= most));
                suspension.step().unwrap_err();
                assert_eq!(seen(&mut suspension), before, "after {most} looks");
            }
            suspension.listen(Interrupt::NEVER);
            suspension.step().unwrap();
            assert_ne!(suspension.cell().edges(), before.1.edges());
        });
    }
}

/// An isolated sphere moves with a linear flow, at any position.
#[test]
fn a_sphere_alone_goes_with_the_flow() {
    let keys = [
        "flow={kind=\"shear\", rate=0.4}",
        "species=[{radius=1.0, count=1}]",
        "particles={initial=\"positions\", positions=[[3.0, 50.0, -7.0]]}",
    ];
    let (place, spin) = ended(&model_of(PAIR, &keys), 1, |suspension| {
        let mut all = suspension.gathered(None);
        (all.positions[0], all.vectors(suspension::ANGULAR_VELOCITY)[0])
    });
    // Tolerance of the flow over a radius.
    assert!((place - Vector::new(3.0 + 0.4 * 50.0 * 6.0, 50.0, -7.0)).length() < 1e-4 * 0.4 * 6.0, "{place}");
    assert!((spin - Vector::Z * -0.2).length() < 1e-4 * 0.2, "{spin}");
}

/// Above a wall a sphere may rise to any height: above the initial box it moves almost as in unbounded fluid.
#[test]
fn a_sphere_rises_out_of_the_box_above_a_wall() {
    let keys = [
        "box={edges=[30.0, 30.0, 6.0], boundaries=[\"periodic\", \"periodic\", \"wall\"]}",
        "species=[{radius=1.0, count=1, force=[0.0, 0.0, 37.69911184307752]}]",
        "particles={initial=\"positions\", positions=[[3.0, 5.0, 4.5]]}",
    ];
    let (place, edges) = ended(&model_of(PAIR, &keys), 1, |suspension| {
        (suspension.gathered(None).positions[0], suspension.cell().edges())
    });
    assert!(place.z > 7.5 && place.z < 10.5 && edges.z > place.z, "{place} {edges}");
}

/// A layer in fluid that is open on both sides settles along its normal, and the box follows.
#[test]
fn a_layer_falls_in_open_fluid() {
    let keys = [
        "box={edges=[12.0, 12.0, 5.0], boundaries=[\"periodic\", \"periodic\", \"open\"]}",
        "species=[{radius=1.0, count=4, force=[0.0, 0.0, -20.0]}]",
        "particles={initial=\"random\", minimum_gap=0.2}",
    ];
    let all = [1, 3].map(|ranks| {
        ended(&model_of(PAIR, &keys), ranks, |suspension| {
            let (all, cell) = (suspension.gathered(None), *suspension.cell());
            (all.positions.iter().sum::<Vector>() / 4.0, cell.origin())
        })
    });
    let (centre, origin) = all[0];
    assert!(centre.z < -1.0 && origin.z < centre.z, "{centre} {origin}");
    assert!((all[1].0 - centre).length() < 1e-6);
}

/// Frames, gathered or of one rank, record the periodic axes of the box.
#[test]
fn frames_know_along_which_axes_a_box_repeats() {
    let layer = "box={edges=[12.0, 12.0, 8.0], boundaries=[\"periodic\", \"periodic\", \"open\"]}";
    let slit = "box={edges=[12.0, 12.0, 8.0], boundaries=[\"periodic\", \"periodic\", \"walls\"]}";
    let random = "particles={initial=\"random\"}";
    let still = "species=[{radius=1.0, count=2}]";
    let all = [
        (vec![layer, random, still], [true, true, false]),
        (vec![slit, random, still], [true, true, false]),
        (vec![], [false; 3]),
    ];
    for (keys, periodic) in &all {
        let observed = SuspensionRun::start(&model_of(PAIR, keys), None, &Comm::alone()).unwrap();
        assert_eq!((observed.frame().periodic, observed.frame_share().periodic), (*periodic, *periodic));
    }
}

/// Rows of the time series have the cloud's position and size; `check` reports the cost of unbounded fluid and walls,
/// and nothing like that for a periodic box.
#[test]
fn what_is_told_of_clouds_and_of_boundaries() {
    let model = model_of(SHEARED, &["time.steps=0"]);
    let mut observed = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    let (quantities, row) = (observed.quantities(), observed.observe());
    assert_eq!(quantities.len(), row.len());
    assert!(quantities.iter().zip(&row).all(|(quantity, values)| quantity.columns().len() == values.len()));
    let place = quantities.iter().position(|quantity| quantity.name == "cloud").unwrap();
    assert_eq!(quantities[place].columns()[3], "cloud_radius[1]");
    assert!(row[place][3] > 2.0 && row[place][3] < 6.0, "{:?}", row[place]);
    assert!(!quantities.iter().any(|quantity| quantity.name.contains("stress")));
    let told = |keys: &[&str]| {
        let ranks = Ranks { count: 2, threads: 1 };
        let model = model_of(CLOUD, keys);
        outline(&model, None, Asked { ranks, on_a_machine: 2, are_present: false }, &Comm::alone())
            .unwrap()
            .text()
            .to_owned()
    };
    let edges = "box.edges=[40.0, 40.0, 40.0]";
    let walls = ["box.boundaries=[\"periodic\", \"periodic\", \"walls\"]", edges, "particles={initial=\"random\"}"];
    let periodic = ["box.boundaries=[\"periodic\", \"periodic\", \"periodic\"]", edges, walls[2]];
    let (open, walls, periodic) = (told(&[]), told(&walls), told(&periodic));
    assert!(open.contains("the box follows the spheres") && open.contains("200, 0.7407% by volume"), "{open}");
    assert!(walls.contains("walls      ") && walls.contains("that lie in layers on one"), "{walls}");
    assert!(!periodic.contains("periodic box"), "{periodic}");
}
