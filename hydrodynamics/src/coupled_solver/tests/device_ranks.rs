//! Lubricated spheres on ranks with a device each, which an emulator runs on the host, against one rank of the host.

use super::on_device::{Suspension, emulator, lubricated, relative};
use super::*;

/// Positions after some steps in shear on some ranks, in the order of ids.
fn advanced(
    suspension: &Suspension,
    from: &Particles,
    [ranks, steps]: [usize; 2],
    solver: impl Fn(&Partition) -> CoupledSolver + Sync,
) -> Particles {
    let parts = Comm::threads(ranks, |comm| {
        let partition = Partition::new(&comm, [suspension.plan.grid[1], suspension.plan.grid[2]]);
        let rows: Vec<usize> = (0..from.len()).filter(|row| row % ranks == comm.rank()).collect();
        let (mut own, mut solver) = (from.selected(&rows), solver(&partition));
        let none = Loads::default();
        let shear = acting(&none, Traceless([0.0, 0.5, 0.0, 0.0, 0.0]));
        for _ in 0..steps {
            own.migrate(&partition, &suspension.cell);
            let found = solver.solve(&suspension.cell, &own, &shear, Guess::default()).unwrap();
            own.positions.iter_mut().zip(&found.motion.velocities).for_each(|(x, &v)| *x += 0.1 * v);
            own.wrap(&suspension.cell);
        }
        own.ids.into_iter().zip(own.positions).collect::<Vec<_>>()
    });
    let mut after = from.clone();
    for (id, position) in parts.into_iter().flatten() {
        after.positions[id as usize] = position;
    }
    after
}

/// Two steps on two ranks, with which one or three ranks go on for a third: displacements are those of the host.
#[test]
fn steps_on_ranks_are_those_of_the_host() {
    let sheared = |edge| PeriodicBox::sheared(Vector::splat(edge), 0.3).unwrap();
    let suspension = Suspension::of(12, sheared, Precision::Double, 1e-8);
    let start = &suspension.particles;
    let on_device = |partition: &Partition| {
        let mut solver = suspension.on_rank(emulator(partition.comm().rank() as u64), partition, lubricated());
        // Devices do not add up forces between the surfaces of their own spheres and those of others.
        assert_eq!(solver.take_surface_forces(&[]), partition.comm().size() == 1);
        solver
    };
    let advanced_on = |from, on| advanced(&suspension, from, on, on_device);
    let displacements = |particles: &Particles| -> Vec<f64> {
        let pairs = particles.positions.iter().zip(&start.positions);
        pairs.flat_map(|(&x, &y)| suspension.cell.nearest_image(x - y).to_array()).collect()
    };
    let exact = displacements(&advanced(&suspension, start, [1, 3], |_| suspension.on_host()));
    let two_steps = advanced_on(start, [2, 2]);
    for found in [1, 3].map(|ranks| advanced_on(&two_steps, [ranks, 1])) {
        let found = relative(&displacements(&found), &exact);
        assert!(found < 1e-6, "{found:e}");
    }
}
