//! Per-particle state of the statistics, and its serialisation.

use super::Statistics;
use super::paths::Paths;
use super::rotations::Rotations;
use domain::{Comm, PeriodicBox, Vector};
use statistics::{Counts, Lagrangian, Profile, State, Store};
use std::ops::Range;

/// State of the particles of a block of ids, in the order of the ids.
pub struct ParticleHistory {
    pub paths: Paths,
    pub lagrangian: Lagrangian,
    /// Rotations, if some species has orientations.
    pub rotations: Option<Rotations>,
    /// Profile, in a fully periodic box.
    pub profile: Option<Profile>,
}

/// All particles of this rank's blocks at one time, with velocities relative to the flow, which moves them along some
/// axes.
#[derive(Clone, Copy)]
pub struct Moving<'a> {
    pub time: f64,
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    pub steps: &'a [[i32; 3]],
    pub velocities: &'a [Vector],
    pub advects: [bool; 3],
    /// Positions in the unstrained box.
    pub in_lattice: &'a [Vector],
    pub radii: &'a [f64],
    pub species: &'a [u32],
}

impl ParticleHistory {
    /// Adds the particles of the block at one time.
    pub fn add(&mut self, all: &Moving, rows: Range<usize>) {
        let of_rows = |all: &'_ [Vector]| all[rows.clone()].to_vec();
        let unwrapped = all.positions[rows.clone()].iter().zip(&all.steps[rows.clone()]);
        let places = unwrapped.map(|(&x, &steps)| x + all.cell.lattice(steps)).collect();
        let motions = self.paths.follow(all.time, places, of_rows(all.velocities), all.advects);
        self.lagrangian.add(all.time, &motions);
        if let Some(profile) = &mut self.profile {
            profile.add(&all.in_lattice[rows.clone()], &all.radii[rows.clone()], &all.species[rows]);
        }
    }

    /// Whether the restored state has as many particles as the block.
    fn fits(&self) -> bool {
        let is_fit = self.lagrangian.fits() && self.paths.fits(self.lagrangian.particles());
        is_fit && self.rotations.as_ref().is_none_or(Rotations::fits)
    }
}

/// One piece of the serialised statistics: the state of a block of ids, plus, in the first piece of all, everything
/// that does not belong to a block.
struct StatePiece<'a>(&'a mut Statistics, usize);

impl State for StatePiece<'_> {
    fn visit(&mut self, store: &mut dyn Store) {
        let Self(all, index) = self;
        let has_more = *index == 0 && all.blocks.comm().is_first();
        let Statistics { times, velocities, angular_velocities, kept, pairs, channel, .. } = all;
        let block = &mut kept[*index];
        if has_more {
            for number in times {
                store.number(number);
            }
            for vectors in velocities.iter_mut().chain(angular_velocities) {
                vectors.moments.visit(store);
                vectors.densities.iter_mut().for_each(|density| density.visit(store));
            }
        }
        block.paths.visit(store);
        block.lagrangian.visit(store);
        if let Some(rotations) = &mut block.rotations {
            rotations.visit(store);
        }
        if let Some(pairs) = pairs.as_mut().filter(|_| has_more) {
            pairs.visit(store);
        }
        if let Some(profile) = &mut block.profile {
            profile.visit(store);
        }
        if has_more {
            if let Some(channel) = channel {
                channel.profile.visit(store);
            }
            all.segregation.visit(store);
            if let Some(moduli) = &mut all.moduli {
                moduli.visit(store);
            }
            if let Some(pressure) = &mut all.pressure {
                pressure.visit(store);
            }
        }
    }
}

impl Statistics {
    /// Serialised state, in pieces of which each rank has those of its blocks. Collective.
    pub fn pieces(&mut self) -> Vec<Vec<u8>> {
        self.settle();
        (0..self.kept.len()).map(|index| StatePiece(self, index).save()).collect()
    }

    /// Restores a state. Returns whether this rank's pieces match. Collective.
    #[must_use]
    pub fn restore(&mut self, pieces: &[Vec<u8>]) -> bool {
        let mut fits = pieces.len() == self.kept.len();
        for (index, piece) in pieces.iter().enumerate().take(self.kept.len()) {
            fits &= StatePiece(self, index).load(piece) && self.kept[index].fits();
        }
        let mut times = self.times.to_vec();
        self.blocks.comm().broadcast(&mut times);
        self.times.copy_from_slice(&times);
        fits
    }

    /// Moves all counts that ranks accumulate separately to the first rank. Collective.
    pub(super) fn settle(&mut self) {
        let comm = self.blocks.comm();
        for vectors in self.velocities.iter_mut().chain(&mut self.angular_velocities) {
            vectors.densities.iter_mut().for_each(|density| settle(comm, density));
        }
        if let Some(pairs) = &mut self.pairs {
            settle(comm, pairs);
        }
    }
}

/// Moves the counts of all ranks to the first rank.
fn settle<C: Counts>(comm: &Comm, counts: &mut C) {
    let bytes = if comm.is_first() { Vec::new() } else { counts.save() };
    let mut sent = vec![Vec::new(); comm.size()];
    sent[0] = bytes;
    let received = comm.exchange(&sent);
    if !comm.is_first() {
        counts.clear();
        return;
    }
    for bytes in &received[1..] {
        let mut other = counts.clone();
        assert!(other.load(bytes), "ranks count the same things");
        counts.merge(&other);
    }
}
