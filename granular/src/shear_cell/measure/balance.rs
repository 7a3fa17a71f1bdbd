//! Balances of energy and momentum, as a check of a run.

use super::super::{CellModel, Engine, Grains};
use bytemuck::{Pod, Zeroable};
use domain::Vector;

/// The relative errors of the balances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// Change of energy minus the work of walls, load, gravity and curved path, plus the losses in collisions.
    pub energy: f64,
    /// Change of momentum minus the impulses of walls, gravity and curved path.
    pub momentum: f64,
}

/// Energy and momentum at the start.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct InitialBalance {
    energy: f64,
    momentum: Vector,
}

impl InitialBalance {
    pub fn new(model: &CellModel, engine: &Engine) -> Self {
        let grains = engine.grains();
        Self { energy: grains.energy(model) + engine.top_wall().energy(model), momentum: grains.momentum(model) }
    }

    /// The same where a user has replaced the grains of a later time by others.
    pub fn with_replaced(self, model: &CellModel, [before, after]: [&Grains; 2]) -> Self {
        Self {
            energy: self.energy + after.energy(model) - before.energy(model),
            momentum: self.momentum + after.momentum(model) - before.momentum(model),
        }
    }

    /// The balance from the start of the engine's tally until now.
    pub fn balance(&self, model: &CellModel, engine: &Engine) -> Balance {
        let (now, tally) = (Self::new(model, engine), engine.tally());
        let work = tally.walls.map(|w| w.work).into_iter().chain([tally.body_work, tally.load_work, -tally.dissipated]);
        let (given, handled) = work.fold((0.0, self.energy), |(sum, size), w| (sum + w, size + w.abs()));
        let impulses = tally.walls.map(|w| -w.impulse).into_iter().chain([tally.body_impulse]);
        let speed = model.mass() * engine.grains().motions.iter().map(|m| m.velocity.length()).sum::<f64>();
        let (pushed, moved) = impulses.fold((Vector::ZERO, speed), |(sum, size), p| (sum + p, size + p.length()));
        let relative = |left: f64, size: f64| if size > 0.0 { left / size } else { left };
        Balance {
            energy: relative((now.energy - self.energy - given).abs(), handled),
            momentum: relative((now.momentum - self.momentum - pushed).length(), moved),
        }
    }
}
