//! Sums of impulses, works and losses over a run, from which stresses and balances follow.

use super::{Lid, Model, Side, contact::Face};
use domain::Vector;
use statistics::{State, Store};

/// One wall's part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WallTally {
    /// Momentum that the grains gave the wall.
    pub impulse: Vector,
    /// Work that the wall did on the grains by moving.
    pub work: f64,
    /// Hits.
    pub hits: u64,
}

/// Sums over a run so far.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tally {
    /// Time since the start.
    pub time: f64,
    /// By wall, in the order of [`Side::ALL`].
    pub walls: [WallTally; 4],
    /// Momentum that gravity and the curved path gave the grains.
    pub body_impulse: Vector,
    /// Their work.
    pub body_work: f64,
    /// Work of the load on a free top wall.
    pub load_work: f64,
    /// Energy lost in hits.
    pub dissipated: f64,
    /// Hits between grains.
    pub pair_hits: u64,
    /// Hits that were taken as elastic because one of the grains had been hit within the contact time.
    pub elastic_hits: u64,
    /// Largest overlap met, over the diameter.
    pub largest_overlap: f64,
    /// Sum of the overlaps met in hits between grains, over the diameter.
    pub overlaps: f64,
}

impl Tally {
    /// All hits.
    pub fn hits(&self) -> u64 {
        self.pair_hits + self.walls.iter().map(|w| w.hits).sum::<u64>()
    }

    /// Mean overlap met in a hit between grains, over the diameter.
    pub fn mean_overlap(&self) -> f64 {
        if self.pair_hits == 0 { 0.0 } else { self.overlaps / self.pair_hits as f64 }
    }
}

impl Tally {
    /// Adds a collision with a wall: the impulse per mass on the grain, and the energy per mass that the grain gained.
    /// A free top wall takes the recoil.
    pub(super) fn strike_wall(
        &mut self,
        model: &Model,
        (side, face): (Side, &Face),
        impulse: Vector,
        gain: f64,
        lid: &mut Lid,
    ) {
        let mass = model.mass();
        let before = lid.energy(model);
        if face.mass_ratio > 0.0 {
            lid.velocity -= impulse.y * face.mass_ratio;
        }
        let held = if face.mass_ratio > 0.0 { Vector::ZERO } else { face.velocity };
        let wall = &mut self.walls[side as usize];
        wall.impulse -= impulse * mass;
        wall.work += impulse.dot(held) * mass;
        wall.hits += 1;
        self.dissipated += (impulse.dot(held) - gain) * mass - (lid.energy(model) - before);
    }
}

impl State for Tally {
    fn visit(&mut self, store: &mut dyn Store) {
        let Self { time, walls, body_impulse, body_work, load_work, dissipated, largest_overlap, overlaps, .. } = self;
        for WallTally { impulse, work, hits } in walls {
            impulse.as_mut().iter_mut().for_each(|component| store.number(component));
            store.number(work);
            store.count(hits);
        }
        body_impulse.as_mut().iter_mut().for_each(|component| store.number(component));
        for number in [time, body_work, load_work, dissipated, largest_overlap, overlaps] {
            store.number(number);
        }
        store.count(&mut self.pair_hits);
        store.count(&mut self.elastic_hits);
    }
}
