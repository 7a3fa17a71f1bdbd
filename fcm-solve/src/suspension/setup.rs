//! A scene made ready: particles in place, the plan for the fluid, and who owns what.

use super::gap::Gap;
use super::initial;
use super::moving_box::MovingBox;
use super::near::smallest_gap;
use super::plan::{Radii, plan};
use crate::clock::Clock;
use anyhow::{Context, ensure};
use domain::{Comm, Particles, Partition};
use fcm::Plan;
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
    /// A scene at time zero. Collective.
    pub fn start(scene: &SuspensionScene, comm: &Comm) -> anyhow::Result<Self> {
        let particles = if comm.is_first() { initial::particles(scene) } else { Ok(Particles::default()) };
        let particles = comm.agree(particles.map_err(|e| crate::run::in_full(&e)))?;
        let setup = Self::at(scene, particles, (comm, 0))?;
        let Gap { length: gap, radius } = setup.gap();
        // Touching spheres may touch, up to the round-off of a box's length.
        ensure!(
            gap > -1e-12 * scene.cell.edges().max_element(),
            "two spheres overlap at the start, by {}; change [particles], or take fewer or smaller spheres",
            Gap { length: -gap, radius }
        );
        Ok(setup)
    }

    /// A scene after `step` steps, with all particles on the first rank. Collective.
    pub fn at(scene: &SuspensionScene, mut particles: Particles, (comm, step): (&Comm, u64)) -> anyhow::Result<Self> {
        let radii = Radii::shared(&particles, comm);
        let plan = comm.agree(plan(scene, &radii))?;
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
