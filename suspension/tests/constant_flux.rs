//! Flow between walls at a given mean velocity.

use crate::support::ended::ended;
use crate::support::model_of;
use domain::{Boundaries, Bytes, Comm, PeriodicBox, Traceless, Vector};
use fcm::Loads;
use lubrication::{LubricationRange, WallForce};
use simulation::{Quantity, Simulation};
use solver::BackgroundFlow;
use std::f64::consts::PI;
use suspension::{
    ANGULAR_VELOCITY, Mobility, MobilityParameters, ParticleStress, STRESSLET, Suspension, SuspensionRun, VELOCITY,
};

/// Spheres of two sizes, some near walls, under forces and torques.
const SCENE: &str = r#"
seed = 5
box = { edges = [9.0, 8.0, 10.0], boundaries = ["periodic", "periodic", "walls"] }
fluid.viscosity = 2.0
flow = { kind = "poiseuille", mean_velocity = 0.7 }
repulsion = { strength = 20.0, range = 0.1 }
hydrodynamics = { tolerance = 1e-3, iteration_tolerance = 1e-9 }
particles = { initial = "random", minimum_gap = 0.01 }
time = { step = 0.02, steps = 0 }
[[species]]
radius = 1.0
count = 12
force = [0.4, -0.3, 0.2]
torque = [0.1, 0.9, -0.3]
[[species]]
radius = 1.4
count = 5
force = [0.8, 0.0, 0.1]
"#;

const AREA: f64 = 72.0;
const HEIGHT: f64 = 10.0;
const VISCOSITY: f64 = 2.0;
const MEAN_VELOCITY: f64 = 0.7;

/// Pressure gradient of the fluid without spheres.
const ALONE: f64 = 12.0 * VISCOSITY * MEAN_VELOCITY / (HEIGHT * HEIGHT);

const LUBRICATION: [&str; 2] = ["hydrodynamics.lubrication=true", "hydrodynamics.lubrication=false"];

/// Spheres without forces, and no repulsion.
const FREE: [&str; 2] = ["species=[{radius=1.0, count=12}, {radius=1.4, count=5}]", "repulsion.strength=0.0"];

/// Motions and the pressure gradient.
struct Seen {
    gradient: f64,
    velocities: Vec<Vector>,
    spins: Vec<Vector>,
    stresslets: Vec<Traceless>,
    positions: Vec<Vector>,
    radii: Vec<f64>,
    walls: Vec<[f64; 2]>,
}

fn seen(suspension: &mut Suspension) -> Seen {
    let total = suspension.stress(2).iter().map(ParticleStress::total).reduce(|sum, stress| sum + stress).unwrap();
    let mut all = suspension.gathered(None);
    Seen {
        gradient: suspension.pressure_gradient().unwrap_or_default(),
        velocities: all.vectors(VELOCITY).to_vec(),
        spins: all.vectors(ANGULAR_VELOCITY).to_vec(),
        stresslets: bytemuck::cast_slice(&all.column(STRESSLET, 5).values).to_vec(),
        positions: all.positions.to_vec(),
        radii: all.radii.clone(),
        walls: suspension.wall_stress(&total),
    }
}

fn at_end(keys: &[&str], ranks: usize) -> Seen {
    ended(&model_of(SCENE, keys), ranks, seen)
}

fn driven_by(gradient: f64) -> String {
    format!("flow={{kind=\"poiseuille\", pressure_gradient={gradient}}}")
}

/// Largest difference of vectors, relative to the largest vector.
fn difference(found: &[Vector], expected: &[Vector]) -> f64 {
    let largest = |list: &mut dyn Iterator<Item = Vector>| list.map(Vector::length).fold(0.0, f64::max);
    let scale = largest(&mut expected.iter().copied());
    largest(&mut found.iter().zip(expected).map(|(&a, &b)| a - b)) / scale
}

/// Forces and torques of the species on each sphere.
fn loads(seen: &Seen) -> Vec<[Vector; 2]> {
    let small = [Vector::new(0.4, -0.3, 0.2), Vector::new(0.1, 0.9, -0.3)];
    let large = [Vector::new(0.8, 0.0, 0.1), Vector::ZERO];
    seen.radii.iter().map(|&radius| if radius < 1.2 { small } else { large }).collect()
}

/// The resulting pressure gradient, given instead of the mean velocity, drives the same motions, to the tolerance of
/// solves.
#[test]
fn the_pressure_gradient_that_comes_out_drives_the_same_motions() {
    for lubrication in LUBRICATION {
        let flux = at_end(&[lubrication], 1);
        assert!(flux.gradient > 1.2 * ALONE, "spheres resist: {}", flux.gradient);
        let pressure = at_end(&[lubrication, &driven_by(flux.gradient)], 1);
        for (found, expected) in [(&flux.velocities, &pressure.velocities), (&flux.spins, &pressure.spins)] {
            let error = difference(found, expected);
            assert!(error < 1e-7, "{lubrication}: {error:e}");
        }
        let shear = |seen: &Seen| seen.stresslets.iter().map(|s| s.tensor().z_axis.x).collect::<Vec<_>>();
        let largest = shear(&pressure).iter().copied().map(f64::abs).fold(0.0, f64::max);
        let error = shear(&flux).iter().zip(shear(&pressure)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-7 * largest, "{lubrication}: stresslets {error:e} of {largest}");
        // Another pressure gradient drives other motions.
        let other = at_end(&[lubrication, &driven_by(ALONE)], 1);
        assert!(difference(&flux.velocities, &other.velocities) > 1e-2);
    }
}

/// By the reciprocal theorem, the flux driven by forces and torques is their work on free spheres in the flow of a unit
/// pressure gradient; the rest of the given flux is that of the pressure gradient. No sum over stresslets is involved.
#[test]
fn the_flux_is_the_one_given_by_the_reciprocal_theorem() {
    let given = MEAN_VELOCITY * AREA * HEIGHT;
    for lubrication in LUBRICATION {
        let free = at_end(&[&FREE[..], &[lubrication]].concat(), 1);
        let unit = at_end(&[&FREE[..], &[lubrication, &driven_by(1.0)]].concat(), 1);
        let loaded = at_end(&[lubrication, FREE[1]], 1);
        let motions = unit.velocities.iter().zip(&unit.spins);
        let by_loads: f64 = loads(&loaded).iter().zip(motions).map(|([f, t], (&u, &w))| f.dot(u) + t.dot(w)).sum();
        let flux = loaded.gradient * given / free.gradient + by_loads;
        assert!(by_loads.abs() > 0.02 * given, "forces drive a flow: {by_loads}");
        assert!((flux / given - 1.0).abs() < 1e-7, "{lubrication}: {flux}, not {given}");
    }
}

/// Two layers of spheres, one at each wall.
const LAYERS: &str = "particles={initial=\"positions\", positions=[[1.0, 2.0, 1.45], [3.1, 2.2, 1.45], \
    [5.5, 2.0, 1.45], [4.0, 4.3, 1.45], [1.5, 5.0, 1.45], [6.5, 5.5, 1.45], [1.0, 2.0, 8.0], [3.2, 2.2, 8.0], \
    [5.5, 2.0, 8.0], [4.0, 4.3, 8.0], [1.5, 5.0, 8.0], [6.5, 5.5, 8.0], [8.0, 3.6, 1.45], \
    [3.7, 6.9, 1.45], [8.0, 3.6, 8.0]]}";

/// Contribution of lubrication at walls to the sum over spheres: the lubrication forces on the fluid along x times half
/// the squared distance from the wall, since this lubrication acts relative to a flow that is linear from the wall.
fn at_walls(found: &Seen) -> f64 {
    let (force, curvature) = (WallForce::new(VISCOSITY, LubricationRange::default()), found.gradient / VISCOSITY);
    let of_sphere = |row: usize| {
        let (place, radius) = (found.positions[row], found.radii[row]);
        let passing = 0.5 * curvature * place.z * (HEIGHT - place.z) - curvature * radius * radius / 6.0;
        let strain = 0.25 * curvature * (HEIGHT - 2.0 * place.z);
        let (slip, spin) = (found.velocities[row] - Vector::X * passing, found.spins[row] - Vector::Y * strain);
        let at_wall = |(axis, distance): (Vector, f64)| {
            let Some(factor) = force.factor(axis, distance, radius) else { return 0.0 };
            let (resistance, lever) = (factor.coefficients(), 0.5 * distance * distance);
            let by_strain = resistance.by_strain(axis, Traceless([0.0, 0.0, strain, 0.0, 0.0]));
            let by_motion = resistance.by_motion(axis, [slip + Vector::X * (curvature * lever), spin]);
            (by_strain.force - by_motion.force).x * lever
        };
        [(-Vector::Z, place.z), (Vector::Z, HEIGHT - place.z)].map(at_wall).iter().sum::<f64>()
    };
    (0..found.radii.len()).map(of_sphere).sum()
}

/// The pressure gradient as a sum over the spheres, of external loads and total stresslets, and of lubrication at
/// walls. Stresslets of lubrication between two spheres are taken at their midpoint: exact for spheres at the same
/// height, otherwise approximate.
#[test]
fn the_pressure_gradient_is_a_sum_over_spheres() {
    let random = ["time.steps=0", "seed=5"];
    let layers = [LAYERS, "box.edges=[9.0, 8.0, 10.0]"];
    for (lubrication, place, allowed) in
        [(LUBRICATION[0], random, 3e-2), (LUBRICATION[1], random, 1e-7), (LUBRICATION[0], layers, 1e-7)]
    {
        let species = "species=[{radius=1.0, count=12, force=[0.4, -0.3, 0.2], torque=[0.1, 0.9, -0.3]}, \
                       {radius=1.4, count=3, force=[0.8, 0.0, 0.1]}]";
        let found = at_end(&[lubrication, FREE[1], species, place[0], place[1]], 1);
        let spheres = found.positions.iter().zip(&found.radii).zip(found.stresslets.iter().zip(loads(&found)));
        let sum: f64 = spheres
            .map(|((x, a), (stresslet, [force, torque]))| {
                let parabola = 0.5 * x.z * (HEIGHT - x.z) - a * a / 6.0;
                force.x * parabola - (stresslet.tensor().z_axis.x - 0.5 * torque.y) * (0.5 * HEIGHT - x.z)
            })
            .sum();
        let by_walls = if lubrication == LUBRICATION[0] { at_walls(&found) } else { 0.0 };
        let expected = ALONE - 12.0 / (AREA * HEIGHT.powi(3)) * (sum + by_walls);
        let error = (found.gradient - expected).abs() / (found.gradient - ALONE).abs();
        assert!(error < allowed, "{lubrication}: {} is not {expected}, {error:e}", found.gradient);
    }
}

/// Mean velocity of the fluid between walls due to a force, a torque and a stresslet on one sphere, sampled by small
/// spheres without loads at many positions. It agrees with the formula with the widths of both envelopes.
#[test]
#[ignore = "heavy"]
fn the_flux_of_one_sphere_is_that_of_the_fluid_around_it() {
    let edges = Vector::new(9.0, 8.0, 9.0);
    let centre = Vector::new(2.0, 3.0, 3.4);
    let (per_axis, planes) = (8, 37);
    let [first, last] = [0.9, 8.1];
    let spacing = (last - first) / (planes - 1) as f64;
    let mut positions = vec![centre];
    for (plane, (i, j)) in
        (0..planes).flat_map(|p| (0..per_axis * per_axis).map(move |n| (p, (n / per_axis, n % per_axis))))
    {
        let along = |k: usize, edge: f64| (k as f64 + 0.5) * edge / per_axis as f64;
        positions.push(Vector::new(along(i, edges.x), along(j, edges.y), first + plane as f64 * spacing));
    }
    let count = positions.len();
    let cell = PeriodicBox::new(edges).unwrap().with_boundaries(Boundaries::Walls).unwrap();
    let usual = MobilityParameters::new(cell, VISCOSITY, vec![1.0; count]);
    let parameters = MobilityParameters { rigid: false, tolerance: 1e-5, ..usual };
    let mut mobility = Mobility::new(parameters, Bytes::default(), &Comm::alone()).unwrap();
    mobility.place(&positions).unwrap();
    let mut flux = |force: f64, torque: f64, stresslet: f64| {
        let on_first = |value: Vector| {
            let mut list = vec![Vector::ZERO; count];
            list[0] = value;
            list
        };
        let mut stresslets = vec![Traceless::ZERO; count];
        stresslets[0] = Traceless([0.0, 0.0, stresslet, 0.0, 0.0]);
        let loads = Loads { forces: on_first(Vector::X * force), torques: on_first(Vector::Y * torque), stresslets };
        let motions = mobility.apply(&loads, &BackgroundFlow::NONE).unwrap().motion.velocities;
        let mean = |plane: usize| {
            let here = &motions[1 + plane * per_axis * per_axis..][..per_axis * per_axis];
            here.iter().map(|v| v.x).sum::<f64>() / here.len() as f64
        };
        // Simpson's rule, and linear profiles down to zero at the walls.
        let weight = |plane: usize| match plane {
            0 => 1.0,
            last if last == planes - 1 => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let inner = spacing / 3.0 * (0..planes).map(|plane| weight(plane) * mean(plane)).sum::<f64>();
        inner + 0.5 * (first * mean(0) + (edges.z - last) * mean(planes - 1))
    };
    let over = 1.0 / (VISCOSITY * edges.x * edges.y);
    let slope = 0.5 * edges.z - centre.z;
    let parabola = 0.5 * centre.z * (edges.z - centre.z);
    // Two monopole envelopes have the variance 2 a^2 / pi.
    for (found, expected) in [
        (flux(1.0, 0.0, 0.0), over * (parabola - 1.0 / PI)),
        (flux(0.0, 1.0, 0.0), over * 0.5 * slope),
        (flux(0.0, 0.0, 1.0), -over * slope),
    ] {
        // Tolerance: envelopes damp a wave as long as the sampling distance, 1.1 radii, to less than a thousandth, and
        // so the part beyond a distance of 2.5 radii, from where profiles are linear.
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} is not {expected}");
    }
}

/// A sphere in the middle of a wide channel hardly changes the flow; at a quarter of the height its dissipation is
/// Einstein's for the local shear rate.
#[test]
fn one_sphere_adds_einsteins_resistance() {
    let place = |z: f64| {
        let position = format!("particles={{initial=\"positions\", positions=[[4.0, 4.0, {z}]]}}");
        let keys = ["species=[{radius=1.0, count=1}]", "box.edges=[30.0, 30.0, 20.0]", &position];
        ended(&model_of(SCENE, &keys), 1, |suspension| suspension.pressure_gradient().unwrap())
    };
    let alone = 12.0 * VISCOSITY * MEAN_VELOCITY / 400.0;
    // The work on the fluid at a mean velocity U equals the dissipation, increased by 5/2 mu gamma^2 4/3 pi.
    let rate = 6.0 * MEAN_VELOCITY / 20.0 * 0.5;
    let more = 2.5 * VISCOSITY * rate * rate * 4.0 / 3.0 * PI / (900.0 * 20.0 * MEAN_VELOCITY);
    let [middle, quarter] = [10.0, 5.0].map(|z| place(z) - alone);
    assert!(middle.abs() < 0.02 * more, "{middle} of {more}");
    assert!((quarter / more - 1.0).abs() < 0.03, "{quarter}, not {more}");
}

/// Without flux, as in a closed vessel, spheres settling along the walls drive a backflow, and settle more slowly than
/// in a channel with open ends.
#[test]
fn without_a_flux_fluid_flows_back() {
    let keys = ["flow.mean_velocity=0.0", "species=[{radius=1.0, count=17, force=[1.0, 0.0, 0.0]}]"];
    let closed = at_end(&keys, 1);
    let open = at_end(&["flow={kind=\"none\"}", keys[1]], 1);
    let mean = |seen: &Seen| seen.velocities.iter().map(|v| v.x).sum::<f64>() / 17.0;
    assert!(closed.gradient < 0.0, "pressure bears the weight: {}", closed.gradient);
    assert!(mean(&closed) > 0.0 && mean(&closed) < 0.6 * mean(&open), "{} {}", mean(&closed), mean(&open));
}

/// Walls bear the force of the pressure and the forces on the spheres; their mean bears the pressure gradient over half
/// the height.
#[test]
fn walls_bear_pressure_and_forces() {
    for lubrication in LUBRICATION {
        let Seen { gradient, walls, .. } = at_end(&[lubrication], 1);
        let force = 12.0 * 0.4 + 5.0 * 0.8;
        let pushed = gradient * HEIGHT + force / AREA;
        assert!((walls[0][0] - walls[1][0] - pushed).abs() < 1e-12 * pushed, "{walls:?}: {pushed}");
        assert!((walls[0][1] - walls[1][1] + 12.0 * 0.3 / AREA).abs() < 1e-12);
    }
}

/// On several numbers of ranks, with lubricated pairs and walls, for both integrators.
#[test]
#[ignore = "heavy"]
fn any_ranks_find_the_same() {
    for method in ["time.integrator=\"implicit\"", "time.integrator=\"adams-bashforth\""] {
        let keys = [LUBRICATION[0], method, "time.steps=2"];
        let alone = at_end(&keys, 1);
        for ranks in [2, 3, 7] {
            let together = at_end(&keys, ranks);
            let error = difference(&together.velocities, &alone.velocities);
            assert!(error < 1e-7, "{method} on {ranks} ranks: {error:e}");
            assert!((together.gradient / alone.gradient - 1.0).abs() < 1e-8);
        }
    }
}

/// A run resumed half-way continues bit for bit, with its pressure gradient from the start.
#[test]
fn a_run_resumes_bit_for_bit() {
    for method in ["time.integrator=\"implicit\"", "time.integrator=\"adams-bashforth\""] {
        let model = model_of(SCENE, &[method, LUBRICATION[0], "time.steps=4"]);
        let mut straight = Suspension::start(&model, &Comm::alone()).unwrap();
        (0..2).for_each(|_| straight.step().unwrap());
        let mut resumed = Suspension::resume(&model, Some(straight.state()), &Comm::alone()).unwrap();
        for _ in 0..3 {
            assert_eq!(straight.pressure_gradient(), resumed.pressure_gradient());
            assert_eq!(straight.gathered(None), resumed.gathered(None));
            straight.step().unwrap();
            resumed.step().unwrap();
        }
        assert_ne!(straight.pressure_gradient(), Some(ALONE));
    }
}

/// The number of threads does not change a bit.
#[test]
fn any_threads_find_the_same_bits() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut suspension = Suspension::start(&model_of(SCENE, &LUBRICATION[..1]), &Comm::alone()).unwrap();
            let seen = seen(&mut suspension);
            (seen.gradient, seen.velocities)
        })
    };
    assert_eq!(on(1), on(3));
}

/// The pressure gradient is in the time series, and the summary has the mean of the samples.
#[test]
fn the_pressure_gradient_is_observed() {
    let model = model_of(SCENE, &["statistics={every=1}", "time.steps=3"]);
    let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    let mut seen = Vec::new();
    for step in 0..=3 {
        if step > 0 {
            run.advance(step).unwrap();
        }
        run.sample();
        let names: Vec<String> = run.quantities().iter().flat_map(Quantity::columns).collect();
        let row = run.observe().concat();
        assert_eq!(names.len(), row.len());
        let place = names.iter().position(|name| name == "pressure_gradient").expect("a column");
        assert_eq!(Some(row[place]), run.suspension().pressure_gradient());
        seen.push(row[place]);
    }
    let summary = run.averages().unwrap().tables.into_iter().find(|table| table.name == "summary").unwrap();
    let (_, values) = summary.rows.iter().find(|(words, _)| words[0] == "pressure_gradient").expect("a row");
    let mean = seen.iter().sum::<f64>() / 4.0;
    assert!((values[0] / mean - 1.0).abs() < 1e-14, "{} is not {mean}", values[0]);
    assert!((seen[3] - seen[0]).abs() > 1e-9 * mean, "it changes: {seen:?}");
    let given = model_of(SCENE, &[&driven_by(0.3)]);
    let names = SuspensionRun::start(&given, None, &Comm::alone()).unwrap().quantities();
    assert!(names.iter().all(|quantity| quantity.name != "pressure_gradient"), "where it is given it is no column");
}
