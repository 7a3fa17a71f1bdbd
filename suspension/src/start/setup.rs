//! Preparation of a scene: placed particles, the plan of the far field, and the partition.

use crate::error::StartError;
use crate::error::gap::Gap;
use crate::evaluation::gap_control::RelativeMotion;
use crate::evaluation::prepared::{Planned, Setup, partition};
use crate::flow::constant_flux::ConstantFluxState;
use crate::flow::open_cell;
use crate::flow::periodic_cell::PeriodicCell;
use crate::flow::stress_control::StressTarget;
use crate::forces::tethers;
use crate::model::radii::Radii;
use crate::model::{Flow, Model};
use crate::start::memory;
use crate::start::orientations;
use crate::start::placement;
use crate::start::plan::{plan, plan_in, problem_in};
use domain::{Boundaries, Comm, DomainView, Failure, GivenPositions, Particles, PeriodicBox};
use fcm::{CardRanks, PlanError};
use hydrodynamics::lengths::check_lubricated;
use hydrodynamics::memory::Ranks;
use simulation::Clock;

/// Largest number of rounds in which overlapping spheres are moved apart, each with a new neighbour list.
const MOST_ROUNDS: usize = 100;

impl Setup {
    /// Prepares a scene at time zero, if there is memory to run it. Collective.
    pub fn start(model: &Model, placed: Option<GivenPositions>, comm: &Comm) -> Result<Self, StartError> {
        let planned = Planned::of_model(model)?;
        planned.iter().try_for_each(|planned| planned.check_memory(model, comm))?;
        Self::placed(model, placed, planned, comm)
    }

    /// Prepares a scene at time zero, with a plan if the scene gives the numbers of particles. Collective.
    pub fn placed(
        model: &Model,
        placed: Option<GivenPositions>,
        planned: Option<Planned>,
        comm: &Comm,
    ) -> Result<Self, StartError> {
        let partition = planned.as_ref().map(|planned| planned.partition(comm));
        let mut particles = placement::particles(model, placed, partition.as_ref(), comm)?;
        orientations::start(&mut particles, model, comm);
        let mut setup = match planned {
            Some(planned) => Self::of(model, planned, particles, comm, 0)?,
            None => Self::at(model, particles, comm, 0).map_err(|error| StartError::Given(Box::new(error)))?,
        };
        if let Some(contacts) = model.contacts.filter(|_| setup.gap().length < 0.0) {
            setup.relax(contacts.roughness, comm);
        }
        let Self { particles, moving, partition, .. } = &mut setup;
        tethers::tie(particles, model, DomainView { cell: moving.cell(), partition })?;
        let Gap { length: gap, radius } = setup.gap();
        // Touching spheres are allowed, up to round-off of the box's edges.
        if gap > -1e-12 * model.cell.edges().max_element() {
            Ok(setup)
        } else {
            Err(StartError::Overlap(Gap { length: -gap, radius }))
        }
    }

    /// Moves overlapping spheres apart until all gaps are about `gap` mean radii, or until the rounds are used up.
    /// Collective.
    fn relax(&mut self, gap: f64, comm: &Comm) {
        let mut farthest = 0.0_f64;
        for _ in 0..MOST_ROUNDS {
            let approach = RelativeMotion::find(&mut self.particles, &self.moving, &self.partition, []);
            let (displacements, is_done) = approach.pushed([], gap, comm);
            let moved = displacements.iter().map(|displacement| displacement.length()).fold(0.0, f64::max);
            for (position, displacement) in self.particles.positions.iter_mut().zip(displacements) {
                *position += displacement;
            }
            self.particles.wrap(self.moving.cell());
            self.particles.migrate(&self.partition, self.moving.cell());
            let mut largest = [moved];
            comm.max(&mut largest);
            farthest += largest[0];
            if is_done && largest[0] == 0.0 {
                break;
            }
        }
        self.farthest = Some(Gap { length: farthest, radius: self.radii.smallest() });
    }

    /// Prepares a scene after `step` steps, with its particles on any ranks, if there is memory to run it. Collective.
    pub fn at(model: &Model, particles: Particles, comm: &Comm, step: u64) -> Result<Self, StartError> {
        let radii = Radii::shared(&particles, comm);
        let cell = open_cell::of(model, &particles, &radii, comm);
        let planned = Planned::within(&cell, model, radii, comm)?;
        Self::of(model, planned, particles, comm, step)
    }

    fn of(
        model: &Model,
        planned: Planned,
        mut particles: Particles,
        comm: &Comm,
        step: u64,
    ) -> Result<Self, StartError> {
        if model.hydrodynamics.lubrication {
            let (smallest, largest) = (planned.radii.smallest(), planned.radii.largest());
            check_lubricated(smallest, largest).map_err(StartError::Radii)?;
        }
        let cell = open_cell::of(model, &particles, &planned.radii, comm);
        let fits = cell == model.cell || planned.plan.edges == cell.edges();
        let Planned { radii, plan } = if fits { planned } else { Planned::within(&cell, model, planned.radii, comm)? };
        let partition = partition(&plan, comm);
        let is_straight = matches!(model.flow, Flow::Shear { lees_edwards: false, .. });
        let shears = model.cell.boundaries() == Boundaries::Periodic && !is_straight;
        let rates = model.shear_rates();
        let stress = rates.stress();
        let moving = PeriodicCell::at(&Clock::at(step, model.time_step), cell, rates, shears);
        let flux = model.flow.keeps_flux().then(|| ConstantFluxState::restored(&particles.scalars));
        let moving = moving.with_profile(model.poiseuille()).at_constant_flux(flux);
        let moving = match model.flow.extension() {
            Some(extension) => moving.in_extension(extension),
            None => moving,
        };
        let moving = match stress {
            Some(stress) => {
                let (viscosity, tolerance) = (model.viscosity, model.hydrodynamics.tolerance);
                moving.under_stress(StressTarget { stress, viscosity, tolerance }, &particles.scalars)
            }
            None => moving,
        };
        if model.fields {
            let planned = plan.of_flow(moving.largest_strain());
            comm.agree(planned).map_err(StartError::Fields)?;
        }
        particles.wrap(moving.cell());
        particles.migrate(&partition, moving.cell());
        let problem = problem_in(&cell, model, &radii);
        Ok(Self { particles, radii, plan, problem, partition, moving, farthest: None, replan: Planned::within })
    }
}

impl Planned {
    fn new(model: &Model, radii: Radii) -> Result<Self, PlanError> {
        Ok(Self { plan: plan(model, &radii)?, radii })
    }

    /// Plans a scene in a box that may differ from its own, if there is memory for it. Collective.
    pub fn within(cell: &PeriodicBox, model: &Model, radii: Radii, comm: &Comm) -> Result<Self, Failure> {
        let planned = Self { plan: comm.agree(plan_in(cell, model, &radii))?, radii };
        planned.check_memory(model, comm)?;
        Ok(planned)
    }

    /// Plans a model before any particle is placed; `None` if a file determines the particles.
    pub fn of_model(model: &Model) -> Result<Option<Self>, PlanError> {
        Radii::of_model(model).map(|radii| Self::new(model, radii)).transpose()
    }

    fn check_device(&self, model: &Model, comm: &Comm) -> Result<(), PlanError> {
        memory::card(model, &self.radii, &self.plan, CardRanks::Present(comm))?.map_or(Ok(()), |card| card.check())
    }

    /// Refuses a run for which the present ranks or their device do not have the memory, or whose device serves fewer
    /// ranks. Collective.
    pub fn check_memory(&self, model: &Model, comm: &Comm) -> Result<(), Failure> {
        comm.agree(self.check_device(model, comm))?;
        let ranks = Ranks { count: comm.size(), threads: rayon::current_num_threads() };
        let need = memory::need(model, &self.radii, &self.plan, ranks, comm.rank());
        let advice = || memory::advice(model, &self.radii);
        comm.agree(comm.check_memory(need).map_err(|error| format!("{error}; {}", advice())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{Place, Vector};
    use fcm::ComputeDevice;

    /// Ranks take cards in turn, so that two need no more than one; without a card, both say so.
    #[test]
    fn ranks_share_cards() {
        let cell = PeriodicBox::new(Vector::splat(20.0)).unwrap();
        let model = Model::new(Parameters::new(cell, 1.0, vec![Species::new("a", 1.0, 9)], 0.1, 1)).unwrap();
        let mut planned = Planned::of_model(&model).unwrap().unwrap();
        planned.plan.device = ComputeDevice::Gpu;
        let refusals = |ranks| Comm::threads(ranks, |comm| planned.check_memory(&model, &comm).map_err(|e| e.message));
        let expected = ComputeDevice::Gpu.check_present().err();
        for refusal in [1, 2].into_iter().flat_map(refusals) {
            match (&expected, refusal) {
                (None, refusal) => assert_eq!(refusal.err(), None),
                (Some(reason), Err(found)) => assert!(found.contains(reason), "{found}"),
                (Some(reason), Ok(())) => panic!("not refused, although {reason}"),
            }
        }
        let [y, z] = [planned.plan.grid[1], planned.plan.grid[2]];
        let ranks = (1..99).find(|&ranks| Place::of(ranks, 0, [y, z]).table()[0] > 1).unwrap();
        for refusal in refusals(ranks) {
            assert!(refusal.unwrap_err().contains(&format!("there are {ranks} ranks, and ")));
        }
    }
}
