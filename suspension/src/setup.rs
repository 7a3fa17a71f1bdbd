//! A scene made ready: particles in place, the plan for the fluid, and who owns what.

use crate::error::StartError;
use crate::gap::Gap;
use crate::initial;
use crate::memory;
use crate::model::{Flow, Model};
use crate::moving_box::MovingBox;
use crate::near::smallest_gap;
use crate::open_box;
use crate::plan::{Radii, plan, plan_in};
use crate::pressure_flow::PressureFlow;
use crate::relative_motion::RelativeMotion;
use crate::tethers;
use domain::{Boundaries, Comm, Failure, GivenPositions, Particles, Partition, PeriodicBox};
use fcm::{Plan, PlanError};
use hydrodynamics::Poiseuille;
use hydrodynamics::lengths::check_lubricated;
use hydrodynamics::memory::Ranks;
use simulation::Clock;

/// What a run and its outline have in common.
pub struct Setup {
    /// This rank's particles.
    pub particles: Particles,
    /// Radii of all particles.
    pub radii: Radii,
    /// How the fluid is computed.
    pub plan: Plan,
    /// Which rank owns what.
    pub partition: Partition,
    /// The box, and the background flow.
    pub moving: MovingBox,
    /// How far spheres that overlapped were moved at most, if any were.
    farthest: Option<Gap>,
}

/// Rounds in which spheres that overlap are moved apart, each of as many pushes as a neighbour list is good for.
const MOST_ROUNDS: usize = 100;

impl Setup {
    /// A scene at time zero, if there is memory to run it. Collective.
    pub fn start(model: &Model, placed: Option<GivenPositions>, comm: &Comm) -> Result<Self, StartError> {
        let planned = Planned::of_model(model)?;
        planned.iter().try_for_each(|planned| planned.check_memory(model, comm))?;
        Self::placed(model, placed, planned, comm)
    }

    /// A scene at time zero, planned before if it counts its particles itself. Collective.
    pub fn placed(
        model: &Model,
        placed: Option<GivenPositions>,
        planned: Option<Planned>,
        comm: &Comm,
    ) -> Result<Self, StartError> {
        let shared = planned.as_ref().map(|planned| initial::shared(model, &planned.partition(comm))).transpose();
        let first = || if comm.is_first() { initial::particles(model, placed) } else { Ok(Particles::default()) };
        let particles = comm.agree(shared.and_then(|shared| shared.flatten().map_or_else(first, Ok)))?;
        let mut setup = match planned {
            Some(planned) => Self::of(model, (planned, particles), (comm, 0))?,
            None => Self::at(model, particles, (comm, 0)).map_err(|error| StartError::Given(Box::new(error)))?,
        };
        if let Some(contacts) = model.contacts.filter(|_| setup.gap().length < 0.0) {
            setup.relax(contacts.roughness, comm);
        }
        let Self { particles, moving, partition, .. } = &mut setup;
        tethers::tie(particles, model, (moving.cell(), partition))?;
        let Gap { length: gap, radius } = setup.gap();
        // Touching spheres may touch, up to the round-off of a box's length.
        if gap > -1e-12 * model.cell.edges().max_element() {
            Ok(setup)
        } else {
            Err(StartError::Overlap(Gap { length: -gap, radius }))
        }
    }

    /// Moves spheres that overlap apart, until all gaps are about so many mean radii or that comes to no end. Collective.
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

    /// A scene after `step` steps, with its particles on any ranks, if there is memory to run it. Collective.
    pub fn at(model: &Model, particles: Particles, (comm, step): (&Comm, u64)) -> Result<Self, StartError> {
        let radii = Radii::shared(&particles, comm);
        let cell = open_box::of(model, &particles, (&radii, comm));
        let planned = Planned::within(&cell, model, radii, comm)?;
        Self::of(model, (planned, particles), (comm, step))
    }

    fn of(
        model: &Model,
        (planned, mut particles): (Planned, Particles),
        (comm, step): (&Comm, u64),
    ) -> Result<Self, StartError> {
        if model.hydrodynamics.lubrication {
            let (smallest, largest) = (planned.radii.smallest(), planned.radii.largest());
            check_lubricated(smallest, largest).map_err(StartError::Radii)?;
        }
        let cell = open_box::of(model, &particles, (&planned.radii, comm));
        let fits = cell == model.cell || planned.plan.edges == cell.edges();
        let Planned { radii, plan } = if fits { planned } else { Planned::within(&cell, model, planned.radii, comm)? };
        let partition = partition(&plan, comm);
        let is_straight = matches!(model.flow, Flow::Shear { lees_edwards: false, .. });
        let shears = model.cell.boundaries() == Boundaries::Periodic && !is_straight;
        let rates = model.shear_rates();
        let stress = rates.stress();
        let moving = MovingBox::at(&Clock::at(step, model.time_step), cell, rates, shears);
        let flux = model.flow.keeps_flux().then(|| PressureFlow::recalled(&particles, comm));
        let moving = moving.with_profile(profile(model)).at_constant_flux(flux);
        let moving = match model.flow.extension() {
            Some(extension) => moving.in_extension(extension),
            None => moving,
        };
        let moving = match stress {
            Some(stress) => {
                moving.driven_by((stress, model.viscosity, model.hydrodynamics.tolerance), &particles, comm)
            }
            None => moving,
        };
        if model.fields {
            let planned = plan.of_flow(moving.largest_strain());
            comm.agree(planned).map_err(StartError::Fields)?;
        }
        particles.wrap(moving.cell());
        particles.migrate(&partition, moving.cell());
        Ok(Self { particles, radii, plan, partition, moving, farthest: None })
    }

    /// What to say of spheres that overlapped and were moved apart, if any were.
    pub fn relaxed(&self) -> Option<String> {
        let farthest = self.farthest?;
        Some(format!("spheres overlap at the start; with [contacts] they are moved apart first, by {farthest} at most"))
    }

    /// The smallest gap between the surfaces of two particles. Collective.
    pub fn gap(&self) -> Gap {
        let length = smallest_gap(&self.particles, self.moving.cell(), &self.partition);
        Gap { length, radius: self.radii.smallest() }
    }
}

/// The flow that a pressure gradient drives without particles, if one does.
pub(crate) fn profile(model: &Model) -> Option<Poiseuille> {
    let height = model.cell.edges().z;
    model.flow.curvature(model.viscosity, height).map(|curvature| Poiseuille { curvature, height })
}

/// The radii of a scene's particles, and how the fluid is computed.
pub struct Planned {
    /// Radii of all particles.
    pub radii: Radii,
    /// How the fluid is computed.
    pub plan: Plan,
}

/// Which rank owns what.
fn partition(plan: &Plan, comm: &Comm) -> Partition {
    Partition::new(comm, [plan.grid[1], plan.grid[2]])
}

impl Planned {
    /// Which rank owns what.
    pub fn partition(&self, comm: &Comm) -> Partition {
        partition(&self.plan, comm)
    }

    fn new(model: &Model, radii: Radii) -> Result<Self, PlanError> {
        Ok(Self { plan: plan(model, &radii)?, radii })
    }

    /// A scene in a box that may be another than its own, if there is memory to run it there. Collective.
    pub fn within(cell: &PeriodicBox, model: &Model, radii: Radii, comm: &Comm) -> Result<Self, Failure> {
        let planned = Self { plan: comm.agree(plan_in(cell, model, &radii))?, radii };
        planned.check_memory(model, comm)?;
        Ok(planned)
    }

    /// What a scene says of itself before any particle is placed; nothing where a file has the particles.
    pub fn of_model(model: &Model) -> Result<Option<Self>, PlanError> {
        Radii::of_model(model).map(|radii| Self::new(model, radii)).transpose()
    }

    /// Refuses a run for which the ranks present have no memory. Collective.
    pub fn check_memory(&self, model: &Model, comm: &Comm) -> Result<(), Failure> {
        let ranks = Ranks { count: comm.size(), threads: rayon::current_num_threads() };
        let need = memory::need(model, (&self.radii, &self.plan), ranks, comm.rank());
        let remedy = || memory::remedy(model, &self.radii);
        comm.agree(comm.check_memory(need).map_err(|error| format!("{error}; {}", remedy())))
    }
}
