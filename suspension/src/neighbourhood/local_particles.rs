//! Particles of a rank and their ghosts at one time.

use super::SeparatedPair;
use crate::bodies;
use bytemuck::Pod;
use domain::parallel::{FusedLoops, all_rows};
use domain::{DomainView, Halo, Neighbours, Pair, Particles, PeriodicBox, Vector};
use std::borrow::Cow;

/// Particles of a rank, followed by ghosts within a distance, at one time.
pub struct LocalParticles {
    halo: Halo,
    ids: Vec<u64>,
    /// Numbers of the bodies of particles and ghosts, `None` for those that belong to none; empty without bodies.
    bodies: Vec<Option<u32>>,
    local: LocalPositions,
}

/// Positions and radii of a rank's particles and ghosts.
pub(super) struct LocalPositions {
    cell: PeriodicBox,
    positions: Vec<Vector>,
    radii: Vec<f64>,
}

impl LocalPositions {
    /// The separation and radii of a pair.
    pub fn pair(&self, pair: &Pair) -> SeparatedPair {
        let radii = [pair.i, pair.j].map(|row| self.radii[row as usize]);
        let separation = pair.separation(&self.cell, &self.positions);
        SeparatedPair { separation, radii, steps: pair.steps.map(i32::from) }
    }
}

/// Whether two particles, by their rows, belong to the same of these bodies.
fn are_of_one(bodies: &[Option<u32>], row: usize, other: usize) -> bool {
    bodies[row].is_some() && bodies[row] == bodies[other]
}

impl LocalParticles {
    /// The particles, with ghosts within a distance of this rank's part of the box. Collective.
    pub fn new(particles: &Particles, DomainView { cell, partition }: DomainView, distance: f64) -> Self {
        let halo = Halo::plan(partition, cell, &particles.positions, [distance; 2]);
        let (mut positions, mut radii, mut ids) = (Vec::new(), Vec::new(), Vec::new());
        let mut loops = FusedLoops::default();
        loops.copied(&mut positions, &particles.positions);
        loops.copied(&mut radii, &particles.radii);
        loops.copied(&mut ids, &particles.ids);
        loops.run();
        halo.extend(&mut positions);
        halo.extend(&mut radii);
        halo.extend(&mut ids);
        let bodies = bodies::with_ghosts(particles, &halo);
        Self { halo, ids, bodies, local: LocalPositions { cell: *cell, positions, radii } }
    }

    /// Whether the particles of this rank are still the same, at the same positions in the same box.
    pub(super) fn is_of(&self, particles: &Particles, cell: &PeriodicBox) -> bool {
        let (owned, LocalPositions { cell: known, positions, radii }) = (self.owned(), &self.local);
        let (ids, now) = (&self.ids, (&particles.ids, &particles.positions, &particles.radii));
        let is_same = |row: usize| (ids[row], positions[row], radii[row]) == (now.0[row], now.1[row], now.2[row]);
        owned == particles.len() && known == cell && all_rows(owned, is_same)
    }

    /// Whether there are rigid bodies.
    pub(super) fn has_bodies(&self) -> bool {
        !self.bodies.is_empty()
    }

    /// Whether two of the particles and ghosts, by their rows, belong to the same rigid body.
    pub(super) fn are_of_one_body(&self, row: usize, other: usize) -> bool {
        are_of_one(&self.bodies, row, other)
    }

    /// Neighbours that belong to other bodies, or to none.
    pub(super) fn of_others(&self, neighbours: Neighbours) -> Neighbours {
        // Without the halo, whose communicator belongs to one thread.
        let bodies = &self.bodies;
        if self.has_bodies() { neighbours.retained(|row, other| !are_of_one(bodies, row, other)) } else { neighbours }
    }

    /// Halo of the ghosts.
    pub fn halo(&self) -> &Halo {
        &self.halo
    }

    /// Number of particles of this rank.
    pub fn owned(&self) -> usize {
        self.halo.owned()
    }

    /// Ids of particles and ghosts.
    pub fn ids(&self) -> &[u64] {
        &self.ids
    }

    /// Positions of particles and ghosts.
    pub fn positions(&self) -> &[Vector] {
        &self.local.positions
    }

    /// Radii of particles and ghosts.
    pub fn radii(&self) -> &[f64] {
        &self.local.radii
    }

    /// Positions and radii of particles and ghosts.
    pub(super) fn local(&self) -> &LocalPositions {
        &self.local
    }

    /// Values of this rank's particles, extended by those of its ghosts. Collective.
    pub fn extended<'a, T: Pod>(&self, values: &'a [T]) -> Cow<'a, [T]> {
        self.halo.extended(values)
    }
}
