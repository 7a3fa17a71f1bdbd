//! Velocity fields of runs.

use crate::support::model_of;
use domain::{AxisRotation, Comm, Vector};
use simulation::{Simulation, VelocityField};
use suspension::{Model, SuspensionRun};

/// Edges of the box if the special axis is z.
const EDGES: [f64; 3] = [9.0, 8.0, 10.0];

/// Scene with a boundary along its special axis, or all axes, and a kind of driving; `axis` is the special axis, and
/// vectors are given as if it were z.
fn scene(axis: usize, [boundary, kind]: [&str; 2]) -> String {
    let back = AxisRotation::to_last(axis).inverse();
    let vector = |v: [f64; 3]| format!("{:?}", back.vector(v.into()).to_array());
    let edges = back.list(EDGES);
    let boundaries = if kind == "cloud" { [boundary; 3] } else { back.list(["periodic", "periodic", boundary]) };
    let (more, force) = match kind {
        "couette" => ("flow = { kind = \"shear\", rate = 0.5 }\nhydrodynamics.lubrication = true\n", [0.3, -0.2, 0.1]),
        "flux" => ("flow = { kind = \"poiseuille\", mean_velocity = 0.6 }\n", [0.3, -0.2, 0.1]),
        "sediment" => ("hydrodynamics.lubrication = true\n", [0.3, -0.2, -1.0]),
        _ => ("", [0.0, 0.0, -1.0]),
    };
    format!(
        r#"
seed = 5
box = {{ edges = {edges:?}, boundaries = {boundaries:?} }}
fluid.viscosity = 2.0
output.fields_every = 2
repulsion = {{ strength = 20.0, range = 0.1 }}
time = {{ step = 0.05, steps = 3 }}
{more}
[[species]]
name = "small"
radius = 1.0
count = 8
force = {}
torque = {}
[[species]]
name = "large"
radius = 1.3
count = 3
force = {}
"#,
        vector(force),
        vector([0.1, 0.2, -0.3]),
        vector(force),
    )
}

const SCENES: [[&str; 2]; 5] =
    [["walls", "couette"], ["walls", "flux"], ["wall", "sediment"], ["open", "layer"], ["open", "cloud"]];

/// Field on the first rank after some steps.
fn field(model: &Model, steps: u64, ranks: usize) -> VelocityField {
    let all = Comm::threads(ranks, |comm| {
        let mut run = SuspensionRun::start(model, None, &comm).unwrap();
        for step in 0..steps {
            run.advance(step + 1).unwrap();
        }
        let field = run.velocity_field().unwrap().unwrap();
        assert!(comm.is_first() || field.values.is_empty());
        field
    });
    all.into_iter().next().unwrap()
}

fn place(field: &VelocityField, at: [usize; 3]) -> Vector {
    field.origin + field.spacing * Vector::from_array(at.map(|n| n as f64))
}

fn value(field: &VelocityField, [x, y, z]: [usize; 3]) -> Vector {
    field.values[(z * field.points[1] + y) * field.points[0] + x]
}

fn all_points(field: &VelocityField) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = field.points;
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

fn largest(field: &VelocityField) -> f64 {
    field.values.iter().map(|u| u.length()).fold(0.0, f64::max)
}

/// Largest difference of two fields at the same points.
fn apart(one: &VelocityField, other: &VelocityField) -> f64 {
    assert_eq!((one.points, one.periodic), (other.points, other.periodic));
    assert!((one.origin - other.origin).length() < 1e-6 && (one.spacing - other.spacing).length() < 1e-12);
    one.values.iter().zip(&other.values).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
}

/// The value at each of the user's positions is the rotated velocity at that position of the box.
#[test]
#[ignore = "heavy"]
fn fields_are_in_the_axes_of_the_user() {
    for kind in &SCENES[..4] {
        let upright = field(&model_of(&scene(2, *kind), &[]), 2, 1);
        assert_eq!(upright.values.len(), upright.points.iter().product::<usize>());
        for axis in [0, 1] {
            let back = AxisRotation::to_last(axis).inverse();
            let found = field(&model_of(&scene(axis, *kind), &[]), 2, 1);
            assert_eq!(found.points, back.list(upright.points), "{kind:?}");
            let edges = Vector::from_array(back.list(EDGES));
            let mut seen = 0;
            for at in all_points(&upright) {
                let (there, turned) = (back.place(place(&upright, at), edges), back.vector(value(&upright, at)));
                let mut index = ((there - found.origin) / found.spacing).round().to_array().map(|n| n as i64);
                for d in (0..3).filter(|&d| found.periodic[d]) {
                    index[d] = index[d].rem_euclid(found.points[d] as i64);
                }
                let index = index.map(|n| usize::try_from(n).unwrap());
                let mut off = place(&found, index) - there;
                for d in (0..3).filter(|&d| found.periodic[d]) {
                    off[d] -= (off[d] / edges[d]).round() * edges[d];
                }
                assert!(off.length() < 1e-9, "{kind:?}: {there} is not {}", place(&found, index));
                assert!((value(&found, index) - turned).length() < 1e-9 * largest(&upright), "{kind:?} at {there}");
                seen += 1;
            }
            assert_eq!(seen, found.values.len());
        }
    }
}

/// On several numbers of ranks values agree to the tolerance of solves, and points agree.
#[test]
#[ignore = "heavy"]
fn fields_are_the_same_on_any_ranks() {
    for kind in SCENES {
        let model = model_of(&scene(2, kind), &["hydrodynamics.iteration_tolerance=1e-8"]);
        let alone = field(&model, 1, 1);
        for ranks in [2, 3] {
            let off = apart(&field(&model, 1, ranks), &alone);
            assert!(off < 1e-5 * largest(&alone), "{kind:?} on {ranks} ranks: {off:e}");
        }
    }
}

/// Points extend from wall to wall; in other boxes they extend beyond the spheres by two of the largest radii.
#[test]
fn points_are_where_fluid_is() {
    for kind in SCENES {
        let model = model_of(&scene(2, kind), &[]);
        let field = field(&model, 3, 1);
        let last = place(&field, field.points.map(|n| n - 1));
        let beyond = 2.6;
        for axis in 0..3 {
            let (low, high) = (field.origin[axis], last[axis]);
            let (origin, edge) = (field.cell.origin()[axis], field.cell.edges()[axis]);
            let spacing = field.spacing[axis];
            let walls = if kind[0] == "walls" { 2 } else { usize::from(kind[0] == "wall") };
            if field.periodic[axis] {
                assert!(low.abs() < f64::MIN_POSITIVE);
                assert!((high + spacing - edge).abs() < 1e-12);
                continue;
            }
            let begins = if walls > 0 { [0.0; 2] } else { [origin - beyond, origin - beyond + spacing] };
            let ends = if walls > 1 { [edge; 2] } else { [origin + edge + beyond - spacing, origin + edge + beyond] };
            assert!(low >= begins[0] - 1e-12 && low <= begins[1] + 1e-12, "{kind:?}: begins at {low}");
            assert!(high >= ends[0] - 1e-12 && high <= ends[1] + 1e-12, "{kind:?}: ends at {high}");
        }
    }
}

/// The background flow has the whole given flux, so that the field has none along it, whatever flow the spheres and
/// their pressure gradient drive. Perpendicular to the flow there is no such constraint.
#[test]
fn a_given_flux_is_that_of_the_background() {
    let model = model_of(&scene(2, SCENES[1]), &["hydrodynamics.tolerance=1e-4"]);
    let field = field(&model, 1, 1);
    let [nx, ny, nz] = field.points;
    let mean = |z: usize| {
        let plane = &field.values[z * nx * ny..(z + 1) * nx * ny];
        plane.iter().fold(Vector::ZERO, |sum, u| sum + *u) / (nx * ny) as f64
    };
    let weight = |z: usize| if z == 0 || z == nz - 1 { 0.5 } else { 1.0 };
    let through = (0..nz).fold(Vector::ZERO, |sum, z| sum + mean(z) * weight(z)) / (nz - 1) as f64;
    let size = (0..nz).map(|z| mean(z).length()).fold(0.0, f64::max);
    println!("{through} of {size}");
    assert!(size > 1e-3);
    // In the flux a sphere counts with a^2/6, its envelope with sigma^2/2 = a^2/2 pi.
    assert!(through.x.abs() < 0.01 * size, "{through} of {size}");
    assert!(through.y.abs() > 0.1 * size, "along the other axis the forces drive a flux: {through} of {size}");
    assert!(through.z.abs() < 1e-3 * size, "nothing flows through walls: {through} of {size}");
}

/// Computing a field has no effect on the run, and a resumed run has the same field.
#[test]
#[ignore = "heavy"]
fn fields_are_of_no_consequence_and_resume_bit_for_bit() {
    for kind in SCENES {
        let model = model_of(&scene(2, kind), &[]);
        let mut straight = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
        let mut without = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
        for step in 1..=3 {
            let found = straight.velocity_field().unwrap().unwrap();
            let mut resumed = SuspensionRun::resume(&model, Some(straight.state()), &Comm::alone()).unwrap();
            assert_eq!(resumed.velocity_field().unwrap().unwrap(), found, "{kind:?} before step {step}");
            for run in [&mut straight, &mut without] {
                run.advance(step).unwrap();
            }
            assert_eq!(straight.state(), without.state(), "{kind:?} after step {step}");
        }
    }
}

/// A body of two spheres so far apart that no lubrication acts between them.
const WIDE_BODY: &str = r#"
box.edges = [16.0, 14.0, 15.0]
fluid.viscosity = 1.0
output.fields_every = 1
time = { step = 0.1, steps = 1 }
[[bodies]]
shape = "doublet"
radius = 1.0
gap = 3.0
count = 1
torque = [2.0, -1.0, 5.0]
"#;

/// The forces that keep a body rigid are part of its flow, with lubrication and without.
#[test]
fn the_field_of_a_body_has_the_forces_between_its_spheres() {
    let keys = "hydrodynamics={tolerance=1e-4,iteration_tolerance=1e-8}";
    let [alone, lubricated] = [keys, "hydrodynamics={tolerance=1e-4,iteration_tolerance=1e-8,lubrication=true}"]
        .map(|keys| field(&model_of(WIDE_BODY, &[keys]), 1, 1));
    assert!(apart(&alone, &lubricated) < 1e-3 * largest(&alone));
}
