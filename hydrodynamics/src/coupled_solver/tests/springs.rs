//! Implicit springs of repulsion and contacts in the solve.

use super::*;
use crate::springs::{ContactSprings, TetherResistance};
use domain::parallel::RowLists;
use lubrication::PairKind;

/// The motions with contacts equal those without, under the forces and torques that the contact springs exert in these
/// motions: along the line of centres, against slip at the point of contact, and against rolling. In any units.
#[test]
fn contacts_push_and_turn_as_the_motions_say() {
    for unit in [1.0, 1e-6] {
        let (_, mut particles) = cluster();
        particles.positions.iter_mut().for_each(|x| *x *= unit);
        particles.radii.iter_mut().for_each(|a| *a *= unit);
        let plan = plan(22.0 * unit, &particles.radii, 1e-3, 1e-9);
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let strain = Traceless([0.0, 0.5, 0.0, 0.2, 0.0]);
        let count = particles.len();
        let vectors = |scale: f64| -> Vec<Vector> {
            (0..count).map(|i| scale * Vector::new(1.0, -0.5 * i as f64, 0.3)).collect()
        };
        let given = Loads { forces: vectors(unit * unit), torques: vectors(0.4 * unit.powi(3)), ..Loads::default() };
        let touch = |i: usize, j: usize| {
            let apart = plan.cell().nearest_image(particles.positions[j] - particles.positions[i]);
            (apart.length() < 3.5 * unit && i != j).then_some(apart)
        };
        let springs = |i: usize, j: usize| {
            let k = unit * (i + j + 2) as f64;
            ContactSprings {
                other: particles.ids[j],
                within: f64::INFINITY,
                normal: 3.0 * k,
                tangential: 5.0 * k,
                rolling: 2.0 * k,
            }
        };
        let contacts = RowLists::of_rows(count, |i, list| {
            list.extend((0..count).filter(|&j| touch(i, j).is_some()).map(|j| springs(i, j)));
        });
        assert!(contacts.items().len() >= 4, "some touch");
        let lubrication = Some(LubricationRange::new(2.5, 1e-6).unwrap());
        let mut fluid =
            CoupledSolver::new(&plan, &partition, ShortRange { lubrication, ..ShortRange::default() }).unwrap();
        let mut solve = |loads: &Loads, springs: Option<&Springs>| {
            let acting = SolveInput { springs, ..acting(loads, strain) };
            fluid.solve(&plan.cell(), &particles, &acting, Guess::default()).unwrap().motion
        };
        let sprung = solve(
            &given,
            Some(&Springs { resistance: &|_, _| 0.0, contacts: &contacts, tethers: &TetherResistance::default() }),
        );
        let mut pushed = given.clone();
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let Some(apart) = touch(i, j) else { continue };
            let (axis, spring, [a, b]) = (apart.normalize(), springs(i, j), [particles.radii[i], particles.radii[j]]);
            let arms = [a, b].map(|radius| apart.length() * radius / (a + b));
            let [own, other] = [i, j].map(|k| (sprung.velocities[k], sprung.angular_velocities[k]));
            let parting = axis.dot(other.0 - own.0);
            let slip = other.0 - own.0 - parting * axis - (arms[0] * own.1 + arms[1] * other.1).cross(axis);
            let harmonic = 2.0 * a * b / (a + b);
            let twist = axis.cross((other.1 - own.1).cross(axis));
            pushed.forces[i] += spring.normal * parting * axis + spring.tangential * slip;
            pushed.torques[i] +=
                arms[0] * axis.cross(spring.tangential * slip) + spring.rolling * harmonic * harmonic * twist;
        }
        let (plain, free) = (solve(&pushed, None), solve(&given, None));
        for i in 0..count {
            let error = (plain.velocities[i] - sprung.velocities[i]).length() / unit
                + (plain.angular_velocities[i] - sprung.angular_velocities[i]).length();
            assert!(error < 1e-4, "unit {unit}, sphere {i}: {error}");
        }
        let matters = (free.angular_velocities[0] - sprung.angular_velocities[0]).length();
        assert!(matters > 0.003, "{matters}");
    }
}

/// The motions with springs equal those without, under the forces that the springs exert in these motions; for pairs
/// within the range of lubrication or beyond, in any units.
#[test]
fn springs_push_as_the_motions_say() {
    for (unit, lubrication) in [(1.0, None), (1.0, Some(0.5)), (1e-6, Some(0.5))] {
        let lubrication = lubrication.map(|cutoff| LubricationRange::new(cutoff, 1e-6).unwrap());
        let (_, mut particles) = cluster();
        particles.positions.iter_mut().for_each(|x| *x *= unit);
        particles.radii.iter_mut().for_each(|a| *a *= unit);
        let plan = plan(22.0 * unit, &particles.radii, 1e-3, 1e-9);
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let (reach, strain) = (5.0 * unit, Traceless([0.0, 0.5, 0.0, 0.2, 0.0]));
        let forces: Vec<Vector> =
            (0..particles.len()).map(|i| unit * unit * Vector::new(1.0, -0.5 * i as f64, 0.3)).collect();
        let resistance = |distance: f64, radii: [f64; 2]| {
            let depth = (1.0 - distance / reach).max(0.0);
            1500.0 * depth * radii[0] * radii[1] / unit
        };
        let mut fluid =
            CoupledSolver::new(&plan, &partition, ShortRange { lubrication, springs: Some(reach) }).unwrap();
        let mut solve = |forces: &[Vector], springs: Option<&Springs>| {
            let loads = Loads { forces: forces.to_vec(), ..Loads::default() };
            let acting = SolveInput { springs, ..acting(&loads, strain) };
            fluid.solve(&plan.cell(), &particles, &acting, Guess::default()).unwrap()
        };
        let between = |distance: f64, between: PairKind| match between {
            PairKind::Spheres(radii) => resistance(distance, radii),
            PairKind::Wall(_) => 0.0,
        };
        let tethers = TetherResistance::default();
        let sprung =
            solve(&forces, Some(&Springs { resistance: &between, contacts: &RowLists::default(), tethers: &tethers }));
        let mut pushed = forces.clone();
        for i in 0..particles.len() {
            for j in (0..particles.len()).filter(|&j| j != i) {
                let apart = plan.cell().nearest_image(particles.positions[j] - particles.positions[i]);
                let (axis, distance) = (apart / apart.length(), apart.length());
                let opening = axis.dot(sprung.motion.velocities[j] - sprung.motion.velocities[i]);
                pushed[i] += axis * (resistance(distance, [particles.radii[i], particles.radii[j]]) * opening);
            }
        }
        let (plain, free) = (solve(&pushed, None), solve(&forces, None));
        for i in 0..particles.len() {
            let error = (plain.motion.velocities[i] - sprung.motion.velocities[i]).length() / unit;
            assert!(error < 1e-4, "unit {unit}, sphere {i}: {error}");
        }
        let matters = (free.motion.velocities[0] - sprung.motion.velocities[0]).length() / unit;
        assert!(matters > 0.02, "{matters}");
    }
}
