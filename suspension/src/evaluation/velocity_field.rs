//! Velocity of the fluid on a grid, for plots.

use bytemuck::cast_slice;
use domain::{Boundaries, Comm, Particles, Partition, PeriodicBox, Vector};
use fcm::{Loads, Mobility, Output, Plan, SamplePoints};
use hydrodynamics::Poiseuille;

/// Velocity of the fluid at grid points, in the order `[z][y][x]`, x fastest; on the first rank.
#[derive(Debug, Clone, PartialEq)]
pub struct FluidVelocity {
    /// Grid points; in a sheared box they follow the lattice.
    pub raster: SamplePoints,
    /// Velocities.
    pub values: Vec<Vector>,
}

/// Spheres in a box, and the loads that they apply to the fluid.
pub struct LoadedSpheres<'a> {
    /// The box.
    pub cell: &'a PeriodicBox,
    /// This rank's spheres.
    pub particles: &'a Particles,
    /// Their loads.
    pub loads: &'a Loads,
}

/// Velocity of the fluid relative to the background flow, by a plan [`Plan::of_flow`], plus an additional
/// pressure-driven flow. In a fully periodic box it is given on all points of a grid that resolves every particle's own
/// envelope, whatever method is used for the motions. In other boxes it is evaluated point by point with the method of
/// the motions. Collective.
pub fn velocity(plan: &Plan, spheres: &LoadedSpheres, besides: Option<Poiseuille>, comm: &Comm) -> FluidVelocity {
    let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
    let (cell, (particles, loads)) = (spheres.cell, spheres.moved(&partition));
    let mut mobility = Mobility::new(plan, &partition);
    mobility.arrange(cell, &particles);
    if plan.boundaries == Boundaries::Periodic {
        mobility.apply(&loads, Output::Velocities);
        let spacing = cell.edges() / Vector::from_array(plan.grid.map(|n| n as f64));
        let raster = SamplePoints { first: Vector::ZERO, spacing, points: plan.grid };
        return FluidVelocity { raster, values: gather(&partition, plan.grid, &mobility.velocity_field()) };
    }
    let raster = plan.raster(cell.origin());
    let mut flow = mobility.flow(&loads);
    let mut values = Vec::with_capacity(if comm.is_first() { raster.points.iter().product() } else { 0 });
    for k in 0..raster.points[2] {
        let more = besides.map_or(Vector::ZERO, |flow| flow.velocity(raster.point([0, 0, k]).z));
        let plane = flow.plane(&raster, k);
        if comm.is_first() {
            values.extend(plane.into_iter().map(|velocity| velocity + more));
        }
    }
    FluidVelocity { raster, values }
}

impl LoadedSpheres<'_> {
    /// The particles and their loads on the ranks of another partition.
    fn moved(&self, partition: &Partition) -> (Particles, Loads) {
        let Self { cell, particles, loads } = self;
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
}

/// Gathers the ranks' parts of a field, `[component][z][y][x]`, on the first rank.
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
