//! Checks of a problem, with the reason if it can't be planned.

use crate::envelope::Envelope;
use crate::grid::window::KaiserBessel;
use crate::plan::PlanError;
use crate::plan::method::Method;
use crate::plan::problem::{Fixed, Problem};
use domain::{Boundaries, Number, PeriodicBox, Vector};
use solver::Grid;

impl Fixed {
    /// Checks the values that the user fixed against the methods and the widest envelope, of width `widest`.
    fn check(&self, widest: f64) -> Result<(), PlanError> {
        let least = |key: &str, value: Option<f64>, least: f64| match value {
            Some(value) if !(value.is_finite() && value >= least) => Err(PlanError::Fixed(format!(
                "hydrodynamics.{key} is {}; it needs to be at least {:.5}",
                Number(value),
                Number(least)
            ))),
            _ => Ok(()),
        };
        least("width", self.width, widest)?;
        least("cutoff", self.cutoff, 0.0)?;
        if self.support == Some(0) {
            return Err(PlanError::Fixed("hydrodynamics.support is 0; a stencil needs at least 1 point".to_owned()));
        }
        let [fewest, most] = KaiserBessel::POINTS;
        if let (Some(Method::Split), Some(points)) = (self.method, self.support)
            && !(fewest..=most).contains(&points)
        {
            return Err(PlanError::Fixed(format!(
                "hydrodynamics.support is {points}; the split method takes {fewest} to {most} points"
            )));
        }
        match self.iteration_tolerance {
            Some(value) if !(value > 0.0 && value < 1.0) => Err(PlanError::Fixed(format!(
                "hydrodynamics.iteration_tolerance is {}; it needs to be above 0 and below 1",
                Number(value)
            ))),
            _ => Ok(()),
        }
    }
}

/// Edges of a box for messages.
fn in_short(edges: Vector) -> String {
    edges.to_array().map(|edge| Number(edge).to_string()).join(" x ")
}

impl Problem {
    /// Error for a problem of which no candidate has become a plan.
    pub(crate) fn no_plan(&self) -> PlanError {
        if let Some(grid) = self.fixed.grid {
            return PlanError::Fixed(format!(
                "hydrodynamics.grid {grid:?} is too coarse for a box of {}; leave it out, or take more points along \
                 its longer edges",
                in_short(self.edges)
            ));
        }
        if self.fixed.width.is_some() || self.fixed.cutoff.is_some() {
            let what = "the width or the cutoff that is fixed reaches across too many edges of the box";
            return PlanError::Fixed(format!("{what}, {}; leave it out, or take less", in_short(self.edges)));
        }
        let radius = self.radii.iter().map(|r| r.0).fold(f64::INFINITY, f64::min);
        // About two points per width.
        let points = (self.edges * (2.0 / Envelope::of_sphere(radius).monopole)).element_product();
        PlanError::TooFine { radius, edges: in_short(self.edges), points }
    }

    /// Refuses choices that need a periodic box.
    fn check_bounded(&self) -> Result<(), PlanError> {
        let method = self.fixed.method.filter(|&method| method != Method::Split);
        let found = [
            method.map(|method| format!("hydrodynamics.method \"{}\" is", method.name())),
            self.fixed.grid.map(|_| "hydrodynamics.grid is".to_owned()),
            (self.largest_strain > 0.0).then(|| "a sheared box is".to_owned()),
        ];
        match found.into_iter().flatten().next() {
            Some(what) => Err(PlanError::Fixed(format!(
                "{what} for boxes that repeat along all axes; leave it out where there are walls or open faces"
            ))),
            None => Ok(()),
        }
    }

    /// Refuses a problem that no plan can solve.
    pub(crate) fn check(&self) -> Result<(), PlanError> {
        let cell = PeriodicBox::new(self.edges).map_err(|e| PlanError::Box(e.to_string()))?;
        if self.radii.iter().map(|r| r.1).sum::<usize>() == 0 {
            return Err(PlanError::NoParticles);
        }
        if let Some(&(radius, _)) = self.radii.iter().find(|(a, _)| !(a.is_finite() && *a > 0.0)) {
            return Err(PlanError::Radius(radius));
        }
        let (shortest, radius) = (self.shortest_vector, self.largest_radius());
        if shortest <= 2.0 * radius {
            return Err(PlanError::TooLarge { radius, shortest, needed: 2.0 * radius });
        }
        if !(self.viscosity > 0.0 && self.viscosity.is_finite()) {
            return Err(PlanError::Viscosity(self.viscosity));
        }
        if !(1e-12..=0.5).contains(&self.tolerance) {
            return Err(PlanError::Tolerance(self.tolerance));
        }
        if let Some(grid) = self.fixed.grid {
            Grid::new(grid, cell)?;
        }
        if self.boundaries != Boundaries::Periodic {
            self.check_bounded()?;
        }
        self.check_device()?;
        if let Some(gridless) = self.fixed.method.and_then(Method::gridless) {
            gridless.check(self)?;
        }
        if self.is_tilted() && self.fixed.method == Some(Method::Direct) {
            return Err(PlanError::Fixed(
                "hydrodynamics.method is \"direct\", which is for boxes with a lattice vector at right angles to the \
                 other two; leave it out"
                    .to_owned(),
            ));
        }
        self.fixed.check(Envelope::of_sphere(self.largest_radius()).monopole)
    }
}
