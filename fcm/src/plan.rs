//! How an evaluation is to be made: grid, supports, cutoff, precision.

use crate::costs::Costs;
use crate::envelope::{Common, Envelope};
use crate::problem::{Fixed, Loading, Method, MethodName, Multipoles, Precision, Problem};
use crate::stencil::Support;
use crate::window::Window;
use domain::{Boundaries, Number, PeriodicBox, Turn, Units, Vector};

/// Why there is no plan.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PlanError {
    /// No particles at all.
    #[error("there are no particles; a scene needs at least one")]
    NoParticles,
    /// A radius that is none.
    #[error("a particle has the radius {}; radii need to be positive and finite", Number(*.0))]
    Radius(f64),
    /// A particle that meets itself.
    #[error(
        "a particle of radius {} does not fit the box, whose shortest lattice vector is {} long; it needs more than {}",
        Number(*radius), Number(*shortest), Number(*needed)
    )]
    TooLarge {
        /// The radius.
        radius: f64,
        /// Length of the box's shortest lattice vector.
        shortest: f64,
        /// The least length for that radius.
        needed: f64,
    },
    /// A viscosity that is none.
    #[error("the viscosity is {}; it needs to be positive and finite", Number(*.0))]
    Viscosity(f64),
    /// A box that is none.
    #[error("the box: {0}")]
    Box(String),
    /// A tolerance out of range.
    #[error("the tolerance is {}; it needs to be between 1e-12 and 0.5", Number(*.0))]
    Tolerance(f64),
    /// A fixed grid that can't be transformed.
    #[error("hydrodynamics.grid: {0}")]
    Grid(solver::GridError),
    /// A grid of more points than are counted.
    #[error(
        "the smallest radius, {}, needs {points:.0e} grid points in a box of {edges}, more than are counted; \
         leave hydrodynamics.method to the program, or take a smaller box, larger spheres or a larger tolerance",
        Number(*radius)
    )]
    TooFine {
        /// The smallest radius.
        radius: f64,
        /// Edges of the box.
        edges: String,
        /// Points needed.
        points: f64,
    },
    /// Fixed choices that contradict each other.
    #[error("{0}")]
    Fixed(String),
}

/// Not as a source of the error: its message holds that of the grid already.
impl From<solver::GridError> for PlanError {
    fn from(error: solver::GridError) -> Self {
        Self::Grid(error)
    }
}

/// Lengths of a box over its width from which on the grid of its lattice as it is sheared, of strains up to half of that, would
/// have to be some times as fine along y.
pub(crate) const LONG: f64 = 16.0;

/// How an evaluation is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Edges of the box; the longest that will be met, where they change.
    pub edges: Vector,
    /// What lies at its faces.
    pub boundaries: Boundaries,
    /// Lengths after which the grid repeats: the edges, or longer along axes that do not repeat.
    pub period: Vector,
    /// How far beyond its open faces there are points where the velocity of the fluid is asked for; none if that is asked for at
    /// centres of spheres alone.
    pub beyond: Option<f64>,
    /// The part of each of these edges that will be left at least.
    pub contraction: f64,
    /// Whether its third lattice vector leans.
    pub leans: bool,
    /// Distinct radii, in ascending order.
    pub radii: Vec<f64>,
    /// Viscosity of the fluid.
    pub viscosity: f64,
    /// Terms of the expansion.
    pub multipoles: Multipoles,
    /// Relative error asked for.
    pub tolerance: f64,
    /// Relative error left in the stresslets.
    pub iteration_tolerance: f64,
    /// Relative error that the cut between wavenumbers of walls on the grid and between spheres may have.
    pub allowed_of_wall_cut: f64,
    /// Part of the mobility of a sphere below which its images in walls are left out.
    pub least_image: f64,
    /// Direct or split, with the split's width and cutoff.
    pub method: Method,
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
    /// The fastest plan that keeps the tolerance, by the models of its error and its cost.
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
        plans.sort_by(|a, b| a.predicted_seconds.total_cmp(&b.predicted_seconds));
        Ok(plans)
    }

    /// A plan for the flow itself, which needs every envelope on the grid, in a box of the given strain that
    /// does not lean. Its error is
    /// a percent at most. There is none where the smallest envelope takes more points than are counted.
    pub fn on_the_grid_alone(&self, strain: f64) -> Result<Self, PlanError> {
        let problem = Problem {
            edges: self.edges,
            boundaries: self.boundaries,
            volume: self.edges.element_product(),
            shortest_vector: self.edges.min_element() * self.contraction,
            contraction: self.contraction,
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
            fixed: Fixed { method: Some(MethodName::Direct), ..Fixed::default() },
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
        let method = match self.method {
            Method::Direct => Method::Direct,
            Method::Split { width, cutoff } => Method::Split { width: length(width), cutoff: length(cutoff) },
        };
        Self {
            edges: self.edges / units.length,
            period: self.period / units.length,
            beyond: self.beyond.map(length),
            radii: self.radii.iter().map(|&radius| length(radius)).collect(),
            viscosity: self.viscosity / units.viscosity,
            method,
            support: Support { reach: length(self.support.reach), ..self.support },
            ..self.clone()
        }
    }

    /// The smallest and the largest radius.
    pub(crate) fn extremes(&self) -> (f64, f64) {
        let of = |radius: Option<&f64>| radius.copied().unwrap_or(1.0);
        (of(self.radii.first()), of(self.radii.last()))
    }

    /// Distances between grid points.
    pub(crate) fn spacing(&self) -> Vector {
        self.period / Vector::from_array(self.grid.map(|n| n as f64))
    }

    /// What the split method spreads in place of the envelopes. The least is left to the grid: with dipoles, nothing of
    /// theirs if all radii are equal.
    pub(crate) fn common(&self) -> Option<Common> {
        let Method::Split { width, .. } = self.method else {
            return None;
        };
        let narrowest = |&radius: &f64| self.multipoles.narrowest(Envelope::of_sphere(radius));
        Some(Common::new(width, self.radii.iter().map(narrowest)))
    }

    /// The window that the split method has on the grid.
    pub(crate) fn window(&self) -> Option<Window> {
        let Method::Split { width, .. } = self.method else {
            return None;
        };
        Some(Window::new(self.support.support, width / self.spacing().max_element()))
    }

    /// The class of a radius: its place among [`Plan::radii`].
    ///
    /// # Panics
    /// If no particle of the problem had that radius.
    pub(crate) fn class_of(&self, radius: f64) -> u32 {
        let place = self.radii.binary_search_by(|a| a.total_cmp(&radius));
        place.expect("a plan knows the radii of all particles") as u32
    }

    /// How exact the tables of pair functions need to be.
    pub(crate) fn table_tolerance(&self) -> f64 {
        (0.01 * self.tolerance).max(1e-14)
    }

    /// The plan in a line.
    pub fn in_short(&self) -> String {
        self.in_short_for(Turn::default())
    }

    /// The same for a reader whose axes this turn makes those of the box.
    pub fn in_short_for(&self, turn: Turn) -> String {
        let [nx, ny, nz] = turn.inverse().list(self.grid);
        let method = if self.method == Method::Direct { "direct" } else { "split" };
        let precision = if self.precision == Precision::Single { "f32" } else { "f64" };
        let (points, error) = (self.support.support, self.predicted_error);
        format!("{method}, {nx} x {ny} x {nz} in {precision}, {points} points along an axis, error {error:.1e}")
    }

    /// The plan in words, a line each.
    pub fn describe(&self) -> String {
        self.describe_for(Turn::default())
    }

    /// The same for a reader whose axes this turn makes those of the box.
    pub fn describe_for(&self, turn: Turn) -> String {
        let [nx, ny, nz] = turn.inverse().list(self.grid);
        let [px, py, pz] = turn.inverse().list(self.support.along_axes());
        let method = match self.method {
            Method::Direct => "direct: every envelope on the grid".to_owned(),
            Method::Split { width, cutoff } => {
                format!("split: common Gaussian of width {:.5}, pairs within {:.5}", Number(width), Number(cutoff))
            }
        };
        let precision = if self.precision == Precision::Single { "f32" } else { "f64" };
        format!(
            "method     {method}\ngrid       {nx} x {ny} x {nz} points in {precision}\nsupport    {px} x {py} x {pz} points a \
             particle\ntolerance  {:.1e} asked for, {:.1e} expected\niteration  to {:.1e} in the stresslets\n",
            self.tolerance, self.predicted_error, self.iteration_tolerance
        )
    }
}
