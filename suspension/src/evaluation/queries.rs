//! Queries of the present state of the dynamics.

use super::Dynamics;
use super::following::Following;
use crate::evaluation::velocity_field::{self, FluidVelocity, LoadedSpheres};
use crate::forces::Forces;
use crate::forces::contacts::ContactStatistics;
use domain::{Boundaries, DomainView, Particles, Partition, PeriodicBox, Tensor};
use fcm::{PlanError, PlanIdentity};
use lubrication::LubricationRange;
use solver::BackgroundFlow;

impl Dynamics {
    /// Gaps at which lubrication acts, if it does.
    pub fn lubrication(&self) -> Option<LubricationRange> {
        self.lubrication
    }

    /// Lower bounds of gaps, over the mean radius, in the relative loss and in the relative error of a gap: with
    /// lubrication its minimum gap and the tolerance, otherwise the range of the repulsion.
    pub fn least_gaps(&self, tolerance: f64) -> [f64; 2] {
        self.lubrication.map_or([self.forces.repulsion_range(); 2], |range| [range.minimum_gap(), tolerance])
    }

    /// Present box.
    pub fn cell(&self) -> &PeriodicBox {
        self.moving.cell()
    }

    /// Partition of space among ranks.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Box and partition.
    pub fn domain(&self) -> DomainView<'_> {
        DomainView { cell: self.moving.cell(), partition: &self.partition }
    }

    /// All forces, to be changed.
    pub fn forces_mut(&mut self) -> &mut Forces {
        &mut self.forces
    }

    /// All forces.
    pub fn forces(&self) -> &Forces {
        &self.forces
    }

    /// Shear stress on each wall, see [`crate::Suspension::wall_stress`]. Collective.
    pub fn wall_stress(&self, particles: &Particles, stress: &Tensor) -> Vec<[f64; 2]> {
        let cell = self.cell();
        let mut sums = self.forces.external.sums_along_walls(particles);
        self.partition.comm().sum(&mut sums);
        let [fx, fy, mx, my] = sums.map(|sum| sum / cell.volume());
        let flow = [self.viscosity * self.moving.rate(), 0.0];
        let height = cell.edges().z;
        let driven = self
            .moving
            .total_poiseuille()
            .map_or([0.0; 2], |p| [0.0, height].map(|z| self.viscosity * p.shear_rate(z)));
        let upper = [flow[0] + driven[1] + stress.col(2).x - mx, flow[1] + stress.col(2).y - my];
        let forces = [fx * height + driven[0] - driven[1], fy * height];
        match cell.boundaries() {
            Boundaries::Walls => vec![[upper[0] + forces[0], upper[1] + forces[1]], upper],
            Boundaries::Wall => vec![[flow[0] + forces[0], flow[1] + forces[1]]],
            _ => Vec::new(),
        }
    }

    /// Pressure gradient at constant flux; `None` if the flux is not kept.
    pub fn pressure_gradient(&self) -> Option<f64> {
        let flow = self.moving.total_poiseuille().filter(|_| self.moving.keeps_flux())?;
        Some(self.viscosity * flow.curvature)
    }

    /// Averages and totals over contacts; `None` for spheres without contacts. Collective.
    pub fn contact_statistics(&self, particles: &Particles) -> Option<ContactStatistics> {
        self.forces.contacts.as_ref().map(|contacts| contacts.measured(particles, self.domain(), self.forces.lists()))
    }

    /// Smallest gap between two particles, or between a particle and a wall. Collective.
    pub fn smallest_gap(&self, particles: &Particles) -> f64 {
        self.forces.lists().smallest_gap(particles, self.domain(), self.largest_radius)
    }

    /// Background flow.
    pub fn flow(&self) -> &BackgroundFlow {
        self.moving.flow()
    }

    /// Largest weight of the negative eigenvalues that were left out of random motions so far, relative to the total.
    pub fn clipped(&self) -> f64 {
        self.clipped
    }

    /// Description of the numerical method.
    pub fn plan(&mut self) -> String {
        let turn = self.axes.turn();
        self.hydrodynamics.mobility().plan().describe_for(turn)
    }

    /// Whether a description stands for the present numerical method.
    pub fn has_plan(&mut self, description: &str) -> bool {
        let present = PlanIdentity::of(self.hydrodynamics.mobility().plan(), self.axes.turn());
        PlanIdentity::read(description).is_some_and(|plan| plan.is_same(&present))
    }

    /// Number of evaluations of the mobility since the start.
    pub fn evaluations(&mut self) -> u64 {
        let before = self.following.as_ref().map_or(0, Following::evaluations);
        before + self.hydrodynamics.mobility().work().evaluations
    }

    /// Largest `|k . u| / (|k| |u|)` over all wavevectors of the last computed flow; `None` unless the box is fully
    /// periodic. Collective.
    pub fn divergence(&mut self) -> Option<f64> {
        let is_periodic = self.cell().boundaries() == Boundaries::Periodic;
        is_periodic.then(|| self.hydrodynamics.mobility().divergence()).flatten()
    }

    /// Velocity of the fluid relative to the background flow at the present positions and time. Fails if no grid can
    /// resolve it. Collective.
    pub fn velocity_field(&mut self, particles: &Particles, time: f64) -> Result<FluidVelocity, PlanError> {
        let loads = self.forces.present_loads(particles, self.domain(), time);
        let loads = self.warm_start.loads_on_fluid(loads, particles);
        // The grid for the largest strain: plotting programs expect all frames of a series to have the same size.
        let plan = self.hydrodynamics.mobility().plan().of_flow(self.moving.largest_strain())?;
        let quadrupoles =
            self.squirming(particles).map(|squirming| squirming.quadrupoles(self.viscosity, &particles.radii));
        let (cell, quadrupoles) = (self.moving.cell(), quadrupoles.as_deref());
        let spheres = LoadedSpheres { cell, particles, loads: &loads, quadrupoles };
        Ok(velocity_field::velocity(&plan, &spheres, self.moving.flux_correction(), self.partition.comm()))
    }
}
