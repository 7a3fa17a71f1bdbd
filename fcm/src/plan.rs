//! How an evaluation is to be made: grid, supports, cutoff, precision.

use crate::accuracy::{self, Accuracy};
use crate::cost;
use crate::envelope::Envelope;
use crate::passes::STEP;
use crate::problem::{Fixed, Method, MethodName, Multipoles, Precision, Problem};
use crate::stencil::Support;
use domain::{PeriodicBox, Vector};
use solver::Grid;

/// Why there is no plan.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PlanError {
    /// No particles at all.
    #[error("there are no particles; a scene needs at least one")]
    NoParticles,
    /// A radius that is none.
    #[error("a particle has the radius {0}; radii need to be positive and finite")]
    Radius(f64),
    /// A particle that meets itself.
    #[error(
        "a particle of radius {radius} does not fit the box, whose shortest edge is {edge}; it needs more than {needed}"
    )]
    TooLarge {
        /// The radius.
        radius: f64,
        /// The box's shortest edge.
        edge: f64,
        /// The least edge for that radius.
        needed: f64,
    },
    /// A viscosity that is none.
    #[error("the viscosity is {0}; it needs to be positive and finite")]
    Viscosity(f64),
    /// A box that is none.
    #[error("the box: {0}")]
    Box(String),
    /// A tolerance out of range.
    #[error("the tolerance is {0}; it needs to be between 1e-12 and 0.5")]
    Tolerance(f64),
    /// A fixed grid that can't be transformed.
    #[error("hydrodynamics.grid: {0}")]
    Grid(#[from] solver::GridError),
    /// Fixed choices that contradict each other.
    #[error("{0}")]
    Fixed(String),
}

/// How an evaluation is made.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Edges of the box.
    pub edges: Vector,
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

    /// Plans that keep the tolerance, the fastest first: the best of each method and precision.
    pub fn ranked(problem: &Problem) -> Result<Vec<Self>, PlanError> {
        problem.check()?;
        let mut plans: Vec<Self> = problem.candidates().into_iter().map(|accuracy| problem.best(&accuracy)).collect();
        plans.retain(|plan| plan.grid.iter().all(|&n| n >= 2));
        if let (Some(grid), true) = (problem.fixed.grid, plans.is_empty()) {
            return Err(PlanError::Fixed(format!("hydrodynamics.grid {grid:?} is too small for these particles")));
        }
        plans.sort_by(|a, b| a.predicted_seconds.total_cmp(&b.predicted_seconds));
        Ok(plans)
    }

    /// A plan for the flow itself, which needs every envelope on the grid, in a box of the given strain. Its error is
    /// a percent at most.
    ///
    /// # Panics
    /// Never: what could be planned can be planned directly.
    #[must_use]
    pub fn on_the_grid_alone(&self, strain: f64) -> Self {
        let problem = Problem {
            edges: self.edges,
            largest_strain: strain.abs(),
            radii: self.radii.iter().map(|&radius| (radius, 1)).collect(),
            viscosity: self.viscosity,
            multipoles: self.multipoles,
            rigid: false,
            tolerance: self.tolerance.clamp(1e-6, 1e-2),
            threads: 1,
            ranks: 1,
            fixed: Fixed { method: Some(MethodName::Direct), ..Fixed::default() },
        };
        Self::choose(&problem).expect("a problem that was planned before")
    }

    /// The box, not sheared.
    pub fn cell(&self) -> PeriodicBox {
        PeriodicBox::new(self.edges).expect("a plan has a box")
    }

    /// Distances between grid points.
    pub(crate) fn spacing(&self) -> Vector {
        self.edges / Vector::from_array(self.grid.map(|n| n as f64))
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

    /// Bytes that a rank needs for its share of the grid.
    pub fn grid_bytes_per_rank(&self, ranks: usize) -> u64 {
        let size = if self.precision == Precision::Single { 4 } else { 8 };
        let copies = if ranks > 1 { 3 } else { 1 };
        let points = self.grid.iter().map(|&n| n as u64).product::<u64>();
        let row = (self.grid[0] + self.support.lanes) as u64;
        copies * size * 3 * points / self.grid[0] as u64 * row / ranks as u64
    }

    /// The plan in words, a line each.
    pub fn describe(&self) -> String {
        let [nx, ny, nz] = self.grid;
        let method = match self.method {
            Method::Direct => "direct: every envelope on the grid".to_owned(),
            Method::Split { width, cutoff } => {
                format!("split: common Gaussian of width {width:.4}, pairs within {cutoff:.4}")
            }
        };
        let precision = if self.precision == Precision::Single { "f32" } else { "f64" };
        format!(
            "method     {method}\ngrid       {nx} x {ny} x {nz} points in {precision}\nsupport    {} x {} x {} points a \
             particle\ntolerance  {:.1e} asked for, {:.1e} expected\niteration  to {:.1e} in the stresslets\n",
            self.support.lanes,
            self.support.support,
            self.support.support,
            self.tolerance,
            self.predicted_error,
            self.iteration_tolerance
        )
    }
}

/// So that 300 random cases of up to 48 particles (`fcm/tests`) and `fcm-solve bench` at 600 and 3,200 come out
/// below the tolerance: 1.1 times below in the worst of them, about six times in a typical one.
const MONOPOLE_LEEWAY: f64 = 1.2;
const GIVEN_LEEWAY: f64 = 0.5;
const RIGID_LEEWAY: f64 = 0.22;

/// One way to keep a tolerance: a method, a precision and what they need.
struct Candidate {
    method: MethodName,
    precision: Precision,
    accuracy: Accuracy,
}

impl Problem {
    pub(crate) fn largest_radius(&self) -> f64 {
        self.radii.iter().map(|r| r.0).fold(0.0, f64::max)
    }

    fn smallest_radius(&self) -> f64 {
        self.radii.iter().map(|r| r.0).fold(f64::INFINITY, f64::min)
    }

    fn particles(&self) -> usize {
        self.radii.iter().map(|r| r.1).sum()
    }

    fn candidates(&self) -> Vec<Candidate> {
        let mut all = Vec::new();
        for method in [MethodName::Split, MethodName::Direct] {
            for precision in [Precision::Single, Precision::Double] {
                let allowed = self.fixed.method.is_none_or(|m| m == method)
                    && self.fixed.precision.unwrap_or(precision) == precision;
                let enough = precision == Precision::Double
                    || self.tolerance >= crate::accuracy::FINEST_SINGLE
                    || self.fixed.precision.is_some();
                if allowed && enough {
                    for accuracy in Accuracy::options(method, self.tolerance * self.leeway()) {
                        all.push(Candidate { method, precision, accuracy });
                    }
                }
            }
        }
        all
    }

    /// The tolerance over the error that its hardest part may have. The bounds are those of gradients; with forces
    /// alone, velocities come out better. The stresslets of rigid spheres answer to rates of strain that may be small
    /// beside the loads' own, and come out worse.
    fn leeway(&self) -> f64 {
        match (self.multipoles, self.rigid) {
            (Multipoles::Monopole, _) => MONOPOLE_LEEWAY,
            (Multipoles::Dipole, false) => GIVEN_LEEWAY,
            (Multipoles::Dipole, true) => RIGID_LEEWAY,
        }
    }

    fn best(&self, candidate: &Candidate) -> Plan {
        let widths = match candidate.method {
            MethodName::Direct => vec![self.narrowest()],
            MethodName::Split => self.widths(&candidate.accuracy),
        };
        let plans = widths.into_iter().map(|width| self.plan(candidate, width));
        plans.min_by(|a, b| a.predicted_seconds.total_cmp(&b.predicted_seconds)).expect("at least one width")
    }

    fn narrowest(&self) -> f64 {
        let envelope = Envelope::of_sphere(self.smallest_radius());
        match self.multipoles {
            Multipoles::Monopole => envelope.monopole,
            Multipoles::Dipole => envelope.dipole,
        }
    }

    /// Common widths worth trying: one for each good number of points along the longest edge.
    fn widths(&self, accuracy: &Accuracy) -> Vec<f64> {
        let least = Envelope::of_sphere(self.largest_radius()).monopole;
        if let Some(width) = self.fixed.width {
            return vec![width];
        }
        let resolution = accuracy.resolution;
        if let Some(grid) = self.fixed.grid {
            let spacing = (self.edges / Vector::from_array(grid.map(|n| n as f64))).max_element();
            return vec![(spacing * resolution * self.stretch()).max(least)];
        }
        let longest = self.edges.max_element();
        let mut widths = Vec::new();
        let mut points = 7;
        loop {
            points = Grid::good_size(points + 1);
            let width = longest / points as f64 * resolution;
            if width < least {
                break;
            }
            widths.push(width);
        }
        widths.push(least);
        widths
    }

    /// A grid sheared by `s` resolves `sqrt(1 + s^2)` less along y, and a sphere reaches as much farther along the
    /// lattice coordinate of x.
    fn stretch(&self) -> f64 {
        (1.0 + self.largest_strain * self.largest_strain).sqrt()
    }

    fn plan(&self, candidate: &Candidate, width: f64) -> Plan {
        let accuracy = &candidate.accuracy;
        let grid = self.fixed.grid.unwrap_or_else(|| {
            let sheared = Vector::new(1.0, self.stretch(), 1.0);
            let needed = self.edges / width * accuracy.resolution * sheared;
            needed.to_array().map(|n| Grid::good_size((n - 1e-9).ceil() as usize))
        });
        let spacing = self.edges / Vector::from_array(grid.map(|n| n as f64));
        let widest = match candidate.method {
            MethodName::Split => width,
            MethodName::Direct => Envelope::of_sphere(self.largest_radius()).monopole,
        };
        let points = |h: f64| (2.0 * accuracy.reach * widest / h - 1e-9).ceil() as usize;
        let support = self.fixed.support.unwrap_or_else(|| points(spacing.y).max(points(spacing.z)));
        let along_x = self.fixed.support.unwrap_or_else(|| points(spacing.x / self.stretch()));
        let reach =
            self.fixed.support.map_or(accuracy.reach * widest, |points| 0.5 * points as f64 * spacing.max_element());
        let support = Support { lanes: along_x.next_multiple_of(STEP), support, reach };
        let method = match candidate.method {
            MethodName::Direct => Method::Direct,
            MethodName::Split => Method::Split { width, cutoff: self.fixed.cutoff.unwrap_or(accuracy.cutoff * width) },
        };
        let mut radii: Vec<f64> = self.radii.iter().map(|r| r.0).collect();
        radii.sort_by(f64::total_cmp);
        radii.dedup();
        let mut plan = Plan {
            edges: self.edges,
            radii,
            viscosity: self.viscosity,
            multipoles: self.multipoles,
            tolerance: self.tolerance,
            iteration_tolerance: self.fixed.iteration_tolerance.unwrap_or(0.25 * self.tolerance),
            method,
            precision: candidate.precision,
            grid,
            support,
            predicted_error: accuracy::expected(
                candidate.method,
                width / (spacing * Vector::new(1.0, self.stretch(), 1.0)).max_element(),
                support.reach / widest,
                method.cutoff() / width,
            ),
            predicted_seconds: 0.0,
        };
        plan.predicted_seconds = cost::seconds(&plan, self.particles(), self.largest_strain, self.ranks * self.threads);
        plan
    }
}
