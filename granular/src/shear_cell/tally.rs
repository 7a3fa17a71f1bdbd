//! Sums of impulses, work and losses over a run, from which stresses and balances follow.

use super::{CellModel, TopWall, WallContact};
use bytemuck::{Pod, Zeroable};
use domain::Vector;

/// Sums for one wall.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct WallTally {
    /// Momentum transferred from the grains to the wall.
    pub impulse: Vector,
    /// Work done by the moving wall on the grains.
    pub work: f64,
    /// Number of collisions.
    pub collisions: u64,
}

/// Sums over a run so far; a checkpoint has them in the order of the fields.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct CellTally {
    /// Sums for each wall, in the order of [`super::Side::ALL`].
    pub walls: [WallTally; 4],
    /// Momentum transferred to the grains by gravity and the curved path.
    pub body_impulse: Vector,
    /// Time since the start.
    pub time: f64,
    /// Work of gravity and the curved path.
    pub body_work: f64,
    /// Work of the load on a free top wall.
    pub load_work: f64,
    /// Energy lost in collisions.
    pub dissipated: f64,
    /// Largest overlap so far, over the diameter.
    pub largest_overlap: f64,
    /// Sum of the overlaps in collisions between grains, over the diameter.
    pub overlaps: f64,
    /// Collisions between grains.
    pub pair_collisions: u64,
    /// Collisions treated as elastic because one of the grains had collided within the contact time.
    pub elastic_collisions: u64,
}

impl CellTally {
    /// Number of all collisions.
    pub fn collisions(&self) -> u64 {
        self.pair_collisions + self.walls.iter().map(|w| w.collisions).sum::<u64>()
    }

    /// Mean overlap in a collision between grains, over the diameter.
    pub fn mean_overlap(&self) -> f64 {
        if self.pair_collisions == 0 { 0.0 } else { self.overlaps / self.pair_collisions as f64 }
    }

    /// Adds a collision with a wall: the impulse per mass on the grain, and the energy per mass that the grain
    /// gained. A free top wall recoils.
    pub(super) fn strike_wall(
        &mut self,
        model: &CellModel,
        wall: &WallContact,
        impulse: Vector,
        gain: f64,
        top_wall: &mut TopWall,
    ) {
        let mass = model.mass();
        let before = top_wall.energy(model);
        if wall.mass_ratio > 0.0 {
            top_wall.velocity -= impulse.y * wall.mass_ratio;
        }
        let held = if wall.mass_ratio > 0.0 { Vector::ZERO } else { wall.velocity };
        let sums = &mut self.walls[wall.side as usize];
        sums.impulse -= impulse * mass;
        sums.work += impulse.dot(held) * mass;
        sums.collisions += 1;
        self.dissipated += (impulse.dot(held) - gain) * mass - (top_wall.energy(model) - before);
    }
}
