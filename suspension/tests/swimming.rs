//! Swimmers.

use crate::support::ended::{ended, run};
use crate::support::model_of;
use crate::support::resumed::resumes_with_the_same_bits;
use domain::{Comm, Particles, Quaternion, Vector, sphere};
use simulation::Simulation;
use std::f64::consts::PI;
use suspension::{Model, ORIENTATION, ParticleStress, STRESSLET, SuspensionRun, VELOCITY};

/// A swimmer in unbounded fluid whose surface does not move: bottom-heavy, or with a rotation of its own.
const STILL: &str = r#"
box.boundaries = ["open", "open", "open"]
fluid.viscosity = 0.7
gravity.acceleration = [0.0, -9.81, 0.0]
particles = { initial = "positions", positions = [[0.0, 0.0, 0.0]] }
hydrodynamics = { tolerance = 1e-6, iteration_tolerance = 1e-12 }
time = { step = 0.1, steps = 20 }
[[species]]
radius = 1.3
count = 1
orientation = "aligned"
orientation_axis = [1.0, -0.6, 0.3]
swimming.speed = 0.0
"#;

const INTEGRATORS: [&[&str]; 4] = [
    &["time.order=4"],
    &["time.integrator=\"adaptive\""],
    &["time.integrator=\"implicit\""],
    &["fluid.thermal_energy=0.05"],
];

fn orientations(particles: &Particles) -> Vec<Quaternion> {
    let column = particles.columns.iter().find(|column| column.name == ORIENTATION).expect("orientations");
    let (all, _) = column.values.as_chunks::<4>();
    all.iter().map(|q| Quaternion::from_array(*q)).collect()
}

/// Angle between two orientations.
fn turned(a: Quaternion, b: Quaternion) -> f64 {
    (a * b.inverse()).log().length()
}

/// The angle `t` of a bottom-heavy sphere from the direction against gravity obeys `tan(t/2) = tan(t0/2) exp(-t/(2B))`,
/// and it turns in a plane.
#[test]
fn bottom_heavy_spheres_turn_against_gravity() {
    let (time, up) = (1.7, Vector::Y);
    let start = Vector::new(1.0, -0.6, 0.3).normalize();
    let half_angle = |axis: Vector| (0.5 * axis.angle_between(up)).tan();
    for (keys, allowed) in INTEGRATORS[..3].iter().zip([2e-6, 1e-4, 5e-4]) {
        let model = model_of(STILL, &[*keys, &["species[0].swimming.gyrotactic_time=1.7"]].concat());
        let axis = orientations(&run(&model, 1))[0].axis();
        let expected = half_angle(start) * (-model.end() / (2.0 * time)).exp();
        assert!((half_angle(axis) / expected - 1.0).abs() < allowed, "{keys:?}: {} {expected}", half_angle(axis));
        assert!(axis.dot(up.cross(start)).abs() < 1e-8, "{keys:?}: {axis}");
    }
}

/// A rotation of its own is a constant one in the axes of the sphere, exact for any step.
#[test]
fn a_rotation_of_its_own_is_exact() {
    let own = Vector::new(0.4, -1.1, 2.0);
    let start = Quaternion::between(Vector::Z, Vector::new(1.0, -0.6, 0.3));
    for keys in &INTEGRATORS[..3] {
        let model = model_of(STILL, &[*keys, &["species[0].swimming.angular_velocity=[0.4,-1.1,2.0]"]].concat());
        let end = orientations(&run(&model, 1))[0];
        let exact = start * Quaternion::exp(own * model.end());
        assert!(turned(end, exact) < 1e-9, "{keys:?}");
    }
}

/// A swimmer in a cubic box.
const ALONE: &str = r#"
box.edges = [8.0, 8.0, 8.0]
fluid.viscosity = 0.7
particles = { initial = "positions", positions = [[1.0, 7.0, 3.0]] }
hydrodynamics = { tolerance = 1e-5, iteration_tolerance = 1e-11 }
time = { step = 0.1, steps = 20 }
[[species]]
radius = 1.2
count = 1
orientation = "aligned"
orientation_axis = [1.0, -0.6, 0.3]
swimming = { speed = 0.9, beta = 3.0 }
"#;

/// Speed in a cubic box over that in unbounded fluid, one minus the volume fraction, whatever the direction: it is
/// relative to fluid and spheres together, and the flow of a lattice of swimmers adds nothing else at their centres.
fn slowed() -> f64 {
    1.0 - sphere::volume(1.2) / 512.0
}

/// Displacement from the start to the end of a run.
fn displacement(model: &Model) -> Vector {
    ended(model, 1, |suspension| {
        let particles = suspension.gathered(None);
        particles.positions[0] + suspension.cell().lattice(particles.steps[0]) - Vector::new(1.0, 7.0, 3.0)
    })
}

#[test]
fn a_swimmer_in_a_cubic_box_is_slowed_by_its_volume_fraction() {
    let axis = Vector::new(1.0, -0.6, 0.3).normalize();
    for keys in &INTEGRATORS[..3] {
        let model = model_of(ALONE, keys);
        let expected = axis * 0.9 * slowed() * model.end();
        let found = displacement(&model);
        assert!((found - expected).length() < 1e-4 * expected.length(), "{keys:?}: {found}, not {expected}");
        let shaker = model_of(ALONE, &[*keys, &["species[0].swimming={speed=0.0,stresslet=5.0}"]].concat());
        let moved = displacement(&shaker).length();
        assert!(moved < 1e-5, "{keys:?}: a shaker moves by {moved:e}, beyond the tolerance");
    }
}

/// Flow of a squirmer alone (Blake, J. Fluid Mech. 46, 199, 1971) with the axis `p`, at `x` from its centre. In the
/// force-coupling method the terms of the second mode that fall with the fourth power of the distance have the factor
/// `3 (sigma'/a)^2`, by the Gaussian of the stresslet.
fn flow_of_one([b1, b2]: [f64; 2], radius: f64, p: Vector, x: Vector) -> Vector {
    let (r, n) = (x.length(), x.normalize());
    let (q, cosine) = (radius / r, n.dot(p));
    let fourth = 3.0 * (6.0 * PI.sqrt()).powf(-2.0 / 3.0) * q.powi(4);
    let radial = 2.0 / 3.0 * b1 * q.powi(3) * cosine + b2 * (fourth - q * q) * (1.5 * cosine * cosine - 0.5);
    // The unit vector in which the angle to the axis grows, times the sine.
    let around = n * cosine - p;
    n * radial + around * (b1 / 3.0 * q.powi(3) + b2 * fourth * cosine)
}

/// Beyond a radius from the surface the velocity field is that of a squirmer.
#[test]
fn the_field_of_a_swimmer_is_the_exact_one() {
    let p = Vector::new(1.0, -0.6, 0.3).normalize();
    for (beta, ranks) in [(0.0_f64, 1), (0.0, 2), (-3.0, 1)] {
        let swimming = format!("species[0].swimming={{speed=0.8,beta={beta}}}");
        let model = model_of(STILL, &[&swimming, "output.fields_every=1", "hydrodynamics.tolerance=1e-4"]);
        let all = Comm::threads(ranks, |comm| {
            let mut run = SuspensionRun::start(&model, None, &comm).unwrap();
            let places = run.state().particles.positions.clone();
            (run.velocity_field().unwrap().unwrap(), places)
        });
        let centre = all.iter().flat_map(|(_, places)| places).next().copied().unwrap();
        let field = &all[0].0;
        let [nx, ny, nz] = field.points;
        let (b1, mut seen) = (1.5 * 0.8, 0);
        for (row, velocity) in field.values.iter().enumerate() {
            let at = [row % nx, row / nx % ny, row / (nx * ny)].map(|n| n as f64);
            let x = field.origin + field.spacing * Vector::from_array(at) - centre;
            if x.length() > 2.6 {
                let exact = flow_of_one([b1, beta * b1], 1.3, p, x);
                let allowed = 1e-3 * b1 * (1.0 + beta.abs());
                assert!((*velocity - exact).length() < allowed, "{beta} at {x}: {velocity}, not {exact}");
                seen += 1;
            }
        }
        assert!(seen > nx * ny * nz / 10, "{seen} of {nx} x {ny} x {nz} points");
    }
}

/// With a rotation of its own a swimmer moves on a helix about the axis of that rotation, and on a circle if the axis
/// is across its own.
#[test]
fn a_chiral_swimmer_moves_on_a_helix() {
    let (axis, speed) = (Vector::new(1.0, -0.6, 0.3).normalize(), 0.9 * slowed());
    let start = Quaternion::between(Vector::Z, axis);
    for own in [Vector::new(1.5, 0.0, 0.0), Vector::new(0.7, -1.1, 0.9)] {
        let key = format!("species[0].swimming.angular_velocity={:?}", own.to_array());
        let (turning, rate) = (start.rotate(own) / own.length(), own.length());
        let along = turning * axis.dot(turning);
        let across = axis - along;
        for (keys, allowed) in INTEGRATORS[..3].iter().zip([1e-4, 1e-3, 1e-2]) {
            let model = model_of(ALONE, &[*keys, &[&key, "time.step=0.05", "time.steps=40"]].concat());
            let (sin, cos) = (rate * model.end()).sin_cos();
            let around = (across * sin + turning.cross(across) * (1.0 - cos)) / rate;
            let expected = (along * model.end() + around) * speed;
            let found = displacement(&model);
            assert!((found - expected).length() < allowed, "{keys:?}: {found}, not {expected}");
        }
    }
}

/// In shear the active stress is that of all swimmers alone, and all parts add up to that of the total stresslets.
#[test]
fn the_active_stress_is_a_part_of_the_whole() {
    let keys = ["flow={kind=\"shear\",rate=0.4}", "repulsion={strength=0.0}", "time.steps=2"];
    let [active, total, of_columns, of_axes] = ended(&model_of(ALL, &keys), 2, |suspension| {
        let parts = suspension.stress(3);
        let particles = suspension.gathered(None);
        let volume = suspension.cell().volume();
        let column = particles.columns.iter().find(|column| column.name == STRESSLET).unwrap();
        let sum = |component: usize| column.values.chunks_exact(5).map(|s| s[component]).sum::<f64>() / volume;
        let alone = |(q, &kind): (Quaternion, &u32)| {
            // 4 pi mu a^2 B2 of the first species, and the stresslet of the second.
            let strength = [4.0 * PI * 0.64 * -3.0, 3.0, 0.0][kind as usize];
            strength * q.axis().x * q.axis().y / volume
        };
        let of_axes = orientations(&particles).into_iter().zip(&particles.species).map(alone).sum::<f64>();
        let active = parts.iter().map(|part| part.of(ParticleStress::ACTIVE).y_axis.x).sum::<f64>();
        [active, ParticleStress::sum(&parts).y_axis.x, sum(1), of_axes]
    });
    assert!((active - of_axes).abs() < 1e-12 && active.abs() > 1e-3, "{active} {of_axes}");
    assert!((total - of_columns).abs() < 1e-12, "{total} {of_columns}");
}

/// The speed in the time series is that along the own axes, and clusters are counted across faces of the box, on any
/// ranks.
#[test]
fn the_time_series_has_speeds_and_clusters() {
    let places = "particles.positions=[[1.0,7.0,3.0],[1.0,9.45,3.0],[6.9,7.2,3.0],[5.0,5.0,7.0]]";
    let keys = ["species[0].count=4", "box.edges=[8.3,11.0,12.0]", places, "time.steps=0"];
    for ranks in [1, 2, 3] {
        let rows = Comm::threads(ranks, |comm| {
            let mut run = SuspensionRun::start(&model_of(ALONE, &keys), None, &comm).unwrap();
            let names: Vec<String> = run.quantities().iter().map(|quantity| quantity.name.to_string()).collect();
            let rows = run.observe();
            let row = |name: &str| rows[names.iter().position(|other| other == name).unwrap()].clone();
            let mut particles = run.suspension().gathered(None);
            let velocities = particles.vectors(VELOCITY).to_vec();
            let along: f64 = orientations(&particles).iter().zip(velocities).map(|(q, v)| q.axis().dot(v)).sum();
            let numbers = ["swimming", "close_neighbours", "largest_cluster"].map(|name| row(name)[0]);
            (numbers, along / 4.0)
        });
        let (numbers, along) = rows[0];
        assert!((numbers[0] - along).abs() < 1e-12 && along != 0.0, "{numbers:?}: {along}");
        // The first is close to the second, and the third to an image of the first across a face along x.
        assert_eq!(numbers[1..], [1.0, 0.75], "{ranks} ranks");
    }
}

/// Swimmers of two species with all that can change their directions, and passive spheres.
const ALL: &str = r#"
seed = 6
box.edges = [11.0, 10.0, 9.0]
fluid.viscosity = 1.0
gravity.acceleration = [0.0, 0.0, -1.0]
particles = { initial = "random", minimum_gap = 0.3 }
repulsion = { strength = 4.0 }
hydrodynamics = { method = "split", tolerance = 1e-3, iteration_tolerance = 1e-10 }
time = { step = 0.05, steps = 5 }
[[species]]
radius = 0.8
count = 9
swimming = { speed = 1.0, beta = -2.0, rotational_diffusion = 0.3, tumbling_rate = 2.0, gyrotactic_time = 3.0 }
[[species]]
radius = 0.6
count = 5
orientation = "aligned"
orientation_axis = [0.0, 1.0, 0.0]
swimming = { speed = 0.5, stresslet = 3.0, angular_velocity = [0.5, 0.0, 1.0] }
[[species]]
radius = 0.9
count = 4
"#;

/// Fixed steps with lubrication between swimmers.
const LUBRICATED: &[&str] = &["hydrodynamics.lubrication=true", "time.order=2"];

/// A run that is resumed after any step has the bits of one that is not, for all integrators.
#[test]
#[ignore = "heavy"]
fn a_resumed_run_has_the_same_bits() {
    for keys in INTEGRATORS.into_iter().chain([LUBRICATED]) {
        let model = model_of(ALL, &[keys, &["statistics={every=1}"]].concat());
        resumes_with_the_same_bits(&model, &format!("{keys:?}"));
    }
}

/// Directions change by the same random numbers on any ranks.
#[test]
#[ignore = "heavy"]
fn ranks_and_threads_agree() {
    for keys in INTEGRATORS.into_iter().chain([LUBRICATED]) {
        let model = model_of(ALL, &[keys, &["time.steps=3"]].concat());
        let alone = run(&model, 1);
        for ranks in [2, 3] {
            let found = run(&model, ranks);
            let apart = |(a, b): (&Quaternion, &Quaternion)| if a.is_some() { turned(*a, *b) } else { 0.0 };
            let angle = orientations(&alone).iter().zip(&orientations(&found)).map(apart).fold(0.0, f64::max);
            let moved = alone.positions.iter().zip(&found.positions).map(|(a, b)| (*a - *b).length());
            let moved = moved.fold(0.0, f64::max);
            assert!(angle < 1e-6 && moved < 1e-6, "{keys:?} on {ranks} ranks: {angle:e} {moved:e}");
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        assert_eq!(pool.install(|| run(&model, 1)), alone, "{keys:?}");
    }
}
