//! Points at which the flow is evaluated in a box that is not periodic along all axes.

use crate::plan::method::Method;
use crate::plan::{Plan, PlanError};
use domain::{Boundaries, Vector};
use solver::Grid;

/// Equally spaced points on a rectangular raster along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SamplePoints {
    /// Position of the first point.
    pub first: Vector,
    /// Distances along each axis.
    pub spacing: Vector,
    /// Number of points along x, y and z.
    pub points: [usize; 3],
}

impl SamplePoints {
    /// Position of a point.
    pub fn point(&self, at: [usize; 3]) -> Vector {
        self.first + self.spacing * Vector::from_array(at.map(|n| n as f64))
    }

    /// Points of a plane across z, x fastest.
    pub fn plane(&self, k: usize) -> impl Iterator<Item = Vector> {
        let [nx, ny, _] = self.points;
        (0..ny).flat_map(move |j| (0..nx).map(move |i| self.point([i, j, k])))
    }
}

impl Plan {
    /// Plan for the velocity field of the fluid. In a box that is periodic along all axes, which has the given
    /// strain, the field is on the grid of [`Self::on_the_grid_alone`]; otherwise it is at the points of
    /// [`Self::raster`] by a plan [`Self::with_points`].
    pub fn of_flow(&self, strain: f64) -> Result<Self, PlanError> {
        match self.boundaries {
            Boundaries::Periodic => self.on_the_grid_alone(strain),
            _ => self.with_points(),
        }
    }

    /// Number of points along x, y and z at which such a plan has the flow.
    pub fn points_of_flow(&self) -> [usize; 3] {
        if self.boundaries == Boundaries::Periodic { self.grid } else { self.raster(Vector::ZERO).points }
    }

    /// The same evaluation on a longer grid, if the box is not periodic along all axes, such that it reaches points
    /// of the fluid up to walls, and beyond open faces by twice the largest radius. Fails if no grid is long enough.
    pub fn with_points(&self) -> Result<Self, PlanError> {
        assert!(self.method != Method::Direct, "the direct method is for boxes that repeat along all axes");
        let mut plan = Self { fluid_margin: Some(2.0 * self.extremes().1), ..self.clone() };
        let spacing = self.spacing();
        for axis in (0..3).filter(|&axis| !self.boundaries.is_periodic(axis)) {
            let longer = plan.span(axis)[1] - plan.span(axis)[0] - (self.span(axis)[1] - self.span(axis)[0]);
            let times = if self.boundaries == Boundaries::Open { 2.0 } else { 1.0 };
            let points = self.grid[axis] as f64 + times * longer / spacing[axis];
            let needed = (points - 1e-9).ceil() as usize;
            plan.grid[axis] = if needed > Grid::MOST { needed } else { Grid::good_size(needed) };
            plan.period[axis] = plan.grid[axis] as f64 * spacing[axis];
        }
        Grid::new(plan.grid, plan.cell())?;
        Ok(plan)
    }

    /// Points of the fluid in a box whose lowest corner is at `origin`. Their distance is half the smallest radius,
    /// clamped to between half the spacing of the plan's grid and that spacing, so a coarse grid gives few points.
    /// They extend from wall to wall inclusive, or beyond open faces as far as a plan [`Self::with_points`] reaches;
    /// along periodic axes over one period.
    pub fn raster(&self, origin: Vector) -> SamplePoints {
        let fine = 0.5 * self.extremes().0;
        let mut raster = SamplePoints { first: origin, spacing: Vector::ZERO, points: [0; 3] };
        for axis in 0..3 {
            let edge = self.edges[axis];
            let spacing = self.spacing()[axis];
            let steps = (edge / fine.clamp(0.5 * spacing, spacing) - 1e-9).ceil();
            let spacing = edge / steps;
            let beyond = |open: bool| if open { (self.fluid_margin.unwrap_or(0.0) / spacing).floor() } else { 0.0 };
            let walls = self.boundaries.walls();
            let (below, above) = (beyond(walls == 0), beyond(walls < 2));
            let is_periodic = self.boundaries.is_periodic(axis);
            raster.spacing[axis] = spacing;
            raster.points[axis] = if is_periodic { steps } else { steps + 1.0 + below + above } as usize;
            if !is_periodic {
                raster.first[axis] -= below * spacing;
            }
        }
        raster
    }
}
