//! Velocity of the fluid on a grid, for plots.

use bytemuck::cast_slice;
use domain::{Boundaries, Comm, Particles, Partition, PeriodicBox, Vector};
use fcm::{Loads, Mobility, Plan, SamplePoints};
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
    /// Their degenerate quadrupoles by slip, if there are any on any rank.
    pub quadrupoles: Option<&'a [Vector]>,
}

/// Velocity of the fluid relative to the background flow, by a plan [`Plan::of_flow`], plus an additional
/// pressure-driven flow. In a fully periodic box it is given on all points of a grid that resolves every particle's own
/// envelope, whatever method is used for the motions. In other boxes it is evaluated point by point with the method of
/// the motions. Collective.
pub fn velocity(plan: &Plan, spheres: &LoadedSpheres, besides: Option<Poiseuille>, comm: &Comm) -> FluidVelocity {
    let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
    let (cell, MovedSpheres { particles, loads, quadrupoles }) = (spheres.cell, spheres.moved(&partition));
    let mut mobility = Mobility::new(plan, &partition);
    mobility.arrange(cell, &particles);
    if plan.boundaries == Boundaries::Periodic {
        let share = mobility.velocity_field_of(&loads, quadrupoles.as_deref());
        let spacing = cell.edges() / Vector::from_array(plan.grid.map(|n| n as f64));
        let raster = SamplePoints { first: Vector::ZERO, spacing, points: plan.grid };
        return FluidVelocity { raster, values: gather(&partition, plan.grid, &share) };
    }
    let raster = plan.raster(cell.origin());
    let mut flow = mobility.flow(&loads, quadrupoles.as_deref());
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

/// The spheres with their loads on the ranks of another partition.
struct MovedSpheres {
    particles: Particles,
    loads: Loads,
    quadrupoles: Option<Vec<Vector>>,
}

impl LoadedSpheres<'_> {
    fn moved(&self, partition: &Partition) -> MovedSpheres {
        let Self { cell, particles, loads, quadrupoles } = self;
        let lists: [(&str, usize, &[f64]); 4] = [
            ("force", 3, cast_slice(&loads.forces)),
            ("torque", 3, cast_slice(&loads.torques)),
            ("stresslet", 5, cast_slice(&loads.stresslets)),
            ("quadrupole", 3, cast_slice(quadrupoles.unwrap_or_default())),
        ];
        let mut moved = particles.without_columns();
        for (name, width, values) in lists {
            moved.column(name, width).values[..values.len()].copy_from_slice(values);
        }
        moved.migrate(partition, cell);
        let [forces, torques, stresslets, of_slip] =
            lists.map(|(name, width, _)| std::mem::take(&mut moved.column(name, width).values));
        let loads = Loads {
            forces: cast_slice(&forces).to_vec(),
            torques: cast_slice(&torques).to_vec(),
            stresslets: cast_slice(&stresslets).to_vec(),
        };
        let quadrupoles = quadrupoles.map(|_| cast_slice(&of_slip).to_vec());
        MovedSpheres { particles: moved.without_columns(), loads, quadrupoles }
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
