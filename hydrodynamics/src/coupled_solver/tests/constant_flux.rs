//! Spheres between walls at a given flux.

use super::*;
use crate::ambient::Poiseuille;
use crate::ambient::StrainRate;
use crate::pairs::search::{NearPairs, Pairs};
use crate::springs::TetherResistance;
use domain::Boundaries;
use domain::parallel::RowLists;
use lubrication::PairKind;

const HEIGHT: f64 = 9.0;

/// Three spheres near each other and near the walls, in the given unit of length.
fn between_walls(unit: f64) -> (Plan, Particles) {
    let edges = Vector::new(10.0, 9.0, HEIGHT) * unit;
    let radii = [1.0, 1.4, 1.4].map(|a| a * unit);
    let (volume, shortest_vector) = (edges.element_product(), edges.min_element());
    let usual = problem(unit, &radii, 1e-3, 1e-9);
    let problem = Problem { edges, volume, shortest_vector, boundaries: Boundaries::Walls, ..usual };
    let places = [Vector::new(3.0, 3.0, 1.02), Vector::new(5.2, 3.4, 1.9), Vector::new(5.0, 5.0, HEIGHT - 1.45)];
    (Plan::choose(&problem).unwrap(), placed(&places.map(|place| place * unit), &radii))
}

fn fluid(plan: &Plan, short_range: ShortRange) -> CoupledSolver {
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    CoupledSolver::new(plan, &partition, short_range).unwrap()
}

/// Whether a symmetric matrix is positive definite, by Cholesky factorisation.
fn is_positive(matrix: &[Vec<f64>]) -> bool {
    let n = matrix.len();
    let mut factor = vec![vec![0.0_f64; n]; n];
    (0..n).all(|i| {
        for j in 0..i {
            let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            factor[i][j] = (matrix[i][j] - sum) / factor[j][j];
        }
        let left = matrix[i][i] - factor[i].iter().map(|x| x * x).sum::<f64>();
        factor[i][i] = left.sqrt();
        left > 1e-3 * matrix[i][i]
    })
}

/// The mobility matrix from forces and torques to motions, with and without lubrication: it is symmetric, positive
/// definite, and smaller by a matrix of rank one than the mobility at a given pressure gradient.
#[test]
fn the_mobility_is_symmetric_positive_and_less_by_one_flow() {
    for lubrication in [None, Some(LubricationRange::default())] {
        let (plan, particles) = between_walls(1.0);
        let mut fluid = fluid(&plan, lubricated_at(lubrication));
        let mut matrix = |constant_flux: bool| -> Vec<Vec<f64>> {
            let mut column = |k: usize| {
                let mut loads = [[Vector::ZERO; 3]; 2];
                loads[k % 6 / 3][k / 6][k % 3] = 1.0;
                let loads = Loads { forces: loads[0].to_vec(), torques: loads[1].to_vec(), ..Loads::default() };
                let acting = SolveInput { constant_flux, ..acting(&loads, Traceless::ZERO) };
                let motion = fluid.solve(&plan.cell(), &particles, &acting, Guess::default()).unwrap().motion;
                let of = |l: usize| if l % 6 / 3 == 0 { &motion.velocities } else { &motion.angular_velocities };
                (0..18).map(|l| of(l)[l / 6][l % 3]).collect::<Vec<f64>>()
            };
            (0..18).map(&mut column).collect()
        };
        let [open, kept] = [false, true].map(&mut matrix);
        let size = |k: usize, l: usize| (open[k][k] * open[l][l]).sqrt();
        let pairs = || (0..18).flat_map(|k| (0..18).map(move |l| (k, l)));
        let asymmetry = pairs().map(|(k, l)| (kept[k][l] - kept[l][k]).abs() / size(k, l)).fold(0.0, f64::max);
        assert!(asymmetry < 1e-6, "{lubrication:?}: {asymmetry:e}");
        assert!(is_positive(&kept), "{lubrication:?}");
        // Rank one: d_kl d_mm = d_km d_lm for the difference d, with m the force along x on the sphere farthest from
        // both walls.
        let less = |k: usize, l: usize| open[k][l] - kept[k][l];
        let m = 6;
        assert!(less(m, m) > 0.02 * open[m][m], "{}", less(m, m) / open[m][m]);
        for (k, l) in pairs() {
            let error = less(k, l) - less(k, m) * less(l, m) / less(m, m);
            assert!(error.abs() < 1e-6 * size(k, l), "{lubrication:?}: {k}, {l}: {error:e}");
        }
    }
}

/// Spheres move alike if the resulting curvature is given as that of a pressure gradient. Springs resist absolute
/// motions, so their loads change by their resistance to the flow. In any units.
#[test]
fn a_curvature_that_is_given_moves_spheres_alike() {
    for (unit, lubrication) in
        [(1.0, None), (1.0, Some(LubricationRange::default())), (1e-5, Some(LubricationRange::default()))]
    {
        let (plan, particles) = between_walls(unit);
        let reach = 3.5 * unit;
        let mut fluid = fluid(&plan, ShortRange { lubrication, springs: Some(reach) });
        let stiffness = |distance: f64, between: PairKind| match between {
            PairKind::Spheres(_) => unit * 40.0 * (1.0 - distance / reach).max(0.0),
            PairKind::Wall(radius) => unit * 30.0 * (1.0 - distance / (1.2 * radius)).max(0.0),
        };
        let tethers = TetherResistance::default();
        let springs = Springs { resistance: &stiffness, contacts: &RowLists::default(), tethers: &tethers };
        let forces: Vec<Vector> = (0..3).map(|i| unit * unit * Vector::new(3.0, -0.5 * f64::from(i), 0.3)).collect();
        let loads = Loads { forces, ..Loads::default() };
        // Flow of the fluid alone.
        let background = Poiseuille { curvature: 0.4 / unit, height: HEIGHT * unit };
        let mut solve = |loads: &Loads, flow: Poiseuille, constant_flux: bool| {
            let strain_rate = flow.strain_rate();
            let springs = Some(&springs);
            let acting = SolveInput { springs, constant_flux, ..SolveInput::new(loads, strain_rate) };
            fluid.solve(&plan.cell(), &particles, &acting, Guess::default()).unwrap()
        };
        let kept = solve(&loads, background, true);
        assert!(kept.curvature.abs() > 0.02 * background.curvature, "{}", kept.curvature);
        let besides = Poiseuille { curvature: kept.curvature, ..background };
        let whole = Poiseuille { curvature: background.curvature + kept.curvature, ..background };
        let flow = besides.motion(&particles, Multipoles::Dipole);
        let resisted = against(&springs, &particles, &plan, reach, &flow);
        let pushed = Loads {
            forces: loads.forces.iter().zip(&resisted).map(|(&force, &resisted)| force - resisted).collect(),
            ..Loads::default()
        };
        let given = solve(&pushed, whole, false);
        for row in 0..3 {
            let velocity = given.motion.velocities[row] + flow.velocities[row];
            let spin = given.motion.angular_velocities[row] + flow.angular_velocities[row];
            let error = (kept.motion.velocities[row] - velocity).length() / unit
                + (kept.motion.angular_velocities[row] - spin).length();
            assert!(error < 1e-6, "unit {unit}, {lubrication:?}, sphere {row}: {error:e}");
            let (found, expected) = (kept.stresslets[row], given.stresslets[row]);
            let difference = found - expected;
            assert!(difference.contract(difference) < 1e-10 * expected.contract(expected), "{found:?} {expected:?}");
            let more = kept.far.forces[row] - given.far.forces[row];
            assert!(more.length() < 1e-5 * unit * unit, "what the fluid feels: {more}");
        }
    }
}

/// Forces of the springs alone in a motion.
fn against(springs: &Springs, particles: &Particles, plan: &Plan, reach: f64, motion: &Motion) -> Vec<Vector> {
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut without = fluid(plan, ShortRange { lubrication: None, springs: Some(reach) });
    let field = without.near.as_mut().unwrap();
    let units = without.units;
    let own = crate::units::particles(particles, &units);
    let resistance = crate::units::resistance(springs, &units);
    let springs = Springs { resistance: &resistance, contacts: &RowLists::default(), tethers: springs.tethers };
    let view = DomainView { cell: &plan.cell().scaled(1.0 / units.length), partition: &partition };
    let near = NearPairs::find(
        field,
        Connections { springs: Some(&springs), ..Connections::default() },
        &own,
        view,
        StrainRate::default(),
    );
    let motion = crate::units::motion(motion, &units);
    let motions = SixVectors::new(particles.len(), &motion.velocities, &motion.angular_velocities);
    near.times(&[Pairs::Stiff, Pairs::Soft], &motions).linear()
}
