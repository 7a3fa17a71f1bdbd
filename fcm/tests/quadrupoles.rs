//! Degenerate quadrupoles of swimming spheres against sums over wavevectors and exact flows.

use crate::common::{Suspension, at_surfaces, difference, on_ranks, worst};
use domain::{Boundaries, Partition, PeriodicBox, Random, Vector};
use fcm::{Envelope, Fixed, Loading, Loads, Method, Mobility, Motion, Plan, Precision, Problem};
use std::f64::consts::PI;

/// Quadrupoles of spheres that swim with velocities of about 1.
fn quadrupoles(suspension: &Suspension, seed: u64) -> Vec<Vector> {
    let mut random = Random::new(seed, 0x5715);
    let mut axis = || random.point() - Vector::splat(0.5);
    suspension.radii.iter().map(|a| axis() * (4.0 / 3.0 * PI * suspension.viscosity * a.powi(3))).collect()
}

fn by(suspension: &Suspension, plan: &Plan, quadrupoles: &[Vector]) -> Motion {
    suspension.mobility(plan).apply_with_quadrupoles(&Loads::default(), quadrupoles)
}

fn fixed(method: Method) -> Fixed {
    Fixed { method: Some(method), ..Fixed::default() }
}

/// A quadrupole moves its sphere in a cubic box with the velocity in unbounded fluid plus the mean of the flow that
/// a box has not, `2/3 H/(mu V)`: the sphere swims with `1 - phi` of its velocity. Envelopes of images overlap by
/// `exp(-pi (L/2a)^2)`; forces of `H/e` lose two digits.
#[test]
fn a_sphere_in_a_cubic_box_loses_the_volume_fraction() {
    for edge in [6.5, 9.0, 13.0] {
        let single = Suspension::single(edge);
        let quadrupole = vec![Vector::new(0.48, -0.6, 0.64)];
        let envelope = Envelope::of_sphere(1.0);
        let own = envelope.quadrupole().own_mobility(envelope.monopole) + 2.0 / (3.0 * edge.powi(3));
        let exact = quadrupole[0] * (own / single.viscosity);
        let by = |method| by(&single, &single.plan(1e-12, fixed(method)), &quadrupole);
        let sum = single.quadrupole_motion(&quadrupole);
        for motion in [by(Method::Direct), by(Method::Split), by(Method::Dense), sum] {
            let error = (motion.velocities[0] - exact).length() / exact.length();
            assert!(error < 1e-10, "L = {edge} a: error {error:e}");
            assert!(motion.angular_velocities[0].length() < 1e-11);
        }
    }
}

/// Radii of 1 and 1.8 in orthogonal and sheared boxes.
fn suspensions() -> [Suspension; 2] {
    let edges = Vector::new(9.0, 10.0, 8.0);
    let [cell, sheared] = [0.0, 0.3].map(|strain| PeriodicBox::sheared(edges, strain).unwrap());
    [Suspension::random(8, 1.8, cell, 5), Suspension::random(8, 1.8, sheared, 6)]
}

#[test]
fn methods_agree_with_the_sum_over_wavevectors() {
    for suspension in suspensions() {
        let quadrupoles = quadrupoles(&suspension, 3);
        let exact = suspension.quadrupole_motion(&quadrupoles);
        for method in Method::ALL {
            let found = by(&suspension, &suspension.plan(1e-11, fixed(method)), &quadrupoles);
            let error = worst(&found, &exact);
            assert!(error < 1e-9, "{} in {:?}: {error:e}", method.name(), suspension.cell);
        }
    }
}

/// The velocity field of loads and quadrupoles is the sum of both, and that of quadrupoles is the sum over wavevectors
/// of their two Gaussians `H/e` and `-H/e`.
#[test]
fn velocity_fields_have_quadrupoles() {
    let suspension = Suspension::random(3, 1.4, PeriodicBox::new(Vector::new(9.0, 10.0, 8.0)).unwrap(), 5);
    let (quadrupoles, loads) = (quadrupoles(&suspension, 6), suspension.loads(2));
    let plan = suspension.plan(1e-9, fixed(Method::Direct));
    let mut mobility = suspension.mobility(&plan);
    let of_loads = mobility.velocity_field_of(&loads, None);
    let of_both = mobility.velocity_field_of(&loads, Some(&quadrupoles));
    let [nx, ny, nz] = plan.grid;
    let edges = suspension.cell.edges();
    for [i, j, k] in [[0, 0, 0], [nx / 3, ny / 2, 1], [nx - 1, 2, nz / 2]] {
        let at = edges * Vector::new(i as f64 / nx as f64, j as f64 / ny as f64, k as f64 / nz as f64);
        let exact = field_at(&suspension, &quadrupoles, at);
        for component in 0..3 {
            let place = ((component * nz + k) * ny + j) * nx + i;
            let found = of_both[place] - of_loads[place];
            assert!((found - exact[component]).abs() < 1e-7, "{at}: {found}, not {exact}");
        }
    }
}

/// Velocity at a point by quadrupoles, from the sum over wavevectors.
fn field_at(suspension: &Suspension, quadrupoles: &[Vector], at: Vector) -> Vector {
    let (edges, most) = (suspension.cell.edges(), 20_i32);
    let mut sum = Vector::ZERO;
    for (row, &h) in quadrupoles.iter().enumerate() {
        let x = at - suspension.positions[row];
        let quadrupole = Envelope::of_sphere(suspension.radii[row]).quadrupole();
        for (a, b, c) in (-most..=most)
            .flat_map(|a| (-most..=most).map(move |b| (a, b)))
            .flat_map(|(a, b)| (-most..=most).map(move |c| (a, b, c)))
        {
            let k = 2.0 * PI * Vector::new(f64::from(a), f64::from(b), f64::from(c)) / edges;
            let square = k.length_squared();
            if square > 0.0 {
                let [wide, narrow] = quadrupole.variances.map(|variance| (-0.5 * variance * square).exp());
                let force = h * (quadrupole.weight * (wide - narrow));
                let across = force - k * (k.dot(force) / square);
                sum += across * ((k.dot(x)).cos() / square);
            }
        }
    }
    sum / (suspension.viscosity * edges.element_product())
}

/// With loads besides, in one evaluation, motions are the sums over wavevectors of both.
#[test]
fn loads_and_quadrupoles_add_up() {
    for suspension in suspensions() {
        let (quadrupoles, loads) = (quadrupoles(&suspension, 6), suspension.loads(2));
        let mut exact = suspension.motion(&loads);
        exact.add(1.0, &suspension.quadrupole_motion(&quadrupoles));
        for method in Method::ALL {
            let plan = suspension.plan(1e-11, fixed(method));
            let found = suspension.mobility(&plan).apply_with_quadrupoles(&loads, &quadrupoles);
            let error = worst(&found, &exact);
            assert!(error < 1e-9, "{} in {:?}: {error:e}", method.name(), suspension.cell);
        }
    }
}

/// Errors of motions at the surfaces, over the velocities with which spheres swim by quadrupoles, `-H/(2 pi mu
/// a^3)`.
#[test]
fn errors_stay_below_the_tolerance_of_the_plan() {
    for suspension in suspensions() {
        let quadrupoles = quadrupoles(&suspension, 4);
        let exact = suspension.quadrupole_motion(&quadrupoles);
        let swum = |(h, a): (&Vector, &f64)| (*h / (2.0 * PI * suspension.viscosity * a.powi(3))).length_squared();
        let scale = quadrupoles.iter().zip(&suspension.radii).map(swum).sum::<f64>().sqrt();
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
            let problem = Problem { rigid: true, ..suspension.problem(tolerance) };
            let plan = Plan::choose(&problem).unwrap();
            let found = by(&suspension, &plan, &quadrupoles);
            let errors = at_surfaces(&suspension, &difference(&found, &exact)).map(|error| error / scale);
            println!("{tolerance:e}: {errors:?}");
            assert!(errors.iter().all(|&error| error < tolerance), "{tolerance:e}: {errors:?}");
        }
    }
}

/// Errors of a sphere alone do not average out over positions; they are largest at points of the grid.
#[test]
fn a_sphere_alone_in_open_space_keeps_the_tolerance_wherever_it_is() {
    let h = Vector::new(0.48, -0.6, 0.64);
    let envelope = Envelope::of_sphere(1.0);
    let own = h * envelope.quadrupole().own_mobility(envelope.monopole);
    for (tolerance, edge) in [1e-2, 1e-3, 1e-4, 1e-5].into_iter().flat_map(|t| [2.1, 2.6, 4.0].map(|edge| (t, edge))) {
        let cell = PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(Boundaries::Open).unwrap();
        let centre = Suspension { cell, viscosity: 1.0, positions: vec![Vector::splat(0.5 * edge)], radii: vec![1.0] };
        let problem = Problem { rigid: true, loading: Loading::Swimming, ..centre.problem(tolerance) };
        let plan = Plan::choose(&problem).unwrap();
        let spacing = plan.period / Vector::from_array(plan.grid.map(|points| points as f64));
        for place in [0.0, 0.25, 0.5].map(|part| spacing * part) {
            let found = by(&centre.displaced(place), &plan, &[h]).velocities[0];
            let error = (found - own).length() / own.length();
            assert!(error < tolerance, "{tolerance:e} in a box of {edge} at {place}: {error:e}");
        }
    }
}

/// Squirmers of radius 1, of which some are at walls, with quadrupoles.
fn at_walls(boundaries: Boundaries) -> (Suspension, Vec<Vector>) {
    let cell = PeriodicBox::new(Vector::new(10.0, 9.0, 7.0)).unwrap().with_boundaries(boundaries).unwrap();
    let positions = [[2.0, 3.0, 1.02], [5.0, 4.0, 1.3], [7.0, 7.5, 5.9], [4.5, 6.6, 3.4], [1.2, 6.4, 2.5]];
    let positions = positions.map(Vector::from_array).to_vec();
    let suspension = Suspension { cell, viscosity: 1.3, radii: vec![1.0; positions.len()], positions };
    let quadrupoles = quadrupoles(&suspension, 8);
    (suspension, quadrupoles)
}

/// At walls, quadrupoles move spheres as forces `H/e` and `-H/e` of spheres with the two Gaussians do, next to them by
/// a small distance; forces of `H/e` lose two digits.
#[test]
fn quadrupoles_at_walls_are_forces_of_two_gaussians() {
    for boundaries in [Boundaries::Wall, Boundaries::Walls] {
        let (suspension, quadrupoles) = at_walls(boundaries);
        let found = by(&suspension, &suspension.plan(1e-8, Fixed::default()), &quadrupoles);
        let gaussians = Envelope::of_sphere(1.0).quadrupole();
        let count = suspension.radii.len();
        let mut all = suspension.clone();
        let mut loads = Loads { forces: vec![Vector::ZERO; count], ..Loads::default() };
        for (&x, &h) in suspension.positions.iter().zip(&quadrupoles) {
            for (variance, sign) in gaussians.variances.into_iter().zip([1.0, -1.0]) {
                all.positions.push(x + Vector::new(1e-7, 0.0, 0.0));
                all.radii.push((variance * PI).sqrt());
                loads.forces.push(h * (sign * gaussians.weight));
            }
        }
        let mut exact = all.evaluate(&all.plan(1e-8, Fixed::default()), &loads);
        exact.velocities.truncate(count);
        exact.angular_velocities.truncate(count);
        exact.strain_rates.truncate(count);
        let error = worst(&found, &exact);
        assert!(error < 1e-5, "{boundaries:?}: {error:e}");
    }
}

/// The same bound of errors between walls and above one.
#[test]
fn errors_at_walls_stay_below_the_tolerance_of_the_plan() {
    for boundaries in [Boundaries::Wall, Boundaries::Walls] {
        let (suspension, quadrupoles) = at_walls(boundaries);
        let exact = by(&suspension, &suspension.plan(1e-9, Fixed::default()), &quadrupoles);
        let swum = |h: &Vector| (*h / (2.0 * PI * suspension.viscosity)).length_squared();
        let scale = quadrupoles.iter().map(swum).sum::<f64>().sqrt();
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let problem = Problem { rigid: true, loading: Loading::Swimming, ..suspension.problem(tolerance) };
            let found = by(&suspension, &Plan::choose(&problem).unwrap(), &quadrupoles);
            let errors = at_surfaces(&suspension, &difference(&found, &exact)).map(|error| error / scale);
            println!("{boundaries:?} {tolerance:e}: {errors:?}");
            assert!(errors.iter().all(|&error| error < tolerance), "{boundaries:?} {tolerance:e}: {errors:?}");
        }
    }
}

/// In a box with three slanted lattice vectors, the split method against exact sums.
#[test]
fn boxes_may_be_tilted() {
    let vectors = [Vector::new(9.0, 0.5, -0.4), Vector::new(1.0, 8.5, 0.6), Vector::new(-0.8, 0.9, 8.0)];
    let suspension = Suspension::random(6, 1.5, PeriodicBox::of_lattice(vectors).unwrap(), 9);
    let quadrupoles = quadrupoles(&suspension, 2);
    let [split, dense] = [Method::Split, Method::Dense]
        .map(|method| by(&suspension, &suspension.plan(1e-9, fixed(method)), &quadrupoles));
    let error = worst(&split, &dense);
    assert!(error < 1e-8, "{error:e}");
}

/// Far apart in open space, the flow is `-(3 r r/r^2 - I).H / (4 pi mu r^3)` and its gradient; the sphere itself moves
/// with its own velocity. Gaussians at a distance of 9 have decayed to `exp(-9^2/(2 s^2))` with `s` about 1.
#[test]
fn the_flow_in_open_space_is_that_of_a_point_quadrupole() {
    let cell = PeriodicBox::new(Vector::splat(24.0)).unwrap().with_boundaries(Boundaries::Open).unwrap();
    let (near, x) = (Vector::new(6.0, 7.0, 8.0), Vector::new(8.0, 6.0, 5.0));
    let suspension = Suspension { cell, viscosity: 0.7, positions: vec![near, near + x], radii: vec![1.0, 1.5] };
    let h = Vector::new(0.3, -1.1, 0.8);
    let motion = by(&suspension, &suspension.plan(1e-8, Fixed::default()), &[h, Vector::ZERO]);
    let flow = |x: Vector| {
        let square = x.length_squared();
        (h - x * (3.0 * x.dot(h) / square)) / (4.0 * PI * 0.7 * square.powf(1.5))
    };
    let error = (motion.velocities[1] - flow(x)).length() / flow(x).length();
    assert!(error < 1e-6, "velocity: {error:e}");
    let slope = |axis: Vector| (flow(x + axis * 1e-3) - flow(x - axis * 1e-3)) / 2e-3;
    let (xy, yx) = (slope(Vector::Y).x, slope(Vector::X).y);
    let rate = slope(Vector::Z).z.abs();
    assert!((motion.strain_rates[1].0[1] - 0.5 * (xy + yx)).abs() < 1e-5 * rate);
    assert!((motion.angular_velocities[1].z - 0.5 * (yx - xy)).abs() < 1e-5 * rate);
    let envelope = Envelope::of_sphere(1.0);
    let own = h * (envelope.quadrupole().own_mobility(envelope.monopole) / 0.7);
    assert!((motion.velocities[0] - own).length() < 1e-7 * own.length());
}

/// In units of length, viscosity and force that differ by powers of two, bits are the same; the precision is single,
/// which other units would take out of range.
#[test]
fn other_units_give_the_same_bits() {
    let [suspension, _] = suspensions();
    let quadrupoles = quadrupoles(&suspension, 7);
    let single = Fixed { precision: Some(Precision::Single), ..Fixed::default() };
    for method in [Method::Direct, Method::Split, Method::Dense] {
        let fixed = Fixed { method: Some(method), ..single };
        let fixed = if method == Method::Dense { Fixed { precision: None, ..fixed } } else { fixed };
        let one = by(&suspension, &suspension.plan(1e-3, fixed), &quadrupoles);
        for [length, viscosity, force] in [[60, -40, 9], [-50, 30, 90]].map(|all| all.map(|k| 2.0_f64.powi(k))) {
            let other = Suspension {
                cell: suspension.cell.scaled(length),
                viscosity: suspension.viscosity * viscosity,
                positions: suspension.positions.iter().map(|&x| x * length).collect(),
                radii: suspension.radii.iter().map(|a| a * length).collect(),
            };
            let scaled: Vec<Vector> = quadrupoles.iter().map(|&h| h * (force * length * length)).collect();
            let found = by(&other, &other.plan(1e-3, fixed), &scaled);
            let velocity = force / (viscosity * length);
            for (a, b) in found.velocities.iter().zip(&one.velocities) {
                assert_eq!(*a, *b * velocity, "{}", method.name());
            }
            for (a, b) in found.strain_rates.iter().zip(&one.strain_rates) {
                assert_eq!(*a, *b * (velocity / length), "{}", method.name());
            }
        }
    }
}

/// Round-off of sums in another order, with forces of `H/e` at each quadrupole. With one sphere in a
/// large box, some ranks have no quadrupole and are reached by none.
#[test]
fn ranks_agree() {
    let [suspension, _] = suspensions();
    for suspension in [suspension, Suspension::single(40.0)] {
        let loads = Loads { forces: quadrupoles(&suspension, 8), ..Loads::default() };
        for method in Method::ALL {
            let plan = suspension.plan(1e-8, fixed(method));
            let alone = by(&suspension, &plan, &loads.forces);
            let answer = |partition: &Partition, particles: &_, loads: &Loads| {
                let mut mobility = Mobility::new(&plan, partition);
                mobility.arrange(&suspension.cell, particles);
                (mobility.apply_with_quadrupoles(&Loads::default(), &loads.forces), Vec::new())
            };
            let (found, _) = on_ranks(&suspension, &plan, [2, 2], &loads, answer);
            let size = |motion: &Motion| at_surfaces(&suspension, motion).into_iter().fold(0.0, f64::max);
            let error = size(&difference(&found, &alone)) / size(&alone);
            assert!(error < 1e-11, "{}: {error:e}", method.name());
        }
    }
}
