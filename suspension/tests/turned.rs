//! Runs with walls across x or y equal rotated runs with walls across z, in all results.

use crate::support::model_of;
use domain::{AxisRotation, Comm, Tensor, Traceless, Vector};
use simulation::{AppliedLoads, Frame, Simulation, UserLoads};
use std::collections::HashMap;
use suspension::{ANGULAR_VELOCITY, Model, STRESSLET, SuspensionRun, VELOCITY};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Edges of the box if walls are across z.
const EDGES: [f64; 3] = [9.0, 8.0, 10.0];

/// Scene with a boundary along its special axis and further features; `axis` is the special axis, and vectors and
/// positions are given as if it were z.
fn scene(axis: usize, [boundary, kind]: [&str; 2]) -> String {
    let back = AxisRotation::to_last(axis).inverse();
    let edges = back.list(EDGES);
    let vector = |v: [f64; 3]| format!("{:?}", back.vector(v.into()).to_array());
    let place = |v: [f64; 3]| format!("{:?}", back.place(v.into(), edges.into()).to_array());
    let more = match kind {
        "couette" => format!(
            "flow = {{ kind = \"shear\", rate = 0.5 }}\nhydrodynamics.lubrication = true\n[[traps]]\n\
             particles = [0, 9]\ncentres = [{}, {}]\nstiffness = 3.0\n",
            place([3.0, 2.0, 4.0]),
            place([-1.0, 9.5, 7.0])
        ),
        "poiseuille" => "flow = { kind = \"poiseuille\", pressure_gradient = 0.3 }\n".to_owned(),
        "flux" => {
            "flow = { kind = \"poiseuille\", mean_velocity = 0.6 }\nhydrodynamics.lubrication = true\n".to_owned()
        }
        "sediment" => format!(
            "gravity.acceleration = {}\nhydrodynamics.lubrication = true\ncontacts = {{ friction = 0.4, roughness = \
             0.05, stiffness = 300.0 }}\n",
            vector([0.3, -0.2, -1.0])
        ),
        _ => format!("gravity.acceleration = {}\n", vector([0.0, 0.0, -1.0])),
    };
    let along = if kind == "layer" { [0.0; 3] } else { [0.3, -0.2, 0.1] };
    let weight = if more.contains("gravity") { "density_difference = 1.0" } else { "" };
    let boundaries = back.list(["periodic", "periodic", boundary]);
    format!(
        r#"
seed = 5
box = {{ edges = {edges:?}, boundaries = {boundaries:?} }}
fluid.viscosity = 2.0
repulsion = {{ strength = 20.0, range = 0.1 }}
time = {{ integrator = "implicit", step = 0.05, steps = 3 }}
statistics = {{ every = 1, bins = 9 }}
{more}
[[species]]
name = "small"
radius = 1.0
count = 8
force = {}
torque = {}
{weight}
[[species]]
name = "large"
radius = 1.3
count = 3
{weight}
"#,
        vector(along),
        vector([0.1, 0.2, -0.3])
    )
}

const SCENES: [[&str; 2]; 5] =
    [["walls", "couette"], ["walls", "poiseuille"], ["wall", "sediment"], ["open", "layer"], ["walls", "flux"]];

/// Results of a run: a frame, and the numbers of the time series and the tables by their names.
struct Shown {
    frame: Frame,
    numbers: HashMap<String, f64>,
}

fn shown(model: &Model, ranks: usize) -> Shown {
    let all = Comm::threads(ranks, |comm| {
        let mut run = SuspensionRun::start(model, None, &comm).unwrap();
        run.sample();
        for step in 0..model.steps {
            run.advance(step + 1).unwrap();
            run.sample();
        }
        let names: Vec<String> = run.quantities().iter().flat_map(simulation::Quantity::columns).collect();
        let mut numbers: HashMap<String, f64> = names.into_iter().zip(run.observe().concat()).collect();
        for table in run.averages().map_or(Vec::new(), |set| set.tables) {
            for (row, (words, values)) in table.rows.iter().enumerate() {
                let row = if table.name == "summary" { words.join(" ") } else { format!("{row} {}", words.join(" ")) };
                for ((column, _), value) in table.columns.iter().zip(values) {
                    numbers.insert(format!("{} {column} {row}", table.name), *value);
                }
            }
        }
        Shown { frame: run.frame(), numbers }
    });
    all.into_iter().next().unwrap()
}

impl Shown {
    fn number(&self, name: &str) -> f64 {
        *self.numbers.get(name).unwrap_or_else(|| panic!("{name} is not there"))
    }

    /// The vector whose components have names with the axis in place of `*`.
    fn vector(&self, name: &str) -> Vector {
        Vector::from_array(AXES.map(|axis| self.number(&name.replace('*', axis))))
    }

    fn tensor(&self, name: &str) -> Tensor {
        let entry =
            |i: usize, j: usize| self.number(&name.replace('*', &format!("{}{}", AXES[i.min(j)], AXES[i.max(j)])));
        let column = |j: usize| Vector::new(entry(0, j), entry(1, j), entry(2, j));
        Tensor::from_cols(column(0), column(1), column(2))
    }

    fn column(&self, name: &str) -> &[f64] {
        &self.frame.particles.columns.iter().find(|column| column.name == name).unwrap().values
    }

    fn vectors(&self, name: &str) -> Vec<Vector> {
        triples(self.column(name))
    }

    /// Unwrapped positions.
    fn places(&self) -> Vec<Vector> {
        let Frame { particles, cell, .. } = &self.frame;
        particles.positions.iter().zip(&particles.steps).map(|(&x, &steps)| x + cell.lattice(steps)).collect()
    }
}

fn triples(numbers: &[f64]) -> Vec<Vector> {
    numbers.chunks_exact(3).map(Vector::from_slice).collect()
}

/// Whether numbers agree relative to a given size.
fn near(found: f64, expected: f64, size: f64, allowed: f64) -> bool {
    found.to_bits() == expected.to_bits()
        || (found - expected).abs() <= allowed * size.max(1.0)
        || (found.is_nan() && expected.is_nan())
}

fn near_vectors(found: &[Vector], expected: &[Vector], allowed: f64) -> bool {
    let size = expected.iter().map(|v| v.length()).fold(0.0, f64::max);
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(a, b)| (*a - *b).length() <= allowed * size.max(1.0))
}

/// Asserts that all results of `found` are those of `upright`, with the last axis rotated to another.
fn is_turned(found: &Shown, upright: &Shown, axis: usize, allowed: f64) {
    let back = AxisRotation::to_last(axis).inverse();
    let edges = Vector::from_array(back.list(upright.frame.cell.edges().to_array()));
    assert_eq!((found.frame.cell.edges(), found.frame.periodic), (edges, back.list(upright.frame.periodic)));
    let places: Vec<Vector> = upright.places().into_iter().map(|place| back.place(place, edges)).collect();
    assert!(near_vectors(&found.places(), &places, allowed), "{axis}");
    let inside = |x: &Vector| (0..3).all(|d| !found.frame.periodic[d] || (x[d] >= 0.0 && x[d] < edges[d]));
    assert!(found.frame.particles.positions.iter().all(inside));
    for name in [VELOCITY, ANGULAR_VELOCITY] {
        let expected: Vec<Vector> = upright.vectors(name).into_iter().map(|v| back.vector(v)).collect();
        assert!(near_vectors(&found.vectors(name), &expected, allowed), "{name}");
    }
    let stresslets = |shown: &Shown| -> Vec<Traceless> {
        shown.column(STRESSLET).chunks_exact(5).map(|s| Traceless(s.try_into().unwrap())).collect()
    };
    for (found, expected) in stresslets(found).iter().zip(stresslets(upright)) {
        let expected = back.traceless(expected);
        assert!(found.0.iter().zip(expected.0).all(|(a, b)| near(*a, b, expected.0[0].abs(), 100.0 * allowed)));
    }
    numbers_are_turned(found, upright, axis, allowed);
}

/// The same for the numbers by name. All of them are checked: as vectors, as tensors, or individually.
fn numbers_are_turned(found: &Shown, upright: &Shown, axis: usize, allowed: f64) {
    let back = AxisRotation::to_last(axis).inverse();
    let [along, beside, across] = AxisRotation::to_last(axis).list(AXES);
    let mut left: HashMap<&str, f64> = upright.numbers.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let mut vectors = vec!["mean_velocity_*[small]".to_owned(), "mean_velocity_*[large]".to_owned()];
    let mut tensors = Vec::new();
    for name in ["stress_stresslet", "stress_lubrication", "stress_repulsion", "stress_contact", "stress_bond"] {
        if upright.numbers.contains_key(&format!("{name}_xx[small]")) {
            tensors.extend(["small", "large"].map(|species| format!("{name}_*[{species}]")));
        }
    }
    for (bin, species) in (0..27).map(|row| (row, ["small", "large", "all"][row / 9])) {
        let row = format!("{bin} {species}");
        vectors.extend(["velocity", "slip", "angular_velocity"].map(|name| format!("profile {name}_* {row}")));
        for name in ["T", "stress", "pair_stress"].map(|name| format!("profile {name}_* {row}")) {
            if upright.numbers.contains_key(&name.replace('*', "xx")) {
                tensors.push(name);
            }
        }
    }
    for species in ["small", "large"] {
        for (mean, tensor, units) in [
            ("mean_velocity", "T", ["length/time", "length^2/time^2"]),
            ("mean_angular_velocity", "w", ["1/time", "1/time^2"]),
        ] {
            vectors.push(format!("summary value {mean}_* {species} {}", units[0]));
            tensors.push(format!("summary value {tensor}_* {species} {}", units[1]));
        }
    }
    for name in vectors {
        let (found, expected) = (found.vector(&name), back.vector(upright.vector(&name)));
        let same = |d: usize| near(found[d], expected[d], expected.length(), allowed);
        assert!((0..3).all(same), "{name}: {found}, not {expected}");
        for axis in AXES {
            _ = left.remove(name.replace('*', axis).as_str());
        }
    }
    for name in tensors {
        let (found, expected) = (found.tensor(&name), back.tensor(&upright.tensor(&name)));
        let [found, expected] = [found.to_cols_array(), expected.to_cols_array()];
        let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let same = found.iter().zip(&expected).all(|(a, b)| near(*a, *b, size, 100.0 * allowed));
        assert!(same, "{name}: {found:?}, not {expected:?}");
        for (i, j) in (0..3).flat_map(|i| (i..3).map(move |j| (i, j))) {
            left.remove(name.replace('*', &format!("{}{}", AXES[i], AXES[j])).as_str());
        }
    }
    for wall in ["lower", "upper"] {
        let name = |axis: &str| format!("wall_shear_stress_{axis}[{wall}]");
        let (Some(x), Some(y)) = (left.remove(name("x").as_str()), left.remove(name("y").as_str())) else { continue };
        let expected = back.vector(Vector::new(x, y, 0.0));
        for axis in [along, beside] {
            let place = AXES.iter().position(|a| *a == axis).unwrap();
            assert!(near(found.number(&name(axis)), expected[place], expected.length(), 100.0 * allowed), "{wall}");
        }
    }
    // Squares, extents and errors have no direction; the remaining names contain an axis or none.
    let renamed = |name: &str| -> String {
        let other = |letter: &str| match letter {
            "x" => along,
            "y" => beside,
            _ => across,
        };
        let is_letter = |word: &str| AXES.contains(&word) || ["xx", "xy", "xz", "yy", "yz", "zz"].contains(&word);
        let parts: Vec<String> = name
            .split_inclusive([' ', '_', '['])
            .map(|part| {
                let (word, end) = part.split_at(part.trim_end_matches([' ', '_', '[']).len());
                if !is_letter(word) {
                    return part.to_owned();
                }
                let mut letters: Vec<&str> = word.split("").filter(|l| !l.is_empty()).map(other).collect();
                letters.sort_unstable();
                letters.concat() + end
            })
            .collect();
        parts.concat()
    };
    for (name, expected) in left {
        if name.starts_with("seconds_per_step") || name.contains("_density ") {
            continue;
        }
        let found = found.number(&renamed(name));
        assert!(near(found, expected, expected.abs(), 1e3 * allowed), "{name}: {found}, not {expected}");
    }
}

/// Walls, one wall and a layer, in Couette and Poiseuille flow and under oblique gravity. Spheres start at the same
/// positions, so that results agree up to round-off, amplified by solves.
#[test]
fn walls_across_x_and_y_are_those_across_z_turned() {
    for kind in SCENES {
        let upright = shown(&model_of(&scene(2, kind), &[]), 1);
        for axis in [0, 1] {
            let found = shown(&model_of(&scene(axis, kind), &[]), 1);
            is_turned(&found, &upright, axis, 1e-9);
        }
    }
}

/// On several numbers of ranks, to the accuracy of solves.
#[test]
fn turned_runs_are_the_same_on_any_ranks() {
    for (kind, axis) in [(SCENES[0], 1), (SCENES[2], 0)] {
        let model = model_of(&scene(axis, kind), &["hydrodynamics.iteration_tolerance=1e-8"]);
        let alone = shown(&model, 1);
        for ranks in [2, 3] {
            let together = shown(&model, ranks);
            assert_eq!(together.frame.particles.steps, alone.frame.particles.steps);
            assert!(near_vectors(&together.places(), &alone.places(), 1e-6));
        }
    }
}

/// Positions that the user gives are those that the user sees at the start, inside the box and outside of it.
#[test]
fn places_are_where_the_user_says() {
    for axis in [0, 1] {
        let back = AxisRotation::to_last(axis).inverse();
        let edges = Vector::from_array(back.list(EDGES));
        let given = [[1.0, 2.0, 3.0], [0.0, 0.0, 7.0], [-4.0, 12.0, 5.0]].map(|x| back.vector(Vector::from_array(x)));
        let list = given.map(|x| x.to_array());
        let keys = [
            &format!("particles={{initial=\"positions\", positions={list:?}}}"),
            "species=[{radius=1.0, count=3}]",
            "time.steps=0",
        ];
        let shown = shown(&model_of(&scene(axis, ["walls", "poiseuille"]), &keys), 1);
        assert!(shown.places().iter().zip(given).all(|(found, given)| (*found - given).length() < 1e-14));
        let inside = |x: &Vector| x.cmpge(Vector::ZERO).all() && x.cmplt(edges).all();
        assert!(shown.frame.particles.positions.iter().all(inside), "{:?}", shown.frame.particles.positions);
    }
}

/// A run resumed half-way continues bit for bit, statistics included.
#[test]
fn a_turned_run_resumes_bit_for_bit() {
    let model = model_of(&scene(1, SCENES[0]), &[]);
    let mut straight = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    let step = |run: &mut SuspensionRun| {
        run.advance(u64::MAX).unwrap();
        run.sample();
    };
    step(&mut straight);
    let mut resumed = SuspensionRun::resume(&model, Some(straight.state()), &Comm::alone()).unwrap();
    assert_eq!(straight.frame(), resumed.frame());
    for run in [&mut straight, &mut resumed] {
        (0..2).for_each(|_| step(run));
    }
    assert_eq!(straight.frame(), resumed.frame());
    assert_eq!(straight.state(), resumed.state());
}

/// User-defined forces receive positions in the user's axes, and act in these.
#[test]
fn forces_of_ones_own_are_in_the_axes_of_the_user() {
    for axis in [0, 1] {
        let force = AxisRotation::to_last(axis).inverse().vector(Vector::new(0.5, -2.0, 0.0));
        let model = model_of(&scene(axis, ["walls", "poiseuille"]), &["time.steps=1"]);
        let by_scene = format!("species=[{{radius=1.0, count=8, force={:?}}}]", force.to_array());
        let expected = shown(&model_of(&scene(axis, ["walls", "poiseuille"]), &[&by_scene, "time.steps=0"]), 1);
        let bare =
            model_of(&scene(axis, ["walls", "poiseuille"]), &["species=[{radius=1.0, count=8}]", "time.steps=0"]);
        let mut run = SuspensionRun::start(&bare, None, &Comm::alone()).unwrap();
        let places = expected.places();
        run.add_loads(UserLoads::OfPositions(Box::new(move |positions, _| {
            assert!(positions.iter().zip(&places).all(|(a, b)| (*a - *b).length() < 1e-13));
            Ok(AppliedLoads { forces: vec![force; positions.len()], ..AppliedLoads::default() })
        })))
        .unwrap();
        let found = Shown { frame: run.frame(), numbers: HashMap::new() };
        assert!(near_vectors(&found.vectors(VELOCITY), &expected.vectors(VELOCITY), 1e-6));
        assert_eq!(model.turn, AxisRotation::to_last(axis));
    }
}

/// Forces of contacts, with the positions of the spheres.
#[test]
fn contacts_are_in_the_axes_of_the_user() {
    let of = |axis: usize| {
        let weight = AxisRotation::to_last(axis).inverse().vector(Vector::new(3.0, -2.0, -10.0));
        let gravity = format!("gravity.acceleration={:?}", weight.to_array());
        let keys = [gravity.as_str(), "contacts.stiffness=3000.0", "time.steps=0"];
        let mut run = SuspensionRun::start(&model_of(&scene(axis, SCENES[2]), &keys), None, &Comm::alone()).unwrap();
        for _ in 0..100 {
            run.advance(u64::MAX).unwrap();
        }
        run.contact_forces().unwrap()
    };
    let upright = of(2);
    assert!(upright.list.len() > 1, "some touch");
    for axis in [0, 1] {
        let (back, found) = (AxisRotation::to_last(axis).inverse(), of(axis));
        let edges = Vector::from_array([0, 1, 2].map(|d| found.lattice[d][d]));
        assert_eq!(found.list.len(), upright.list.len());
        for (found, expected) in found.list.iter().zip(&upright.list) {
            assert_eq!((found.ids, found.state), (expected.ids, expected.state));
            assert!((found.position - back.place(expected.position, edges)).length() < 1e-6);
            assert!((found.separation - back.vector(expected.separation)).length() < 1e-6);
            assert!((found.tangential - back.vector(expected.tangential)).length() < 1e-6);
        }
    }
}

/// Messages name the user's axis.
#[test]
fn a_sphere_that_is_driven_into_a_wall_is_named_by_the_axis_of_the_user() {
    for (axis, name) in AXES.iter().enumerate() {
        let back = AxisRotation::to_last(axis).inverse();
        let (place, force) = (back.vector(Vector::new(0.0, 0.0, 1.3)), back.vector(Vector::new(0.0, 0.0, -300.0)));
        let keys = [
            "repulsion.strength=0.0",
            &format!("species=[{{radius=1.0, count=1, force={:?}}}]", force.to_array()),
            &format!("particles={{initial=\"positions\", positions=[{:?}]}}", place.to_array()),
        ];
        let mut run =
            SuspensionRun::start(&model_of(&scene(axis, ["walls", "poiseuille"]), &keys), None, &Comm::alone())
                .unwrap();
        let error = (0..400).find_map(|_| run.advance(u64::MAX).err()).expect("it sinks in").to_string();
        assert!(error.contains(&format!("driven into a wall: its centre is at {name} = 0.")), "{error}");
    }
}
