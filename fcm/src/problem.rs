//! What is to be evaluated, and in which ways it may be.

use crate::costs::Costs;
use crate::envelope::Envelope;
use domain::{Boundaries, PeriodicBox, Vector};

/// How envelopes are evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Each envelope itself is spread: the smallest one sets the grid.
    Direct,
    /// All particles share one wider Gaussian on the grid, and pairs within the cutoff make up the difference.
    Split {
        /// Width of the common Gaussian.
        width: f64,
        /// Distance beyond which pairs are left out.
        cutoff: f64,
    },
}

impl Method {
    /// Distance beyond which pairs are left out: 0 if there are none.
    pub fn cutoff(&self) -> f64 {
        match *self {
            Self::Direct => 0.0,
            Self::Split { cutoff, .. } => cutoff,
        }
    }
}

/// Precision of the values on the grid; everything else is in `f64`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// `f32`
    Single,
    /// `f64`
    Double,
}

/// Which terms of the multipole expansion the particles have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Multipoles {
    /// Forces alone.
    Monopole,
    /// Forces, torques and stresslets.
    Dipole,
}

impl Multipoles {
    /// The width of a sphere's narrowest envelope.
    pub(crate) fn narrowest(self, envelope: Envelope) -> f64 {
        match self {
            Self::Monopole => envelope.monopole,
            Self::Dipole => envelope.dipole,
        }
    }
}

/// What is to be evaluated, and what the user fixed of how.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// Edges of the box; the longest that will be met, where they change.
    pub edges: Vector,
    /// What lies at its faces.
    pub boundaries: Boundaries,
    /// Volume of the box; that of a stretched one does not change.
    pub volume: f64,
    /// Length of the shortest lattice vector that will be met, across which no sphere meets itself.
    pub shortest_vector: f64,
    /// The part of each of these edges that will be left at least: 1 where they do not change.
    pub contraction: f64,
    /// Largest strain of the box that will be met.
    pub largest_strain: f64,
    /// Largest [`PeriodicBox::tilts`] of the box that will be met: 0 where its third lattice vector is upright.
    pub largest_tilts: [f64; 2],
    /// Radius and number of each kind of particle; radii may repeat.
    pub radii: Vec<(f64, usize)>,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Terms of the expansion.
    pub multipoles: Multipoles,
    /// Whether stresslets are solved for, which makes more of an error than given ones do.
    pub rigid: bool,
    /// Whether near pairs of rigid particles feel lubrication besides, which decides most of their motions where they are dense.
    pub lubricated: bool,
    /// Loads that are expected.
    pub loading: Loading,
    /// Relative error asked for.
    pub tolerance: f64,
    /// Threads in all.
    pub threads: usize,
    /// Ranks.
    pub ranks: usize,
    /// What parts of an evaluation cost on the machine, over what they cost where the planner was made.
    pub costs: Costs,
    /// What the user fixed.
    pub fixed: Fixed,
}

/// Loads on the particles, as far as they decide how small the answer may be beside the motions of single spheres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// Loads that differ from particle to particle.
    Varied,
    /// A background flow, in which motions relative to it may be small beside its rate of strain.
    Flow,
    /// Weights or other equal forces, which dense suspensions hinder.
    Uniform,
    /// The same on particles that may stand in a lattice, whose errors add up.
    UniformOnLattice,
}

impl Problem {
    /// The [`Self::shortest_vector`] of a box that does not move: along each combination of the second and the third lattice
    /// vector, with the multiple of the first that is nearest to it.
    pub fn shortest_vector_of(cell: &PeriodicBox) -> f64 {
        let length = |j: i32, k: i32| {
            let across = cell.lattice([0, j, k]);
            let along = if j == 0 && k == 0 { 1 } else { -(across.x / cell.edges().x).round() as i32 };
            cell.lattice([along, j, k]).length()
        };
        let combinations = (-2..=2).flat_map(|j| (0..=2).map(move |k| (j, k)));
        combinations.map(|(j, k)| length(j, k)).fold(f64::INFINITY, f64::min)
    }

    /// The [`Self::largest_tilts`] of a box that does not move.
    pub fn tilts_of(cell: &PeriodicBox) -> [f64; 2] {
        if cell.is_upright() { [0.0; 2] } else { cell.tilts().map(f64::abs) }
    }
}

/// What a user may fix; the planner chooses the rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fixed {
    /// Direct or split.
    pub method: Option<MethodName>,
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
    /// Relative error left in the stresslets.
    pub iteration_tolerance: Option<f64>,
}

/// The name of a [`Method`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MethodName {
    /// [`Method::Direct`]
    Direct,
    /// [`Method::Split`]
    Split,
}
