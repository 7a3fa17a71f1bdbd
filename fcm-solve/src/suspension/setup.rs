//! A scene made ready: particles in place, the plan for the fluid, and who owns what.

use super::gap::Gap;
use super::initial;
use super::memory::{self, Ranks};
use super::moving_box::MovingBox;
use super::near::smallest_gap;
use super::plan::{Radii, plan};
use crate::clock::Clock;
use anyhow::{Context, ensure};
use domain::{Comm, Particles, Partition};
use fcm::{Plan, PlanError};
use io::{Flow, Schedule, SuspensionScene};
use solver::BackgroundFlow;

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
    /// The background flow.
    pub flow: BackgroundFlow,
    /// The box.
    pub moving: MovingBox,
}

impl Setup {
    /// A scene at time zero, if there is memory to run it. Collective.
    pub fn start(scene: &SuspensionScene, comm: &Comm) -> anyhow::Result<Self> {
        let planned = Planned::of_scene(scene)?;
        planned.iter().try_for_each(|planned| planned.check_room(scene, comm))?;
        Self::placed(scene, planned, comm)
    }

    /// A scene at time zero, planned before if it counts its particles itself. Collective.
    pub fn placed(scene: &SuspensionScene, planned: Option<Planned>, comm: &Comm) -> anyhow::Result<Self> {
        let particles = if comm.is_first() { initial::particles(scene) } else { Ok(Particles::default()) };
        let particles = comm.agree(particles.map_err(|e| crate::run::in_full(&e)))?;
        let setup = match planned {
            Some(planned) => Self::of(scene, (planned, particles), (comm, 0))?,
            None => Self::at(scene, particles, (comm, 0)).context("the spheres of particles.path")?,
        };
        let Gap { length: gap, radius } = setup.gap();
        // Touching spheres may touch, up to the round-off of a box's length.
        ensure!(
            gap > -1e-12 * scene.cell.edges().max_element(),
            "two spheres overlap at the start, by {}; change [particles], or take fewer or smaller spheres",
            Gap { length: -gap, radius }
        );
        Ok(setup)
    }

    /// A scene after `step` steps, with all particles on the first rank, if there is memory to run it. Collective.
    pub fn at(scene: &SuspensionScene, particles: Particles, (comm, step): (&Comm, u64)) -> anyhow::Result<Self> {
        let planned = comm.agree(Planned::new(scene, Radii::shared(&particles, comm)))?;
        planned.check_room(scene, comm)?;
        Self::of(scene, (planned, particles), (comm, step))
    }

    fn of(
        scene: &SuspensionScene,
        (Planned { radii, plan }, mut particles): (Planned, Particles),
        (comm, step): (&Comm, u64),
    ) -> anyhow::Result<Self> {
        let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
        let (flow, box_rate) = match scene.flow {
            Flow::Shear { rate, lees_edwards } => (BackgroundFlow::shear(rate), if lees_edwards { rate } else { 0.0 }),
            _ => (BackgroundFlow::NONE, 0.0),
        };
        let time = Clock::at(step, scene.time.step).time();
        let moving = MovingBox::at(time, scene.cell, flow.gradient(), box_rate);
        if scene.output.fields != Schedule::NEVER {
            let planned = plan.on_the_grid_alone(moving.largest_strain());
            comm.agree(planned).context("output.fields_every asks for the flow on a grid")?;
        }
        particles.wrap(moving.cell());
        particles.migrate(&partition, moving.cell());
        Ok(Self { particles, radii, plan, partition, flow, moving })
    }

    /// The smallest gap between the surfaces of two particles. Collective.
    pub fn gap(&self) -> Gap {
        let length = smallest_gap(&self.particles, self.moving.cell(), &self.partition);
        Gap { length, radius: self.radii.smallest() }
    }
}

/// The radii of a scene's particles, and how the fluid is computed.
pub struct Planned {
    /// Radii of all particles.
    pub radii: Radii,
    /// How the fluid is computed.
    pub plan: Plan,
}

impl Planned {
    fn new(scene: &SuspensionScene, radii: Radii) -> Result<Self, PlanError> {
        Ok(Self { plan: plan(scene, &radii)?, radii })
    }

    /// What a scene says of itself before any particle is placed; nothing where a file has the particles.
    pub fn of_scene(scene: &SuspensionScene) -> Result<Option<Self>, PlanError> {
        Radii::of_scene(scene).map(|radii| Self::new(scene, radii)).transpose()
    }

    /// Refuses a run for which the ranks present have no memory. Collective.
    fn check_room(&self, scene: &SuspensionScene, comm: &Comm) -> anyhow::Result<()> {
        let ranks = Ranks { count: comm.size(), threads: rayon::current_num_threads() };
        let need = memory::need(scene, (&self.radii, &self.plan), ranks, comm.rank());
        Ok(comm
            .agree(comm.check_room(need).map_err(|error| format!("{error}; {}", memory::remedy(scene, &self.radii))))?)
    }
}
