//! Plan of an evaluation: grid, stencils, cutoff, precision.

pub mod accuracy;
pub(crate) mod bounded;
pub(crate) mod check;
pub(crate) mod cost;
pub(crate) mod costs;
pub(crate) mod device;
pub(crate) mod grid_refinement;
pub(crate) mod infeasible;
pub(crate) mod method;
pub(crate) mod network;
pub(crate) mod plan_identity;
pub(crate) mod planner;
pub(crate) mod problem;
pub(crate) mod sample_points;
pub(crate) mod tolerance_shares;
pub(crate) mod wavenumber_split;

use crate::envelope::{Common, Envelope};
use crate::grid::stencil::Support;
use crate::grid::window::KaiserBessel;
use crate::plan::costs::Costs;
use crate::plan::device::ComputeDevice;
use crate::plan::method::{Method, Split};
use crate::plan::problem::{Fixed, Loading, Multipoles, Precision, Problem};
use domain::{AxisRotation, Boundaries, Number, PeriodicBox, Units, Vector};

/// Reason why there is no plan.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PlanError {
    /// There are no particles.
    #[error("there are no particles; a scene needs at least one")]
    NoParticles,
    /// A radius is not positive and finite.
    #[error("a particle has the radius {}; radii need to be positive and finite", Number(*.0))]
    Radius(f64),
    /// A particle overlaps its own periodic image.
    #[error(
        "a particle of radius {} does not fit the box, whose shortest lattice vector is {} long; it needs more than {}",
        Number(*radius), Number(*shortest), Number(*needed)
    )]
    TooLarge {
        /// Radius of the particle.
        radius: f64,
        /// Length of the box's shortest lattice vector.
        shortest: f64,
        /// Least length of that vector for this radius.
        needed: f64,
    },
    /// The viscosity is not positive and finite.
    #[error("the viscosity is {}; it needs to be positive and finite", Number(*.0))]
    Viscosity(f64),
    /// The box is invalid.
    #[error("the box: {0}")]
    Box(String),
    /// The tolerance is out of range.
    #[error("the tolerance is {}; it needs to be between 1e-12 and 0.5", Number(*.0))]
    Tolerance(f64),
    /// The fixed grid can't be transformed.
    #[error("hydrodynamics.grid: {0}")]
    Grid(solver::GridError),
    /// The grid would have more points than the largest supported grid.
    #[error(
        "the smallest radius, {}, needs {points:.0e} grid points in a box of {edges}, more than are counted; \
         leave hydrodynamics.method to the program, or take a smaller box, larger spheres or a larger tolerance",
        Number(*radius)
    )]
    TooFine {
        /// Smallest radius.
        radius: f64,
        /// Edges of the box.
        edges: String,
        /// Number of points needed.
        points: f64,
    },
    /// Fixed choices contradict each other.
    #[error("{0}")]
    Fixed(String),
}

/// Without the grid's error as the source: the message contains it already.
impl From<solver::GridError> for PlanError {
    fn from(error: solver::GridError) -> Self {
        Self::Grid(error)
    }
}

/// Aspect ratio `x/y` of a box from which on its lattice may be sheared so much, by strains up to half the ratio,
/// that the grid would need several times the resolution along y.
pub(crate) const LONG: f64 = 16.0;

/// Numerical parameters of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Edges of the box; the longest that occur, if they change.
    pub edges: Vector,
    /// Boundary conditions at the faces of the box.
    pub boundaries: Boundaries,
    /// Periods of the grid: the edges, or longer along axes that are not periodic.
    pub period: Vector,
    /// Distance beyond the open faces up to which the velocity of the fluid is evaluated; `None` if only that of
    /// spheres is.
    pub fluid_margin: Option<f64>,
    /// Smallest length of an edge that occurs, over its length here: 1 if the edges do not change.
    pub smallest_edge_ratio: f64,
    /// Whether the third lattice vector is tilted.
    pub is_tilted: bool,
    /// Distinct radii, in ascending order.
    pub radii: Vec<f64>,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Multipole terms of the particles.
    pub multipoles: Multipoles,
    /// Relative error asked for.
    pub tolerance: f64,
    /// Relative error allowed in the stresslets.
    pub iteration_tolerance: f64,
    /// Relative error allowed for the split between wavenumbers of the walls' flow on the grid and between spheres.
    pub wavenumber_split_tolerance: f64,
    /// Fraction of a sphere's mobility below which its images in walls are left out.
    pub image_cutoff: f64,
    /// Method of evaluation.
    pub method: Method,
    /// Parameters of the split method.
    pub split: Option<Split>,
    /// Device that evaluates the far field.
    pub device: ComputeDevice,
    /// Precision of the grid.
    pub precision: Precision,
    /// Grid points along each edge.
    pub grid: [usize; 3],
    /// Grid points of a stencil.
    pub support: Support,
    /// Relative error expected.
    pub predicted_error: f64,
    /// Seconds expected for one evaluation.
    pub predicted_seconds: f64,
}

impl Plan {
    /// The fastest plan that keeps the tolerance, by the models of error and cost.
    pub fn choose(problem: &Problem) -> Result<Self, PlanError> {
        let ranked = Self::ranked(problem)?;
        Ok(ranked.into_iter().next().expect("there is a plan for every problem that was checked"))
    }

    /// Plans that keep the tolerance, the fastest first: the best of each method, precision and stencil.
    pub fn ranked(problem: &Problem) -> Result<Vec<Self>, PlanError> {
        problem.check()?;
        let problem = problem.summed_up();
        let mut plans = problem.candidates();
        if plans.is_empty() {
            return Err(problem.no_plan());
        }
        problem.keep_evaluable(&mut plans)?;
        plans.sort_by(|a, b| problem.seconds_of(a).total_cmp(&problem.seconds_of(b)));
        Ok(plans)
    }

    /// Plan for the velocity field of the fluid, which needs every envelope on the grid, in a box of the given strain
    /// that is not tilted. Its error is 1% at most. Fails if the smallest envelope needs more points than the largest
    /// supported grid.
    pub fn on_the_grid_alone(&self, strain: f64) -> Result<Self, PlanError> {
        let problem = Problem {
            edges: self.edges,
            boundaries: self.boundaries,
            volume: self.edges.element_product(),
            shortest_vector: self.edges.min_element() * self.smallest_edge_ratio,
            smallest_edge_ratio: self.smallest_edge_ratio,
            largest_strain: strain.abs(),
            largest_tilts: [0.0; 2],
            radii: self.radii.iter().map(|&radius| (radius, 1)).collect(),
            viscosity: self.viscosity,
            multipoles: self.multipoles,
            rigid: false,
            lubricated: false,
            loading: Loading::Varied,
            tolerance: self.tolerance.clamp(1e-6, 1e-2),
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed { method: Some(Method::Direct), ..Fixed::default() },
        };
        Self::choose(&problem)
    }

    /// The box, not sheared.
    pub fn cell(&self) -> PeriodicBox {
        let cell = PeriodicBox::new(self.edges).and_then(|cell| cell.with_boundaries(self.boundaries));
        cell.expect("a plan has a box")
    }

    /// Units of length and viscosity in which this plan's are about 1.
    pub(crate) fn units(&self) -> Units {
        let (smallest, largest) = self.extremes();
        Units::of(self.viscosity, [smallest, largest])
    }

    /// The same plan in other units of length and viscosity.
    pub(crate) fn in_units(&self, units: &Units) -> Self {
        let length = |given: f64| given / units.length;
        let split = self.split.map(|split| Split { width: length(split.width), cutoff: length(split.cutoff) });
        Self {
            edges: self.edges / units.length,
            period: self.period / units.length,
            fluid_margin: self.fluid_margin.map(length),
            radii: self.radii.iter().map(|&radius| length(radius)).collect(),
            viscosity: self.viscosity / units.viscosity,
            split,
            support: Support { reach: length(self.support.reach), ..self.support },
            ..self.clone()
        }
    }

    /// Distance beyond which pairs of the split method are left out; 0 with other methods.
    pub fn cutoff(&self) -> f64 {
        self.split.map_or(0.0, |split| split.cutoff)
    }

    /// Smallest and largest radius.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        let of = |radius: Option<&f64>| radius.copied().unwrap_or(1.0);
        (of(self.radii.first()), of(self.radii.last()))
    }

    /// Distances between grid points.
    pub(crate) fn spacing(&self) -> Vector {
        self.period / Vector::from_array(self.grid.map(|n| n as f64))
    }

    /// Function that the split method spreads in place of the envelopes. If all radii are equal, dipoles need no
    /// bracket on the grid. Moments need none in any case: the potential of the difference of two Gaussians decays like
    /// a Gaussian.
    pub(crate) fn common(&self) -> Option<Common> {
        let Split { width, .. } = self.split?;
        if self.multipoles == Multipoles::Moments {
            return Some(Common { width, increment: 0.0 });
        }
        let narrowest = |&radius: &f64| self.multipoles.narrowest(Envelope::of_sphere(radius));
        Some(Common::new(width, self.radii.iter().map(narrowest)))
    }

    /// Envelopes of the spheres of each radius on the grid; for moments it has the common Gaussian alone.
    pub(crate) fn grid_envelopes(&self) -> Vec<Envelope> {
        match (self.multipoles, self.split) {
            (Multipoles::Moments, Some(Split { width, .. })) => {
                vec![Envelope { monopole: width, dipole: width }; self.radii.len()]
            }
            _ => self.radii.iter().map(|&radius| Envelope::of_sphere(radius)).collect(),
        }
    }

    /// Window that the split method uses on the grid.
    pub(crate) fn window(&self) -> Option<KaiserBessel> {
        let Split { width, .. } = self.split?;
        Some(KaiserBessel::new(self.support.support, width / self.spacing().max_element()))
    }

    /// Class of a radius: its index in [`Plan::radii`].
    ///
    /// # Panics
    /// If no particle of the problem had that radius.
    pub(crate) fn class_of(&self, radius: f64) -> u32 {
        let place = self.radii.binary_search_by(|a| a.total_cmp(&radius));
        place.expect("a plan knows the radii of all particles") as u32
    }

    /// Error of the tables of pair functions.
    pub(crate) fn table_tolerance(&self) -> f64 {
        (0.01 * self.tolerance).max(1e-14)
    }

    /// Whether there is a grid: with the dense method, its points are only those by which ranks share the box.
    pub fn has_grid(&self) -> bool {
        self.method.gridless().is_none()
    }

    /// One-line summary of the plan.
    pub fn in_short(&self) -> String {
        self.in_short_for(AxisRotation::default())
    }

    /// The same in the user's axes, which `turn` maps to those of the box.
    pub fn in_short_for(&self, turn: AxisRotation) -> String {
        let [nx, ny, nz] = turn.inverse().list(self.grid);
        let method = self.method.name();
        let precision = if self.precision == Precision::Single { "f32" } else { "f64" };
        if !self.has_grid() {
            return format!("{method} in {precision}, error {:.1e}", self.predicted_error);
        }
        let (points, error) = (self.support.support, self.predicted_error);
        format!("{method}, {nx} x {ny} x {nz} in {precision}, {points} points along an axis, error {error:.1e}")
    }

    /// Description of the plan, one quantity per line.
    pub fn describe(&self) -> String {
        self.describe_for(AxisRotation::default())
    }

    /// The same in the user's axes, which `turn` maps to those of the box.
    pub fn describe_for(&self, turn: AxisRotation) -> String {
        let [nx, ny, nz] = turn.inverse().list(self.grid);
        let [px, py, pz] = turn.inverse().list(self.support.along_axes());
        let method = match (self.method.gridless(), self.split) {
            (Some(gridless), _) => format!("{}: {}", self.method.name(), gridless.description()),
            (None, None) => "direct: every envelope on the grid".to_owned(),
            (None, Some(Split { width, cutoff })) => {
                format!("split: common Gaussian of width {:.5}, pairs within {:.5}", Number(width), Number(cutoff))
            }
        };
        let precision = if self.precision == Precision::Single { "f32" } else { "f64" };
        let grid = format!(
            "grid       {nx} x {ny} x {nz} points in {precision}\nsupport    {px} x {py} x {pz} points a particle\n"
        );
        let device = match self.device {
            ComputeDevice::Cpu => String::new(),
            ComputeDevice::Gpu => format!("device     {}\n", self.device.name()),
        };
        format!(
            "method     {method}\n{}{device}tolerance  {:.1e} asked for, {:.1e} expected\niteration  to {:.1e} in the \
             stresslets\n",
            if self.has_grid() { grid.as_str() } else { "" },
            self.tolerance,
            self.predicted_error,
            self.iteration_tolerance
        )
    }
}
