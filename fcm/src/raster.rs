//! Points at which the flow of a box that does not repeat along all axes is asked for.

use crate::plan::{Plan, PlanError};
use crate::problem::Method;
use domain::{Boundaries, Vector};
use solver::Grid;

/// Points on straight lines along the axes, at equal distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// The place of the first.
    pub first: Vector,
    /// Distances along each axis.
    pub spacing: Vector,
    /// Points along x, y and z.
    pub points: [usize; 3],
}

impl Raster {
    /// The place of a point.
    pub fn point(&self, at: [usize; 3]) -> Vector {
        self.first + self.spacing * Vector::from_array(at.map(|n| n as f64))
    }

    /// The points of a plane across z, x fastest.
    pub fn plane(&self, k: usize) -> impl Iterator<Item = Vector> {
        let [nx, ny, _] = self.points;
        (0..ny).flat_map(move |j| (0..nx).map(move |i| self.point([i, j, k])))
    }
}

impl Plan {
    /// A plan for the flow itself, of a box that has the given strain if it repeats along all axes: then that is on the grid of
    /// [`Self::on_the_grid_alone`], else at the points of [`Self::raster`] by a plan [`Self::with_points`].
    pub fn of_flow(&self, strain: f64) -> Result<Self, PlanError> {
        match self.boundaries {
            Boundaries::Periodic => self.on_the_grid_alone(strain),
            _ => self.with_points(),
        }
    }

    /// Points along x, y and z where such a plan has the flow.
    pub fn points_of_flow(&self) -> [usize; 3] {
        if self.boundaries == Boundaries::Periodic { self.grid } else { self.raster(Vector::ZERO).points }
    }

    /// The same way to evaluate on a longer grid, if the box does not repeat along all axes, so that it reaches points of the
    /// fluid up to walls, and beyond open faces by twice the largest radius. An error where no grid is so long.
    pub fn with_points(&self) -> Result<Self, PlanError> {
        assert!(self.method != Method::Direct, "the direct method is for boxes that repeat along all axes");
        let mut plan = Self { beyond: Some(2.0 * self.extremes().1), ..self.clone() };
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

    /// Points of the fluid in a box whose lowest corner is at `origin`, half of the smallest radius apart where that is between half
    /// the spacing of the plan's grid and that itself, else by the nearer of these: so there are few where the grid is coarse. From wall
    /// to wall, both in it, or beyond open faces as far as a plan [`Self::with_points`] reaches; along axes along which the box
    /// repeats up to where it does.
    pub fn raster(&self, origin: Vector) -> Raster {
        let fine = 0.5 * self.extremes().0;
        let mut raster = Raster { first: origin, spacing: Vector::ZERO, points: [0; 3] };
        for axis in 0..3 {
            let edge = self.edges[axis];
            let spacing = self.spacing()[axis];
            let steps = (edge / fine.clamp(0.5 * spacing, spacing) - 1e-9).ceil();
            let spacing = edge / steps;
            let beyond = |open: bool| if open { (self.beyond.unwrap_or(0.0) / spacing).floor() } else { 0.0 };
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
