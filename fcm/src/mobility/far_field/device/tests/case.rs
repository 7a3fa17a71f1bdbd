//! Random spheres in boxes of all shapes.

use super::*;
use crate::plan::costs::Costs;
use crate::plan::method::Method;
use crate::plan::problem::{Fixed, Loading, Multipoles, Precision, Problem};
use domain::{Boundaries, Comm, Random, Tensor};

/// Spheres at random in a box, which may overlap: the far field is defined all the same.
pub(super) struct Case {
    pub cell: PeriodicBox,
    pub particles: Particles,
    pub loads: Loads,
    pub tolerance: f64,
}

/// Numbers from a seed.
struct Numbers(Random);

impl Numbers {
    fn of(seed: u64) -> Self {
        Self(Random::new(seed, 0))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    fn vector(&mut self) -> Vector {
        Vector::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)))
    }
}

/// Shape of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    Upright,
    Sheared,
    Tilted,
    /// Not periodic along z, or along all axes.
    Bounded(Boundaries),
}

/// Shapes of a periodic box.
pub(super) const PERIODIC: [Shape; 3] = [Shape::Upright, Shape::Sheared, Shape::Tilted];

impl Case {
    /// With radii from 1 to `ratio` and a fraction of the volume, at most some spheres.
    pub fn random(seed: u64, shape: Shape, ratio: f64) -> Self {
        let mut numbers = Numbers::of(seed);
        let radii = [1.0, numbers.between(1.0, ratio), ratio];
        let fraction = 10_f64.powf(numbers.between(-2.0, -0.22));
        let volume_of = |radius: f64| 4.19 * radius * radius * radius;
        let mut chosen: Vec<f64> = (0..30).map(|i| if i % 6 == 5 { ratio } else { radii[i % 2] }).collect();
        let least = (2.1 * ratio).powi(3);
        if chosen.iter().map(|&a| volume_of(a)).sum::<f64>() / fraction < 1.4 * least {
            chosen.extend(std::iter::repeat_n(1.0, 30));
        }
        let volume = (chosen.iter().map(|&a| volume_of(a)).sum::<f64>() / fraction).max(1.4 * least);
        let stretch = Vector::new(1.0, numbers.between(1.0, 1.2), numbers.between(1.0, 1.2));
        let edges = stretch * (volume / stretch.element_product()).cbrt();
        let (strain, Vector { x, y, z }) = (numbers.between(-0.45, 0.45), edges);
        let lattice = [
            Vector::new(x, 0.0, 0.0),
            Vector::new(strain * y, y, 0.0),
            Vector::new(numbers.between(-0.3, 0.3) * z, numbers.between(-0.3, 0.3) * z, z),
        ];
        let turn = Tensor::from_rotation_x(0.4) * Tensor::from_rotation_z(-0.9);
        let cell = match shape {
            Shape::Upright => PeriodicBox::new(edges),
            Shape::Sheared => PeriodicBox::sheared(edges, strain),
            Shape::Tilted => PeriodicBox::of_lattice(lattice.map(|vector| turn * vector)),
            Shape::Bounded(boundaries) => PeriodicBox::new(edges).and_then(|cell| cell.with_boundaries(boundaries)),
        };
        let cell = cell.unwrap();
        let mut particles = Particles::default();
        for (id, &radius) in chosen.iter().enumerate() {
            let walls = if cell.is_periodic(2) { 0 } else { cell.boundaries().walls() };
            let [low, high] = [1, 2].map(|number| if walls >= number { 0.86 * radius } else { 0.0 });
            let coordinates = std::array::from_fn(|axis| match axis {
                2 => numbers.between(low, edges[axis] - high),
                _ => numbers.between(0.0, edges[axis]),
            });
            particles.push(id as u64, cell.position(Vector::from_array(coordinates)), radius, 0);
        }
        let loads = loads_of(&mut numbers, &chosen);
        let tolerance = 10_f64.powf(numbers.between(-4.0, -1.5));
        Self { cell, particles, loads, tolerance }
    }

    /// The same in a smaller box in unbounded fluid, which begins somewhere.
    pub fn with_extent(mut self, origin: Vector, edges: Vector) -> Self {
        let (scale, cell) = (edges / self.cell.edges(), self.cell.with_extent(origin, edges).unwrap());
        self.particles.positions.iter_mut().for_each(|x| *x = origin + *x * scale);
        self.cell = cell;
        self
    }

    /// The same with spheres in a part of the box that begins at its origin, at most as near a wall as before.
    pub fn with_fraction_of_edges(mut self, fraction: Vector) -> Self {
        for (position, &radius) in self.particles.positions.iter_mut().zip(&self.particles.radii) {
            *position *= fraction;
            position.z = position.z.max(0.86 * radius);
        }
        self
    }

    /// Plan of the split method.
    pub fn plan(&self, precision: Precision) -> Plan {
        let [t, r] = Problem::tilts_of(&self.cell);
        let problem = Problem {
            edges: self.cell.edges(),
            boundaries: self.cell.boundaries(),
            volume: self.cell.volume(),
            shortest_vector: Problem::shortest_vector_of(&self.cell),
            smallest_edge_ratio: 1.0,
            largest_strain: self.cell.strain().abs(),
            largest_tilts: [t, r],
            radii: self.particles.radii.iter().map(|&radius| (radius, 1)).collect(),
            viscosity: 0.7,
            multipoles: Multipoles::Dipole,
            rigid: false,
            lubricated: false,
            loading: Loading::Varied,
            tolerance: self.tolerance,
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed { method: Some(Method::Split), precision: Some(precision), ..Fixed::default() },
        };
        Plan::choose(&problem).unwrap()
    }

    /// The same on a device.
    pub fn on_device(&self, plan: &Plan, device: Box<dyn Device>) -> DeviceFarField {
        let mut far = DeviceFarField::on(device, plan, &alone(plan));
        far.arrange(&self.cell, &self.particles);
        far
    }

    /// Loads of some particles.
    pub fn loads_of(&self, rows: &[usize]) -> Loads {
        Loads {
            forces: rows.iter().map(|&row| self.loads.forces[row]).collect(),
            torques: rows.iter().map(|&row| self.loads.torques[row]).collect(),
            stresslets: rows.iter().map(|&row| self.loads.stresslets[row]).collect(),
        }
    }

    pub fn on_host(&self, plan: &Plan) -> GridFarField {
        let mut far = GridFarField::new(plan, &alone(plan));
        far.arrange(&self.cell, &self.particles);
        far
    }

    /// Loads of one kind at a time, and all together.
    pub fn kinds(&self) -> [Loads; 4] {
        let Loads { forces, torques, stresslets } = self.loads.clone();
        [
            Loads { forces, ..Loads::default() },
            Loads { torques, ..Loads::default() },
            Loads { stresslets, ..Loads::default() },
            self.loads.clone(),
        ]
    }
}

fn loads_of(numbers: &mut Numbers, radii: &[f64]) -> Loads {
    let mut loads = Loads::default();
    for &radius in radii {
        loads.forces.push(numbers.vector() * radius);
        loads.torques.push(numbers.vector() * radius.powi(3));
        let [a, b] = [numbers.vector(), numbers.vector()];
        loads.stresslets.push(Traceless([a.x, a.y, a.z, b.x, b.y]) * radius.powi(3));
    }
    loads
}

pub(super) fn alone(plan: &Plan) -> Partition {
    Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]])
}
