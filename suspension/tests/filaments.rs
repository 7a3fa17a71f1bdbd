//! Bonds that resist bending and twisting, and filaments.

use crate::support::ended::{ended, ranks_agree};
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, Vector};
use suspension::{Model, Suspension};

/// A bent and twisted chain across the faces of a sheared box, with branches, some of them freely jointed.
const CHAIN: &str = r#"
seed = 5
box.edges = [9.0, 8.0, 8.5]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 1.0 }
hydrodynamics = { lubrication = true, tolerance = 1e-6 }
time = { step = 0.02, steps = 40, integrator = "implicit", tolerance = 0.9, gap_fraction = 0.9 }
[particles]
initial = "positions"
positions = [[1.0, 7.0, 1.0], [2.0, 1.1, 1.5], [2.5, 3.2, 2.4], [6.0, 4.0, 6.0], [4.2, 4.4, 1.6]]
[[species]]
name = "one"
radius = 1.0
count = 3
orientation = "random"
[[species]]
name = "other"
radius = 0.8
count = 2
orientation = "random"
[[bonds]]
pairs = [[1, 0], [1, 2]]
stiffness = 60.0
bending_stiffness = 90.0
twisting_stiffness = 40.0
rest_shape = "straight"
[[bonds]]
pairs = [[2, 4]]
stiffness = 30.0
bending_stiffness = 50.0
[[traps]]
particles = [0, 3]
stiffness = 30.0
"#;

/// Five spheres in a row, pulled sideways at the middle and at both ends.
const LOADED: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 1.0
hydrodynamics.tolerance = 1e-4
time = { step = 4.0, steps = 30, integrator = "implicit", tolerance = 0.5 }
[particles]
initial = "positions"
positions = [[-4.4, 0.0, 0.0], [4.4, 0.0, 0.0], [0.0, 0.0, 0.0], [-2.2, 0.0, 0.0], [2.2, 0.0, 0.0]]
[[species]]
name = "ends"
radius = 1.0
count = 2
force = [0.0, -0.04, -0.03]
orientation = "random"
[[species]]
name = "middle"
radius = 1.0
count = 1
force = [0.0, 0.08, 0.06]
orientation = "random"
[[species]]
name = "others"
radius = 1.0
count = 2
orientation = "random"
[[bonds]]
pairs = [[0, 3], [3, 2], [2, 4], [4, 1]]
stiffness = 1e3
bending_stiffness = 100.0
rest_shape = "straight"
"#;

/// Filaments at random beside free spheres.
const FILAMENTS: &str = r#"
seed = 3
box.edges = [16.0, 15.0, 14.0]
fluid.viscosity = 1.0
hydrodynamics.tolerance = 1e-3
time = { step = 0.1, steps = 3, integrator = "implicit" }
particles = { initial = "random", minimum_gap = 0.05 }
[[species]]
radius = 1.0
count = 6
[[filaments]]
name = "threads"
spheres = 4
radius = 0.7
gap = 0.1
count = 7
stiffness = 100.0
bending_stiffness = 30.0
twisting_stiffness = 20.0
"#;

/// A stiff filament in shear, with steps of the loosest tolerance.
const STIFF: &str = r#"
seed = 1
box.edges = [20.0, 20.0, 20.0]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 1.0 }
hydrodynamics = { tolerance = 1e-2, lubrication = false }
time = { step = 2.0, steps = 10, integrator = "implicit", tolerance = 0.9 }
[[filaments]]
spheres = 6
radius = 1.0
gap = 0.2
count = 1
stiffness = 1e5
bending_stiffness = 5e4
"#;

/// Unwrapped positions of all particles, on the first rank.
fn unwrapped(suspension: &Suspension) -> Vec<Vector> {
    let (all, cell) = (suspension.gathered(Some(&[])), suspension.cell());
    all.positions.iter().zip(&all.steps).map(|(&place, &steps)| place + cell.lattice(steps)).collect()
}

fn places(model: &Model) -> Vec<Vector> {
    ended(model, 1, |suspension| unwrapped(suspension))
}

fn farthest(some: &[Vector], others: &[Vector]) -> f64 {
    some.iter().zip(others).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max)
}

/// The midpoint of a beam of length `L` under a force `P` there is `P L^3 / 48 EI` from the line of its ends. Beam
/// elements give it exactly, up to terms of the square of the slope, 1e-5 here.
#[test]
fn a_loaded_chain_bends_as_a_beam() {
    let model = model_of(LOADED, &[]);
    let (found, totals) = ended(&model, 1, |suspension| (unwrapped(suspension), suspension.bond_totals().unwrap()));
    let moved = found[2] - (found[0] + found[1]) / 2.0;
    let exact = 0.1 * 8.8_f64.powi(3) / 4800.0;
    assert!((moved - Vector::new(0.0, 0.8, 0.6) * exact).length() < 1e-3 * exact, "{moved}, not {exact}");
    // The work of a load that grows from zero.
    assert!((totals.bending / (0.05 * exact) - 1.0).abs() < 2e-3, "{totals:?}");
    assert!(totals.twisting < 1e-9 && totals.broken.abs() < 1e-12, "{totals:?}");
}

/// In a sheared box the implicit method converges to the result of short explicit steps, with an error of order 2.
#[test]
fn implicit_and_explicit_steps_go_the_same_way() {
    let exact = places(&model_of(CHAIN, &["time={step=0.0025,steps=320}"]));
    let error = |steps: u32| {
        let keys = [format!("time.step={}", 0.8 / f64::from(steps)), format!("time.steps={steps}")];
        farthest(&places(&model_of(CHAIN, &keys.each_ref().map(String::as_str))), &exact)
    };
    let errors = [40, 80, 160].map(error);
    let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.25), "{errors:?} {orders:?}");
}

/// A chain that is free in fluid at rest relaxes: its energy falls in each step, even of long ones, up to the errors of
/// steps, and straight chains end without bending. One whose rest shape is that of the start does not move at all.
#[test]
fn a_bent_chain_relaxes_to_its_shape_at_rest() {
    let bent = "particles.positions=[[-3.9,0.0,0.0],[3.95,1.1,0.0],[0.0,0.0,0.0],[-1.95,1.0,0.0],[1.95,0.9,0.4]]";
    let unloaded = LOADED.replace("force = ", "# force = ");
    let mut relaxing = Suspension::start(&model_of(&unloaded, &[bent]), &Comm::alone()).unwrap();
    let energy = |suspension: &Suspension| {
        let totals = suspension.bond_totals().unwrap();
        totals.stretching + totals.bending + totals.twisting
    };
    let mut energies = vec![energy(&relaxing)];
    for _ in 0..30 {
        relaxing.step().unwrap();
        energies.push(energy(&relaxing));
    }
    assert!(energies[0] > 10.0 && energies.windows(2).all(|two| two[1] < two[0] + 1e-6 * energies[0]), "{energies:?}");
    assert!(energies[30] < 1e-6 * energies[0], "{energies:?}");
    let curved = model_of(&unloaded, &[bent, "bonds[0].rest_shape=\"start\"", "time.steps=2"]);
    let mut resting = Suspension::start(&curved, &Comm::alone()).unwrap();
    let start = unwrapped(&resting);
    resting.step().unwrap();
    assert!(farthest(&start, &unwrapped(&resting)) < 1e-12 && energy(&resting) < 1e-20);
}

#[test]
fn ranks_agree_and_runs_resume() {
    // Solves to the tolerance, with sums in another order.
    ranks_agree(&model_of(CHAIN, &["hydrodynamics.tolerance=1e-7", "time.steps=10"]), 1e-6, "chain");
    let adaptive = r#"time={step=0.02,steps=4,integrator="adaptive",tolerance=0.9,gap_fraction=0.9}"#;
    for keys in [vec!["time.steps=4"], vec![adaptive]] {
        resumes_with_the_same_bits(&model_of(CHAIN, &keys), "chain");
    }
    let brownian = r#"time={step=0.002,steps=3,integrator="brownian"}"#;
    let thermal = model_of(CHAIN, &["fluid.thermal_energy=1.0", brownian, "hydrodynamics.tolerance=1e-3"]);
    resumes_with_the_same_bits(&thermal, "Brownian chain");
}

/// Chains without a direction at one of their spheres, and spheres without orientations, are refused at the start.
#[test]
fn what_has_no_shape_at_rest_is_refused() {
    let said = |keys: &[&str], scene: &str| match Suspension::start(&model_of(scene, keys), &Comm::alone()) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    };
    let branched = said(&["bonds[0].pairs=[[0,3],[3,2],[2,4],[2,1]]"], LOADED);
    assert!(branched.contains("sphere 2 has 3 such bonds"), "{branched}");
    let folded = said(&["bonds[0].pairs=[[0,3],[0,2],[2,4],[4,1]]"], LOADED);
    assert!(folded.contains("the chain is folded at sphere 0"), "{folded}");
}

/// A bond that breaks loses its moments with its tension.
#[test]
fn broken_bonds_bend_no_more() {
    let model = model_of(CHAIN, &["bonds[0].breaking_force=1e-3", "bonds[1].breaking_force=1e-3", "time.steps=20"]);
    let totals = ended(&model, 1, |suspension| suspension.bond_totals().unwrap());
    assert!((totals.broken - 3.0).abs() < 1e-12 && totals.bending + totals.twisting == 0.0, "{totals:?}");
}

/// The same chain in micrometres, in a fluid of another viscosity at another shear rate.
#[test]
fn units_do_not_matter() {
    let here = places(&model_of(CHAIN, &[]));
    let (length, viscosity, rate) = (1e-6, 8.5e-4, 13.0);
    let list = |numbers: &[f64]| format!("{:?}", numbers.iter().map(|x| x * length).collect::<Vec<_>>());
    let rows = [[1.0, 7.0, 1.0], [2.0, 1.1, 1.5], [2.5, 3.2, 2.4], [6.0, 4.0, 6.0], [4.2, 4.4, 1.6]];
    let rows: Vec<String> = rows.iter().map(|row| list(row)).collect();
    let spring = viscosity * length * rate;
    let beam = spring * length * length * length;
    let keys = [
        format!("box.edges={}", list(&[9.0, 8.0, 8.5])),
        format!("fluid.viscosity={viscosity}"),
        format!("flow.rate={rate}"),
        format!("time.step={}", 0.02 / rate),
        format!("particles.positions=[{}]", rows.join(",")),
        format!("species[0].radius={length}"),
        format!("species[1].radius={}", 0.8 * length),
        format!("bonds[0].stiffness={}", 60.0 * spring),
        format!("bonds[0].bending_stiffness={}", 90.0 * beam),
        format!("bonds[0].twisting_stiffness={}", 40.0 * beam),
        format!("bonds[1].stiffness={}", 30.0 * spring),
        format!("bonds[1].bending_stiffness={}", 50.0 * beam),
        format!("traps[0].stiffness={}", 30.0 * spring),
    ];
    let there = places(&model_of(CHAIN, &keys.each_ref().map(String::as_str)));
    let there: Vec<Vector> = there.iter().map(|&place| place / length).collect();
    // The tolerances of the solves, and of steps that depend on them.
    assert!(farthest(&here, &there) < 1e-6, "{}", farthest(&here, &there));
}

/// A stiff filament that tumbles in a shear flow keeps the lengths of its bonds with the loosest tolerance and long
/// steps: without errors of their own, bonds were predicted so long that nothing held them.
#[test]
fn loose_tolerances_do_not_tear_bonds() {
    let mut suspension = Suspension::start(&model_of(STIFF, &[]), &Comm::alone()).unwrap();
    for step in 0..10 {
        suspension.step().unwrap();
        // The energy of one bond that is longer by a hundredth.
        let stretching = suspension.bond_totals().unwrap().stretching;
        assert!(stretching < 0.5 * 1e5 * 0.022_f64.powi(2), "{stretching} after step {step}");
    }
}

/// Filaments start as straight rods without load, with the axes of their spheres along them, and do not overlap.
#[test]
fn filaments_start_as_straight_rods() {
    let model = model_of(FILAMENTS, &[]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let totals = suspension.bond_totals().unwrap();
    assert!(totals.bending + totals.twisting + totals.stretching < 1e-20, "{totals:?}");
    let (all, cell) = (suspension.gathered(None), *suspension.cell());
    assert_eq!(all.len(), 34);
    let along = |i: usize, j: usize| cell.nearest_image(all.positions[j] - all.positions[i]);
    for filament in 0..7 {
        let bonds = [0, 1, 2].map(|k| along(6 + 4 * filament + k, 7 + 4 * filament + k));
        assert!(bonds.iter().all(|bond| (bond.length() - 1.5).abs() < 1e-12 && (*bond - bonds[0]).length() < 1e-12));
    }
    for i in 0..34 {
        for j in 0..i {
            assert!(along(i, j).length() > all.radii[i] + all.radii[j] + 0.049, "{i} {j}");
        }
    }
    suspension.step().unwrap();
    ranks_agree(&model, 1e-6, "filaments");
}
