//! Collected answers of several ranks.

use super::Suspension;
use domain::{Comm, Particles, Partition, Traceless, Vector};
use fcm::{Loads, Motion, Plan};

/// Distributes the particles and loads of a suspension over a table of ranks, calls `answer` on each for motions and
/// stresslets of the particles that it owns, and returns the answers in the order of the suspension.
pub fn on_ranks(
    suspension: &Suspension,
    plan: &Plan,
    table: [usize; 2],
    loads: &Loads,
    answer: impl Fn(&Partition, &Particles, &Loads) -> (Motion, Vec<Traceless>) + Sync,
) -> (Motion, Vec<Traceless>) {
    let parts = Comm::threads(table[0] * table[1], |comm| {
        let partition = Partition::with_table(&comm, [plan.grid[1], plan.grid[2]], table);
        let rows: Vec<usize> = (0..suspension.radii.len()).filter(|r| r % comm.size() == comm.rank()).collect();
        let mut particles = suspension.particles().selected(&rows);
        particles.migrate(&partition, &suspension.cell);
        let mine = Loads {
            forces: selected(&loads.forces, &particles.ids),
            torques: selected(&loads.torques, &particles.ids),
            stresslets: selected(&loads.stresslets, &particles.ids),
        };
        let (motion, stresslets) = answer(&partition, &particles, &mine);
        (particles.ids, motion, stresslets)
    });
    let count = suspension.radii.len();
    let mut all = Motion {
        velocities: vec![Vector::NAN; count],
        angular_velocities: vec![Vector::NAN; count],
        strain_rates: vec![Traceless::ZERO; count],
    };
    let mut stresslets = vec![Traceless::ZERO; count];
    for (ids, motion, part) in parts {
        place(&mut all.velocities, &ids, &motion.velocities);
        place(&mut all.angular_velocities, &ids, &motion.angular_velocities);
        place(&mut all.strain_rates, &ids, &motion.strain_rates);
        place(&mut stresslets, &ids, &part);
    }
    (all, stresslets)
}

fn selected<T: Copy>(values: &[T], ids: &[u64]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { ids.iter().map(|&id| values[id as usize]).collect() }
}

fn place<T: Copy>(all: &mut [T], ids: &[u64], part: &[T]) {
    for (&id, &value) in ids.iter().zip(part) {
        all[id as usize] = value;
    }
}
