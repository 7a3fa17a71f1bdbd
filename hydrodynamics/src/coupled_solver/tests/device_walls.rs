//! Spheres at walls by the kernels of a card, which an emulator runs on the host, against the solve of the host.

use super::on_device::{Suspension, agree_in, columns, emulator, relative};
use super::*;
use crate::ambient::Poiseuille;
use crate::springs::{ContactSprings, TetherResistance};
use domain::Boundaries;
use gpu::Counted;

/// Spheres of two sizes between walls or above one, which the lowest of them almost touches.
pub(super) fn at_walls(boundaries: Boundaries, precision: Precision, iteration: f64) -> Suspension {
    let walls = |edge| PeriodicBox::new(Vector::splat(edge)).unwrap().with_boundaries(boundaries).unwrap();
    let mut suspension = Suspension::within(walls, precision, iteration);
    let lowest = lowest(&suspension);
    let Particles { positions, radii, .. } = &mut suspension.particles;
    positions[lowest].z = radii[lowest] * (1.0 + 1e-3);
    let to_lowest = |row: usize| suspension.cell.nearest_image(positions[row] - positions[lowest]).length();
    assert!((0..radii.len()).all(|row| row == lowest || to_lowest(row) > radii[row] + radii[lowest]));
    suspension
}

/// Row of the sphere that is nearest to the lower wall.
fn lowest(suspension: &Suspension) -> usize {
    let Particles { positions, radii, .. } = &suspension.particles;
    let gap = |row: usize| positions[row].z - radii[row];
    (0..radii.len()).min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap()
}

/// Strain rate of a flow by a pressure gradient, which also has a part along y.
pub(super) fn of_channel(suspension: &Suspension) -> StrainRate {
    let height = suspension.cell.edges().z / suspension.on_host().units.length;
    let StrainRate { at_zero, slope: [along_x, _] } = Poiseuille { curvature: 0.2, height }.strain_rate();
    StrainRate { at_zero: at_zero + Traceless([0.1, 0.0, 0.0, -0.2, 0.3]), slope: [along_x, 0.04] }
}

/// Solutions in a channel flow, then of spheres that settle in it, from the first as a guess.
fn in_channel(suspension: &Suspension, mut solver: CoupledSolver) -> [Solution; 2] {
    let Suspension { cell, particles, .. } = suspension;
    let (none, strain_rate) = (Loads::default(), of_channel(suspension));
    let first = solver.solve(cell, particles, &SolveInput::new(&none, strain_rate), Guess::default()).unwrap();
    let forces = particles.radii.iter().map(|a| Vector::new(0.3, 0.0, -a.powi(3))).collect();
    let loads = Loads { forces, ..Loads::default() };
    let guess = Guess { stresslets_far: first.far.stresslets.clone(), ..Guess::induced_by(&first.motion) };
    [first, solver.solve(cell, particles, &SolveInput::new(&loads, strain_rate), guess).unwrap()]
}

/// In shear, and settling in an ambient flow.
#[test]
fn solutions_between_walls_are_those_of_the_host() {
    let suspension = at_walls(Boundaries::Walls, Precision::Double, 1e-4);
    agree_in(&suspension, |solver| suspension.solutions(solver));
}

#[test]
fn solutions_in_a_channel_flow_are_those_of_the_host() {
    let suspension = at_walls(Boundaries::Walls, Precision::Single, 1e-4);
    agree_in(&suspension, |solver| in_channel(&suspension, solver));
}

/// Errors by kind over the tolerance, as root mean squares over tolerances and solutions. A single one may be several
/// times as large as another one, on the host as on the card: the residual is small in slow modes of the iteration,
/// which further steps reduce by chance, since solves of the preconditioner are not exact.
fn agree_on_average(boundaries: Boundaries, solutions: impl Fn(&Suspension, CoupledSolver) -> [Solution; 2]) {
    let cases =
        [(Precision::Double, 1e-6), (Precision::Double, 1e-5), (Precision::Double, 1e-4), (Precision::Single, 1e-4)];
    let mut squares = [[0.0; 2]; 6];
    for (precision, iteration) in cases {
        let suspension = at_walls(boundaries, precision, iteration);
        let fine = suspension.with_tolerance(1e-2 * iteration);
        let exact = solutions(&fine, fine.on_host());
        let [host, card] = [suspension.on_host(), suspension.on(emulator(11))].map(|on| solutions(&suspension, on));
        for ((host, card), exact) in host.iter().zip(&card).zip(&exact) {
            assert!(card.iterations > 3 && card.iterations <= host.iterations + 2, "{}", card.iterations);
            let exact = columns(exact);
            for (from, solution) in [host, card].into_iter().enumerate() {
                for (kind, (found, exact)) in columns(solution).iter().zip(&exact).enumerate() {
                    squares[kind][from] += (relative(found, exact) / iteration).powi(2) / (2 * cases.len()) as f64;
                }
            }
        }
    }
    for (kind, squares) in squares.into_iter().enumerate() {
        let [host, card] = squares.map(f64::sqrt);
        assert!(card < 2.0 * host.max(1.0), "{boundaries:?}, kind {kind}: {card} of the tolerance, host {host}");
    }
}

#[test]
#[ignore = "heavy"]
fn errors_between_walls_are_those_of_the_host() {
    agree_on_average(Boundaries::Walls, Suspension::solutions);
}

#[test]
#[ignore = "heavy"]
fn errors_in_a_channel_flow_are_those_of_the_host() {
    agree_on_average(Boundaries::Walls, in_channel);
}

#[test]
#[ignore = "heavy"]
fn errors_above_a_wall_are_those_of_the_host() {
    agree_on_average(Boundaries::Wall, Suspension::solutions);
}

/// Loads and first moments of spheres at rest in a channel flow: those of near pairs, which the card has, and those at
/// walls, which it is given. In a solution to a small tolerance, stresslets have the first moments by motions too.
#[test]
fn first_moments_are_those_of_the_host() {
    let suspension = at_walls(Boundaries::Walls, Precision::Double, 1e-9);
    let Suspension { cell, particles, .. } = &suspension;
    let none = Loads::default();
    let input = SolveInput::new(&none, of_channel(&suspension));
    let in_flow = |mut solver: CoupledSolver| {
        let own = crate::units::particles(particles, &solver.units);
        let near = solver.pairs_of_solve(cell, [particles, &own], &input);
        let on_card = solver.mobility().coupled().map(fcm::CoupledFarField::in_flow);
        assert_eq!(near.is_on_device(), on_card.is_some());
        let of_row = |row: usize| {
            let here = near.ambient_loads().0[row].0.into_iter().chain(near.ambient_moments()[row].0);
            let there = on_card.as_ref().map_or([0.0; 11], |list| list[row]);
            here.zip(there).map(|(here, there)| here + there).collect::<Vec<_>>()
        };
        (0..particles.len()).flat_map(of_row).collect::<Vec<_>>()
    };
    let [found, exact] = [suspension.on(emulator(8)), suspension.on_host()].map(in_flow);
    assert!(relative(&found, &exact) < 1e-11, "{:e}", relative(&found, &exact));
    let solutions = [suspension.on(emulator(9)), suspension.on_host()].map(|solver| in_channel(&suspension, solver));
    let [found, exact] = solutions.map(|solutions| solutions.map(|solution| columns(&solution)));
    for (found, exact) in found.iter().flatten().zip(exact.iter().flatten()) {
        assert!(relative(found, exact) < 1e-7, "{:e}", relative(found, exact));
    }
}

/// Springs of contacts with walls and with spheres, and traps.
#[test]
fn springs_at_walls_are_in_the_rows() {
    let suspension = at_walls(Boundaries::Walls, Precision::Double, 1e-7);
    let Suspension { cell, particles, .. } = &suspension;
    let resistance = |distance: f64, _: lubrication::PairKind| 3.0 * (2.5 - distance).max(0.0);
    let touching = |other| ContactSprings { other, within: f64::INFINITY, normal: 2.0, tangential: 5.0, rolling: 3.0 };
    let mut contacts = vec![Vec::new(); particles.len()];
    (contacts[0], contacts[1]) = (vec![touching(1)], vec![touching(0)]);
    contacts[lowest(&suspension)].push(touching(ContactSprings::wall(0)));
    let traps = particles.ids.iter().map(|id| 0.1 * (1 + id % 3) as f64).collect();
    let tethers = TetherResistance { traps, ..TetherResistance::default() };
    let springs = Springs { resistance: &resistance, contacts: &contacts.into_iter().collect(), tethers: &tethers };
    let none = Loads::default();
    let free = SolveInput::new(&none, of_channel(&suspension));
    let input = SolveInput { springs: Some(&springs), ..free };
    let solved = |mut solver: CoupledSolver, input| solver.solve(cell, particles, input, Guess::default()).unwrap();
    let [found, exact] = [suspension.on(emulator(4)), suspension.on_host()].map(|solver| solved(solver, &input));
    assert!(relative(&columns(&solved(suspension.on_host(), &free))[0], &columns(&exact)[0]) > 1e-2);
    for (found, exact) in columns(&found).iter().zip(&columns(&exact)) {
        assert!(relative(found, exact) < 3e-6, "{:e}", relative(found, exact));
    }
}

/// Shuffled threads and blocks.
#[test]
fn any_order_of_threads_gives_the_same_bits_at_walls() {
    let suspension = at_walls(Boundaries::Walls, Precision::Single, 1e-2);
    let [first, second] = [1, 2].map(|seed| in_channel(&suspension, suspension.on(emulator(seed))));
    assert_eq!(first, second);
}

/// Each iteration is an evaluation whose loads and motions stay on the card: more iterations copy a few numbers each.
#[test]
fn iterations_at_walls_stay_on_the_device() {
    let counted = |iteration| {
        let suspension = at_walls(Boundaries::Walls, Precision::Single, iteration);
        let (device, counts) = Counted::new(emulator(5));
        let none = Loads::default();
        let input = SolveInput::new(&none, of_channel(&suspension));
        let mut solver = suspension.on(Box::new(device));
        let solution = solver.solve(&suspension.cell, &suspension.particles, &input, Guess::default()).unwrap();
        let counts = counts.borrow().clone();
        assert_eq!(counts.runs["coupled_image_f32"], solution.iterations as u64 + 1);
        (solution.iterations, counts)
    };
    let [(rough, few), (fine, many)] = [1e-2, 1e-4].map(counted);
    assert!(fine > rough + 3, "{rough} {fine}");
    for (few, many) in [(few.uploads, many.uploads), (few.downloads, many.downloads)] {
        let [copies, bytes] = std::array::from_fn(|k| many[k] - few[k]);
        assert!(copies > 0 && bytes <= 13 * 8 * copies, "{copies} copies of {bytes} bytes");
    }
}
