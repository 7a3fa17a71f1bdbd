//! Problem to plan for: box, particles, loads, and choices that the user fixed.

use crate::envelope::{Common, Envelope};
use crate::plan::accuracy::Brackets;
use crate::plan::costs::Costs;
use crate::plan::device::ComputeDevice;
use crate::plan::method::Method;
use crate::plan::network::Network;
use domain::{Boundaries, PeriodicBox, Vector};

/// Precision of the values on the grid; everything else is in `f64`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `f32`
    Single,
    /// `f64`
    Double,
}

/// Terms of the multipole expansion of the particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Multipoles {
    /// Forces alone.
    Monopole,
    /// Forces, torques and stresslets.
    Dipole,
    /// Magnetic or electric moments, with the field of a potential in place of the flow: [`crate::DipoleField`].
    Moments,
}

impl Multipoles {
    /// Components of the loads, and of the motions, of a sphere.
    pub(crate) fn components(self) -> usize {
        match self {
            Self::Monopole | Self::Moments => 3,
            Self::Dipole => 11,
        }
    }

    /// Width of a sphere's narrowest envelope.
    pub(crate) fn narrowest(self, envelope: Envelope) -> f64 {
        match self {
            Self::Monopole => envelope.monopole,
            Self::Dipole | Self::Moments => envelope.dipole,
        }
    }
}

/// Description of the suspension to evaluate, and the choices that the user fixed.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Edges of the box; the longest that occur, if they change.
    pub edges: Vector,
    /// Boundary conditions at the faces of the box.
    pub boundaries: Boundaries,
    /// Volume of the box; it does not change in extensional flow.
    pub volume: f64,
    /// Length of the shortest lattice vector that occurs; spheres must not overlap their images across it.
    pub shortest_vector: f64,
    /// Smallest length of an edge that occurs, over its length here: 1 if the edges do not change.
    pub smallest_edge_ratio: f64,
    /// Largest strain of the box that occurs.
    pub largest_strain: f64,
    /// Largest [`PeriodicBox::tilts`] of the box that occur: 0 if its third lattice vector is orthogonal to the other
    /// two.
    pub largest_tilts: [f64; 2],
    /// Radius and number of each kind of particle; radii may repeat.
    pub radii: Vec<(f64, usize)>,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Multipole terms of the particles.
    pub multipoles: Multipoles,
    /// Whether stresslets are solved for, which amplifies errors more than given ones do.
    pub rigid: bool,
    /// Whether near pairs of rigid particles are lubricated, which dominates their motions in dense suspensions.
    pub lubricated: bool,
    /// Loads that are expected.
    pub loading: Loading,
    /// Relative error asked for.
    pub tolerance: f64,
    /// Threads over all ranks.
    pub threads: usize,
    /// Number of ranks.
    pub ranks: usize,
    /// Costs of the parts of an evaluation on the machine, over those where the planner was calibrated.
    pub costs: Costs,
    /// Ranks and their network, if they are to count.
    pub network: Option<Network>,
    /// Choices that the user fixed.
    pub fixed: Fixed,
}

/// Kinds of loads, as far as they decide how small the answer may be relative to the motions of single spheres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// Loads that differ from particle to particle.
    Varied,
    /// A background flow, in which motions relative to it may be small against its rate of strain.
    Flow,
    /// Degenerate quadrupoles of swimmers, in a background flow or not, whose errors exceed those of forces.
    Swimming,
    /// Weights or other equal forces, whose motion is hindered in dense suspensions.
    Uniform,
    /// Equal forces on particles that may form a lattice, where errors add up.
    UniformOnLattice,
}

impl Problem {
    /// [`Self::shortest_vector`] of a static box: over combinations of the second and third lattice vector, each with
    /// the nearest multiple of the first.
    pub fn shortest_vector_of(cell: &PeriodicBox) -> f64 {
        let length = |j: i32, k: i32| {
            let across = cell.lattice([0, j, k]);
            let along = if j == 0 && k == 0 { 1 } else { -(across.x / cell.edges().x).round() as i32 };
            cell.lattice([along, j, k]).length()
        };
        let combinations = (-2..=2).flat_map(|j| (0..=2).map(move |k| (j, k)));
        combinations.map(|(j, k)| length(j, k)).fold(f64::INFINITY, f64::min)
    }

    /// The same in a static box with the same boundaries.
    #[must_use]
    pub fn in_box(&self, cell: &PeriodicBox) -> Self {
        Self {
            edges: cell.edges(),
            volume: cell.volume(),
            shortest_vector: Self::shortest_vector_of(cell),
            ..self.clone()
        }
    }

    /// Width of a sphere's narrowest envelope.
    pub(crate) fn own_width(&self, radius: f64) -> f64 {
        self.multipoles.narrowest(Envelope::of_sphere(radius))
    }

    /// Brackets of a common Gaussian, on a grid along whose axes spheres extend farther by `stretch`.
    pub(crate) fn brackets(&self, width: f64, stretch: f64) -> Brackets {
        if self.multipoles == Multipoles::Moments {
            return Brackets { common: 0.0, own: 0.0, stretch, size: self.largest_radius() / width };
        }
        let [least, most] = [self.smallest_radius(), self.largest_radius()].map(|radius| self.own_width(radius));
        let common = Common::new(width, [least, most].into_iter());
        let (square, typical) = (width * width, 0.25 * (most * most - least * least));
        Brackets {
            common: 0.5 * common.increment / square,
            own: typical / square,
            stretch,
            size: self.largest_radius() / width,
        }
    }

    /// [`Self::largest_tilts`] of a static box.
    pub fn tilts_of(cell: &PeriodicBox) -> [f64; 2] {
        if cell.is_orthogonal() { [0.0; 2] } else { cell.tilts().map(f64::abs) }
    }
}

/// Choices that a user may fix; the planner makes the others.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fixed {
    /// Method of evaluation.
    pub method: Option<Method>,
    /// Grid points along each edge.
    pub grid: Option<[usize; 3]>,
    /// Grid points of a stencil along each axis.
    pub support: Option<usize>,
    /// Width of the common Gaussian of the split method.
    pub width: Option<f64>,
    /// Cutoff of the pairs of the split method.
    pub cutoff: Option<f64>,
    /// Precision of the grid.
    pub precision: Option<Precision>,
    /// Device that evaluates the far field.
    pub device: ComputeDevice,
    /// Relative error allowed in the stresslets.
    pub iteration_tolerance: Option<f64>,
}

#[cfg(test)]
impl Problem {
    /// Five spheres of two radii in a periodic box.
    pub(crate) fn of_five_spheres() -> Self {
        Self {
            edges: Vector::new(9.0, 8.0, 10.0),
            boundaries: Boundaries::Periodic,
            volume: 720.0,
            shortest_vector: 8.0,
            smallest_edge_ratio: 1.0,
            largest_strain: 0.0,
            largest_tilts: [0.0; 2],
            radii: vec![(1.0, 3), (1.3, 2)],
            viscosity: 1.0,
            multipoles: Multipoles::Dipole,
            rigid: true,
            lubricated: false,
            loading: Loading::Varied,
            tolerance: 1e-3,
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed::default(),
        }
    }
}
