//! Runs with bonds and traps.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Comm, Particles, Vector};
use suspension::{BondTotals, Model, Suspension};

/// A sphere in a trap, initially displaced from the centre.
const TRAPPED: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
hydrodynamics.tolerance = 1e-6
particles = { initial = "positions", positions = [[6.0, 6.0, 0.1]] }
time = { step = 0.05, steps = 40, integrator = "implicit", tolerance = 0.9 }
[[species]]
radius = 1.0
count = 1
[[traps]]
centre = [6.5, 6.0, 11.9]
stiffness = 20.0
"#;

/// A chain across the faces of a sheared box, with one end trapped.
const CHAIN: &str = r#"
box.edges = [9.0, 8.0, 8.5]
fluid.viscosity = 1.0
flow = { kind = "shear", rate = 1.0 }
hydrodynamics = { lubrication = true, tolerance = 1e-6 }
time = { step = 0.02, steps = 40, integrator = "implicit", tolerance = 0.9, gap_fraction = 0.9 }
[particles]
initial = "positions"
positions = [[1.0, 7.0, 1.0], [2.0, 1.1, 1.5], [2.5, 3.2, 2.4], [6.0, 4.0, 6.0]]
[[species]]
name = "one"
radius = 1.0
count = 3
[[species]]
name = "other"
radius = 0.8
count = 1
[[bonds]]
pairs = [[1, 0], [1, 2]]
stiffness = 60.0
[[traps]]
particles = [0, 3]
stiffness = 30.0
"#;

fn places(model: &Model, ranks: usize) -> Vec<Vector> {
    ended(model, ranks, |suspension| unwrapped(suspension))
}

/// Unwrapped positions of all particles, on the first rank.
fn unwrapped(suspension: &Suspension) -> Vec<Vector> {
    let (all, cell) = (suspension.gathered(Some(&[])), suspension.cell());
    all.positions.iter().zip(&all.steps).map(|(&place, &steps)| place + cell.lattice(steps)).collect()
}

fn farthest(some: &[Vector], others: &[Vector]) -> f64 {
    some.iter().zip(others).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max)
}

/// The mobility of an isolated sphere does not depend on its position, so it approaches the nearest image of its trap's
/// centre exponentially; the implicit method has an error of order 2.
#[test]
fn a_trapped_sphere_nears_its_centre_exponentially() {
    let pushed = model_of(
        &TRAPPED.replace("[[traps]]\ncentre = [6.5, 6.0, 11.9]\nstiffness = 20.0", "force = [1.0, 0.0, 0.0]"),
        &[],
    );
    let mobility = Suspension::start(&pushed, &Comm::alone()).unwrap().velocities_in_flow()[0].x;
    let exact = Vector::new(-0.5, 0.0, 0.2) * (-20.0 * mobility * 2.0_f64).exp();
    let error = |keys: &[&str]| {
        let away = places(&model_of(TRAPPED, keys), 1)[0] - Vector::new(6.5, 6.0, -0.1);
        (away - exact).length() / exact.length()
    };
    // Tolerance of the mobility, over two relaxation times of the trap.
    assert!(error(&["time={step=0.05,steps=40}"]) < 1e-5);
    let errors = [40, 80, 160]
        .map(|steps| error(&[&format!("time.step={}", 2.0 / f64::from(steps)), &format!("time.steps={steps}")]));
    let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.3), "{errors:?} {orders:?}");
}

/// However stiff it is, a trap holds a sphere where it balances an external force, and no step overshoots.
#[test]
fn a_stiff_trap_holds_a_sphere_against_a_force() {
    let pulled = TRAPPED.replace("count = 1", "count = 1\nforce = [0.0, 3.0, 0.0]");
    let keys = ["traps[0].stiffness=1e5", "time.steps=4", "time.gap_fraction=0.9"];
    let away = |suspension: &Suspension| unwrapped(suspension)[0] - Vector::new(6.5, 6.0, -0.1);
    let mut suspension = Suspension::start(&model_of(&pulled, &keys), &Comm::alone()).unwrap();
    let start = away(&suspension).length();
    assert!((suspension.trap_energy().unwrap() / (0.5e5 * start * start) - 1.0).abs() < 1e-12);
    for _ in 0..4 {
        suspension.step().unwrap();
        assert!(away(&suspension).length() < 1e-3 * start, "{}", away(&suspension));
    }
    assert!((away(&suspension) - Vector::Y * 3e-5).length() < 1e-9, "{}", away(&suspension));
}

/// Two spheres pulled apart come to rest where the bond balances the forces, with any method and other interactions.
/// The stress of bonds is the tension times the distance over the volume.
#[test]
fn a_pulled_pair_rests_on_its_bond() {
    let scene = TRAPPED.replace("[[6.0, 6.0, 0.1]]", "[[11.5, 6.0, 0.1], [1.7, 6.0, 0.1]]").replace(
        "count = 1",
        "name = \"a\"\ncount = 1\nforce = [-3.0, 0.0, 0.0]\n[[species]]\nname = \"b\"\nradius = 1.0\ncount = 1\nforce \
         = [3.0, 0.0, 0.0]",
    );
    let scene =
        scene.split("[[traps]]").next().unwrap().to_owned() + "[[bonds]]\npairs = [[0, 1]]\nstiffness = 200.0\n";
    let lubricated = "hydrodynamics.lubrication=true";
    for (keys, rest) in [
        (vec!["time={step=0.02,steps=200}"], 2.2),
        (vec![], 2.2),
        (vec![lubricated, "bonds[0].length=2.3"], 2.3),
        (vec![lubricated, "bonds[0].stiffness=2e6", "contacts={friction=0.5,stiffness=1e4}"], 2.2),
        (vec!["hydrodynamics.multipoles=\"monopole\""], 2.2),
    ] {
        let model = model_of(&scene, &keys);
        let found = ended(&model, 1, |suspension| {
            let places = unwrapped(suspension);
            (
                places[1] - places[0],
                suspension.bond_totals().unwrap(),
                suspension.stress(2),
                suspension.contact_forces(),
            )
        });
        let (apart, BondTotals { stretching: energy, broken, .. }, stress, forces) = found;
        let stiffness = model.bonds[0].stiffness;
        let pull = stiffness * (apart.x + 12.0 - rest);
        assert!((pull - 3.0).abs() < 1e-3 && broken == 0.0, "{keys:?}: pulls with {pull}");
        assert!((energy - 0.5 * pull * pull / stiffness).abs() < 1e-9 * energy.max(1.0), "{keys:?}: {energy}");
        let xx: f64 = stress.iter().map(|s| s.of("bond").x_axis.x).sum();
        // The tension has the round-off of the distance times the stiffness.
        let round_off = 1e-9 + 2e-14 * stiffness;
        assert!((xx * 1728.0 - pull * (apart.x + 12.0)).abs() < round_off, "{keys:?}: {xx}");
        let force = forces.unwrap().list[0];
        assert!((force.normal + pull).abs() < round_off && force.ids == [0, 1], "{force:?}");
    }
}

/// In a sheared or oscillating box, across its faces: the implicit method converges to the result of short explicit
/// steps, with an error of order 2.
#[test]
#[ignore = "heavy"]
fn implicit_and_explicit_steps_go_the_same_way() {
    for flow in [r#"flow={kind="shear",rate=1.0}"#, r#"flow={kind="shear",oscillation={amplitude=0.4,frequency=4.0}}"#]
    {
        let exact = places(&model_of(CHAIN, &[flow, "time={step=0.005,steps=160}"]), 1);
        let error = |steps: u32| {
            let keys =
                [flow.to_owned(), format!("time.step={}", 0.8 / f64::from(steps)), format!("time.steps={steps}")];
            farthest(&places(&model_of(CHAIN, &keys.each_ref().map(String::as_str)), 1), &exact)
        };
        let errors = [40, 80, 160].map(error);
        let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "{flow}: {errors:?} {orders:?}");
    }
}

fn run(model: &Model, ranks: usize) -> Particles {
    ended(model, ranks, |suspension| suspension.gathered(None))
}

#[test]
fn ranks_agree() {
    let model = model_of(CHAIN, &["hydrodynamics.tolerance=1e-7", "time.steps=10"]);
    let alone = run(&model, 1);
    for ranks in [2, 3, 7] {
        let error = farthest(&alone.positions, &run(&model, ranks).positions);
        // Solves to the tolerance, with sums in another order.
        assert!(error < 1e-6, "{ranks} ranks: {error}");
    }
}

/// Spheres are pulled apart until their bond breaks; then nothing holds them.
#[test]
#[ignore = "heavy"]
fn bonds_break_once_and_for_all() {
    let model = model_of(CHAIN, &["bonds[0].breaking_force=2.0", "time.steps=60"]);
    let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
    let mut broken = vec![0.0];
    for step in 0..model.steps {
        let mut resumed = Suspension::resume(&model, Some(whole.state()), &Comm::alone()).unwrap();
        whole.step().unwrap();
        resumed.step().unwrap();
        assert_eq!(whole.gathered(None), resumed.gathered(None), "after step {step}");
        broken.push(whole.bond_totals().unwrap().broken);
    }
    assert!(broken.is_sorted() && broken[60] >= 1.0, "{broken:?}");
    let whole_bonds = whole.contact_forces().unwrap().list;
    assert!((whole_bonds.len() as f64 + broken[60] - 2.0).abs() < 1e-12, "{whole_bonds:?}");
    assert!(whole_bonds.iter().all(|bond| bond.normal > -2.0));
    for ranks in [2, 7] {
        let others = ended(&model, ranks, |suspension| suspension.bond_totals().unwrap().broken);
        assert!((others - broken[60]).abs() < 1e-12, "{ranks} ranks: {others}");
    }
}

/// A given stress includes that of bonds.
#[test]
fn a_given_stress_has_that_of_bonds() {
    let scene = CHAIN.split("[[traps]]").next().unwrap();
    let flow = r#"flow={kind="shear",control="stress",stress=3.0}"#;
    let model = model_of(scene, &[flow, "time.step=0.005", "time.steps=10", "bonds[0].length=2.0"]);
    let (stress, rate) = ended(&model, 1, |suspension| {
        let all = suspension
            .stress(2)
            .iter()
            .fold([0.0; 2], |[sum, bonds], s| [sum + s.total().y_axis.x, bonds + s.of("bond").y_axis.x]);
        (all, suspension.shear()[0])
    });
    // Tolerance: change of the stress of bonds in the last correction of a step.
    assert!(stress[1].abs() > 0.02 && ((rate + stress[0]) / 3.0 - 1.0).abs() < 3e-3, "{stress:?} {rate}");
}

/// A chain with a trapped end in planar extension, beyond the strain at which the box repeats, after a restart and on
/// several ranks.
#[test]
fn bonds_and_traps_hold_in_extension() {
    let flow = r#"flow={kind="planar-extension",rate=1.0}"#;
    let positions = "particles.positions=[[1.0,-1.0,1.0],[2.0,0.9,1.5],[2.5,3.0,2.4],[6.0,4.0,6.0]]";
    let model =
        model_of(CHAIN, &[flow, positions, "box.edges=[9.0,9.0,8.5]", "traps[0].stiffness=300.0", "time.steps=32"]);
    let mut whole = Suspension::start(&model, &Comm::alone()).unwrap();
    for step in 0..model.steps {
        let state = (step % 8 == 0 || (22..27).contains(&step)).then(|| whole.state());
        whole.step().unwrap();
        let Some(state) = state else { continue };
        let mut resumed = Suspension::resume(&model, Some(state), &Comm::alone()).unwrap();
        resumed.step().unwrap();
        assert_eq!(whole.gathered(None), resumed.gathered(None), "after step {step}");
    }
    let found = unwrapped(&whole);
    // The box repeats after a strain of 0.481; a trap of stiffness 300 yields to a drag of about 100 by a third.
    let yielded = (found[3] - Vector::new(6.0, 4.0, 6.0)).length();
    assert!(whole.shear()[1] > 0.6 && (0.1..1.0).contains(&yielded), "{yielded}");
    let stretched =
        [(1, 0, 4.86_f64), (1, 2, 5.47)].map(|(i, j, square)| (found[i] - found[j]).length() - square.sqrt());
    let expected = 30.0 * stretched.iter().map(|by| by * by).sum::<f64>();
    let energy = whole.bond_totals().unwrap().stretching;
    assert!(energy > 1.0 && (energy - expected).abs() < 1e-9, "{energy}, not {expected}");
    let error = farthest(&found, &places(&model, 3));
    assert!(error < 1e-5, "{error}");
}

/// The same chain in micrometres, in a fluid of another viscosity at another shear rate.
#[test]
fn units_do_not_matter() {
    let (length, viscosity, rate) = (1e-6, 8.5e-4, 13.0);
    let force = viscosity * rate * length;
    let micro = |list: &[[f64; 3]]| list.iter().map(|place| place.map(|x| x * length)).collect::<Vec<_>>();
    let start = [[1.0, 7.0, 1.0], [2.0, 1.1, 1.5], [2.5, 3.2, 2.4], [6.0, 4.0, 6.0]];
    let keys = [
        format!("box.edges={:?}", [9.0, 8.0, 8.5].map(|edge| edge * length)),
        format!("fluid.viscosity={viscosity:e}"),
        format!("flow.rate={rate:e}"),
        format!("time.step={:e}", 0.02 / rate),
        format!("particles.positions={:?}", micro(&start)),
        format!("species[0].radius={length:e}"),
        format!("species[1].radius={:e}", 0.8 * length),
        format!("bonds[0].stiffness={:e}", 60.0 * force),
        format!("traps[0].stiffness={:e}", 30.0 * force),
        "time.steps=10".to_owned(),
    ];
    let ones = run(&model_of(CHAIN, &["time.steps=10"]), 1).positions;
    let others = run(&model_of(CHAIN, &keys.each_ref().map(String::as_str)), 1).positions;
    let others: Vec<Vector> = others.iter().map(|&place| place / length).collect();
    assert!(farthest(&ones, &others) < 1e-7, "{}", farthest(&ones, &others));
}

/// The variance of trapped Brownian spheres is `kT / k` along each axis, whatever the hydrodynamic interactions. With
/// the midpoint scheme it is smaller by half of the step times the stiffness times the mean mobility, which is constant
/// since the traps are narrow.
#[test]
fn heat_spreads_what_is_trapped_by_its_energy() {
    let positions: Vec<[f64; 3]> =
        (0..8).map(|k| [k & 1, (k >> 1) & 1, k >> 2].map(|bit| 1.0 + 2.5 * f64::from(bit))).collect();
    let scene = format!(
        r#"
box.edges = [5.0, 5.0, 5.0]
fluid = {{ viscosity = 1.0, thermal_energy = 0.01 }}
hydrodynamics = {{ multipoles = "monopole", tolerance = 1e-2 }}
particles = {{ initial = "positions", positions = {positions:?} }}
time = {{ step = 0.04, steps = 4000 }}
species = [{{ radius = 1.0, count = 8 }}]
traps = [{{ stiffness = 250.0 }}]
"#
    );
    let model = model_of(&scene, &[]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let mut energy = 0.0;
    for step in 0..model.steps {
        suspension.step().unwrap();
        energy += if step < 100 { 0.0 } else { suspension.trap_energy().unwrap() };
    }
    let found = energy / (model.steps - 100) as f64 / (0.5 * 0.01 * 24.0);
    // The mean mobility of spheres with forces alone on a simple cubic lattice is that of a single sphere in the box of
    // 5 radii: 0.4645 / (6 pi).
    let half = 0.5 * 0.04 * 250.0 * 0.4645 / (6.0 * std::f64::consts::PI);
    let expected = 1.0 - half;
    assert!((found - expected).abs() < 0.02, "{found} is not {expected}");
}

/// Errors that depend on positions are found at the start, and a run ends when a bond gets too long.
#[test]
fn bonds_across_half_of_the_box_are_refused() {
    let refused = |keys: &[&str]| {
        let started = Suspension::start(&model_of(CHAIN, keys), &Comm::alone());
        started.err().map_or_else(String::new, |error| error.to_string())
    };
    let said = refused(&["bonds[0].pairs=[[0,1],[2,3]]"]);
    assert!(said.contains("bonds[0].pairs[1] bonds spheres 2 and 3, which are 5.084 apart at the start"), "{said}");
    assert_eq!(refused(&[]), "");
    let said = refused(&["particles={initial=\"file\",path=\"places.csv\"}", "species[0].count=3"]);
    assert!(!said.is_empty(), "no places were brought");
    let model = model_of(CHAIN, &["bonds[0].stiffness=1e-3", "flow.rate=8.0", "time.steps=100"]);
    let mut suspension = Suspension::start(&model, &Comm::alone()).unwrap();
    let error = (0..100).find_map(|_| suspension.step().err()).expect("a bond gets too long").to_string();
    assert!(
        error.contains("the bond of spheres") && error.contains("shorter than half of the box's shortest edge, 4"),
        "{error}"
    );
}

/// Traps of all spheres, of a species, or of listed spheres with individual centres.
#[test]
fn traps_hold_those_that_they_name() {
    let energy = |traps: &str| {
        let scene = format!("{}{traps}", CHAIN.split("[[bonds]]").next().unwrap());
        Suspension::start(&model_of(&scene, &[]), &Comm::alone()).unwrap().trap_energy()
    };
    // Squared displacements from (0, 7, 1) in a box with edges of 9, 8 and 8.5.
    let ways = [1.0, 4.0 + 2.1 * 2.1 + 0.25, 2.5 * 2.5 + 3.8 * 3.8 + 1.4 * 1.4, 9.0 + 9.0 + 3.5 * 3.5];
    let close = |found: Option<f64>, squares: f64| assert!((found.unwrap() - 2.0 * squares).abs() < 1e-12, "{found:?}");
    let centre = "stiffness = 4.0\ncentre = [0.0, 7.0, 1.0]\n";
    close(energy(&format!("[[traps]]\n{centre}")), ways.iter().sum());
    close(energy(&format!("[[traps]]\nspecies = \"other\"\n{centre}")), ways[3]);
    close(energy(&format!("[[traps]]\nparticles = [2, 0]\n{centre}")), ways[0] + ways[2]);
    let centres = "[[traps]]\nparticles = [2, 0]\nstiffness = 4.0\ncentres = [[2.5, 3.2, 2.0], [1.0, 7.5, 1.0]]\n";
    close(energy(centres), 0.16 + 0.25);
    close(energy("[[traps]]\nstiffness = 4.0\n"), 0.0);
    assert_eq!(energy(""), None);
}
