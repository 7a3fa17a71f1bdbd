//! Particles in a box, their loads, and their motion by the library.

use domain::{Comm, Particles, Partition, PeriodicBox, Random, Traceless, Vector, random_packing};
use fcm::{Costs, Fixed, Loading, Loads, Mobility, Motion, Multipoles, Output, Plan, Problem};

/// Particles in a box.
#[derive(Debug, Clone)]
pub struct Suspension {
    pub cell: PeriodicBox,
    pub viscosity: f64,
    pub positions: Vec<Vector>,
    pub radii: Vec<f64>,
}

impl Suspension {
    /// `count` particles of radii 1 and `ratio` alternately at random positions without overlap.
    pub fn random(count: usize, ratio: f64, cell: PeriodicBox, seed: u64) -> Self {
        let radii: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { 1.0 } else { ratio }).collect();
        let positions = random_packing(&cell, &radii, 0.0, seed).unwrap();
        Self { cell, viscosity: 1.3, positions, radii }
    }

    /// One particle of radius 1 at a position that is no point of any grid.
    pub fn single(edge: f64) -> Self {
        let cell = PeriodicBox::new(Vector::splat(edge)).unwrap();
        Self { cell, viscosity: 0.7, positions: vec![Vector::new(0.123, 0.456, 0.789) * edge], radii: vec![1.0] }
    }

    /// Random loads of comparable effect: forces proportional to `a`, torques and stresslets to `a^2`.
    pub fn loads(&self, seed: u64) -> Loads {
        let mut random = Random::new(seed, 0xABCD);
        let mut loads = Loads::default();
        for &a in &self.radii {
            let mut vector = || random.point() - Vector::splat(0.5);
            loads.forces.push(vector() * a);
            loads.torques.push(vector() * a * a);
            loads.stresslets.push(Traceless(std::array::from_fn(|_| (random.uniform() - 0.5) * a * a)));
        }
        loads
    }

    /// Problem for the planner.
    pub fn problem(&self, tolerance: f64) -> Problem {
        Problem {
            edges: self.cell.edges(),
            boundaries: self.cell.boundaries(),
            volume: self.cell.edges().element_product(),
            shortest_vector: Problem::shortest_vector_of(&self.cell),
            smallest_edge_ratio: 1.0,
            largest_strain: self.cell.strain().abs(),
            largest_tilts: Problem::tilts_of(&self.cell),
            radii: self.radii.iter().map(|&a| (a, 1)).collect(),
            viscosity: self.viscosity,
            multipoles: Multipoles::Dipole,
            rigid: false,
            lubricated: false,
            loading: Loading::Varied,
            tolerance,
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed::default(),
        }
    }

    /// Plan for a tolerance.
    pub fn plan(&self, tolerance: f64, fixed: Fixed) -> Plan {
        Plan::choose(&Problem { fixed, ..self.problem(tolerance) }).unwrap()
    }

    /// Mobility of these particles, on one rank.
    pub fn mobility(&self, plan: &Plan) -> Mobility {
        let mut mobility = Mobility::new(plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
        mobility.arrange(&self.cell, &self.particles());
        mobility
    }

    /// Motion by the library, on one rank.
    pub fn evaluate(&self, plan: &Plan, loads: &Loads) -> Motion {
        self.mobility(plan).apply(loads, Output::All)
    }

    /// The particles as a store, with their rows as ids.
    pub fn particles(&self) -> Particles {
        let mut particles = Particles::default();
        for (id, (&position, &radius)) in self.positions.iter().zip(&self.radii).enumerate() {
            particles.push(id as u64, position, radius, 0);
        }
        particles
    }

    /// The same particles, all displaced by the same vector and wrapped into the box.
    #[must_use]
    pub fn displaced(&self, by: Vector) -> Self {
        let positions = self.positions.iter().map(|&p| self.cell.wrap(p + by).0).collect();
        Self { positions, ..self.clone() }
    }
}
