//! The fluid's velocity on a grid, for pictures.

use bytemuck::cast_slice;
use domain::{Comm, Particles, Partition, PeriodicBox, Vector};
use fcm::{Evaluation, Loads, Mobility, Plan};

/// The velocity of the fluid relative to the background flow, on all grid points in the order `[z][y][x]`, x fastest;
/// on the first rank. The plan is of a grid that carries every particle's own envelopes, whatever way the particles'
/// motions are found: [`Plan::on_the_grid_alone`]. Collective.
pub fn velocity(
    plan: &Plan,
    cell: &PeriodicBox,
    (particles, loads): (&Particles, &Loads),
    comm: &Comm,
) -> ([usize; 3], Vec<Vector>) {
    let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
    let (particles, loads) = moved(particles, loads, (&partition, cell));
    let mut mobility = Mobility::new(plan, &partition);
    mobility.arrange(cell, &particles);
    mobility.apply(&loads, Evaluation::Velocities);
    (plan.grid, gather(&partition, plan.grid, &mobility.velocity_field()))
}

/// The particles on the ranks of another partition, and their loads.
fn moved(particles: &Particles, loads: &Loads, (partition, cell): (&Partition, &PeriodicBox)) -> (Particles, Loads) {
    let lists: [(&str, usize, &[f64]); 3] = [
        ("force", 3, cast_slice(&loads.forces)),
        ("torque", 3, cast_slice(&loads.torques)),
        ("stresslet", 5, cast_slice(&loads.stresslets)),
    ];
    let mut moved = particles.without_columns();
    for (name, width, values) in lists {
        moved.column(name, width).values[..values.len()].copy_from_slice(values);
    }
    moved.migrate(partition, cell);
    let [forces, torques, stresslets] =
        lists.map(|(name, width, _)| std::mem::take(&mut moved.column(name, width).values));
    let loads = Loads {
        forces: cast_slice(&forces).to_vec(),
        torques: cast_slice(&torques).to_vec(),
        stresslets: cast_slice(&stresslets).to_vec(),
    };
    (moved.without_columns(), loads)
}

/// Brings the ranks' shares of a field, `[component][z][y][x]`, together on the first rank.
fn gather(partition: &Partition, [nx, ny, nz]: [usize; 3], share: &[f64]) -> Vec<Vector> {
    let all = partition.comm().gather(share);
    if all.is_empty() {
        return Vec::new();
    }
    let mut field = vec![Vector::ZERO; nx * ny * nz];
    let mut rest = all.iter();
    for rank in 0..partition.comm().size() {
        let [lines_y, lines_z] = partition.owned_by(rank);
        for component in 0..3 {
            for (z, y) in lines_z.clone().flat_map(|z| lines_y.clone().map(move |y| (z, y))) {
                for (point, value) in field[(z * ny + y) * nx..].iter_mut().take(nx).zip(rest.by_ref()) {
                    point[component] = *value;
                }
            }
        }
    }
    field
}
