//! Box and grid that follow spheres in unbounded fluid.

use super::Dynamics;
use crate::error::step::StepError;
use crate::evaluation::prepared::{Planned, Replan};
use crate::flow::open_cell::{around, follows};
use crate::model::Model;
use crate::model::radii::Radii;
use domain::{Failure, Number, Particles, PeriodicBox};
use simulation::Clock;

/// Data for a new plan when edges of the box change.
pub(super) struct Following {
    model: Model,
    radii: Radii,
    replan: Replan,
    /// Number of evaluations of the mobility on previous grids.
    evaluations: u64,
}

impl Following {
    /// Data for replanning, if the box of the scene follows the spheres.
    pub fn of(model: &Model, radii: &Radii, replan: Replan) -> Option<Self> {
        follows(model.cell.boundaries()).then(|| Self {
            model: model.clone(),
            radii: radii.clone(),
            replan,
            evaluations: 0,
        })
    }

    /// Number of evaluations of the mobility on previous grids.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }
}

impl Dynamics {
    /// Fits the box around the particles, and replaces the grid if the edges have changed. Collective.
    pub(super) fn follow(&mut self, particles: &Particles, clock: &Clock) -> Result<(), StepError> {
        let Some(following) = &self.following else { return Ok(()) };
        let comm = self.partition.comm();
        let cell = around(&following.model.cell, particles, following.radii.largest(), comm);
        if !self.fits(&cell) {
            let edges = self.axes.list(cell.edges().to_array()).map(|edge| Number(edge).to_string()).join(" x ");
            let planned = self.planned(&cell);
            let planned = planned.map_err(|source| StepError::Box { step: clock.step(), edges, source })?;
            self.fetch(particles);
            self.adopt(&planned);
        }
        self.moving.follow(cell);
        Ok(())
    }

    /// Whether the grid matches a box.
    fn fits(&mut self, cell: &PeriodicBox) -> bool {
        self.hydrodynamics.mobility().plan().edges == cell.edges()
    }

    /// The plan for a box, if there is memory for it. Collective.
    fn planned(&self, cell: &PeriodicBox) -> Result<Planned, Failure> {
        let Some(Following { model, radii, replan, .. }) = &self.following else {
            unreachable!("only a box that follows")
        };
        replan(cell, model, radii.clone(), self.partition.comm())
    }

    fn adopt(&mut self, planned: &Planned) {
        self.partition = planned.partition(self.partition.comm());
        let done = self.hydrodynamics.mobility().work().evaluations;
        self.following.iter_mut().for_each(|following| following.evaluations += done);
        self.forces.search(self.largest_radius, &self.partition);
        self.hydrodynamics.replan(&planned.plan, &self.partition);
    }

    /// Restores the grid of the box after the box returned to an earlier state. Collective.
    pub(super) fn refit(&mut self) {
        let cell = *self.moving.cell();
        if self.following.is_some() && !self.fits(&cell) {
            let planned = self.planned(&cell).expect("it was planned before");
            self.adopt(&planned);
        }
    }
}
