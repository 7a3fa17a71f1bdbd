//! Sums and motions of bodies on any number of ranks.

use super::*;

/// Spheres of three bodies, one of them with the number 7, and a free sphere; `row` numbers all of them.
fn sphere(row: usize) -> (Option<u32>, Vector) {
    let body = [Some(2), None, Some(0), Some(7), Some(2), Some(7), Some(2)][row];
    (body, Vector::new(row as f64, 1.0 - row as f64, 0.25 * (row * row) as f64))
}

const SPHERES: usize = 7;

/// Bodies of the spheres that a rank holds: each rank has every third one or so.
fn on_rank(comm: &Comm) -> (RigidBodies, Vec<usize>) {
    let rows: Vec<usize> = (0..SPHERES).filter(|row| row % comm.size() == comm.rank()).collect();
    let (bodies, arms): (Vec<_>, Vec<_>) = rows.iter().map(|&row| sphere(row)).unzip();
    (RigidBodies::new(comm, &bodies, &arms), rows)
}

fn load(row: usize) -> [Vector; 2] {
    let x = row as f64;
    [Vector::new(1.0 + x, -2.0, 0.5 * x), Vector::new(-x, 3.0, 1.0)]
}

#[test]
fn forces_and_torques_add_up_on_any_ranks() {
    for ranks in [1, 2, 3, 7, 8] {
        Comm::threads(ranks, |comm| {
            let (bodies, rows) = on_rank(&comm);
            let forces = rows.iter().map(|&row| load(row)[0]).collect();
            let torques = rows.iter().map(|&row| load(row)[1]).collect();
            let totals = bodies.total_loads(&Loads { forces, torques, stresslets: Vec::new() });
            for (place, &number) in bodies.numbers().iter().enumerate() {
                let members = (0..SPHERES).filter(|&row| sphere(row).0 == Some(number));
                let expected = members.fold([Vector::ZERO; 2], |[force, torque], row| {
                    let [f, t] = load(row);
                    [force + f, torque + t + sphere(row).1.cross(f)]
                });
                let found = [totals.forces[place], totals.torques[place]];
                let is_near = |k: usize| (found[k] - expected[k]).length() < 1e-13 * expected[k].length();
                assert!(is_near(0) && is_near(1), "{ranks} ranks, body {number}: {found:?}, {expected:?}");
            }
        });
    }
}

#[test]
fn motions_of_spheres_give_those_of_their_bodies_on_any_ranks() {
    for ranks in [1, 2, 3, 8] {
        Comm::threads(ranks, |comm| {
            let (bodies, rows) = on_rank(&comm);
            let [velocities, angular_velocities] =
                [0, 1].map(|k| bodies.numbers().iter().map(|&n| load(n as usize)[k]).collect());
            let given = Motion { velocities, angular_velocities, strain_rates: Vec::new() };
            let of_spheres = bodies.sphere_motions(&given);
            for (place, &row) in rows.iter().enumerate() {
                let expected = sphere(row).0.map_or(Vector::ZERO, |n| {
                    let [velocity, angular] = load(n as usize);
                    velocity + angular.cross(sphere(row).1)
                });
                assert!((of_spheres.velocities[place] - expected).length() < 1e-13, "sphere {row}");
            }
            let back = bodies.body_motions(&of_spheres);
            let apart =
                |a: &[Vector], b: &[Vector]| a.iter().zip(b).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
            assert!(apart(&back.velocities, &given.velocities) < 1e-13);
            assert!(apart(&back.angular_velocities, &given.angular_velocities) < 1e-13);
        });
    }
}

/// Bodies that no ranks share need no messages.
#[test]
fn bodies_on_single_ranks_send_nothing() {
    Comm::threads(3, |comm| {
        let bodies = RigidBodies::new(&comm, &[Some(comm.rank() as u32); 2], &[Vector::X, -Vector::X]);
        let before = comm.messages_sent();
        let totals = bodies.total_loads(&Loads { forces: vec![Vector::Y; 2], ..Loads::default() });
        assert_eq!((totals.forces, comm.messages_sent()), (vec![2.0 * Vector::Y], before));
    });
}
