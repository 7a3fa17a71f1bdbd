//! Neighbour lists of near pairs, and the particles that they follow.

use domain::parallel::{FusedLoops, all_rows, stage};
use domain::{DomainView, Halo, LocalAndGhosts, Neighbours, Particles, Partition, PeriodicBox, Vector, VerletList};
use std::rc::Rc;

/// A rank's particles and the ghosts in their reach, in a box.
pub struct Present {
    pub cell: PeriodicBox,
    pub halo: Halo,
    pub positions: Vec<Vector>,
    pub ids: Vec<u64>,
    pub species: Vec<u32>,
}

/// Neighbour lists up to a reach, with the particles that they follow.
pub struct NearLists {
    /// Largest centre distance of a near pair.
    reach: f64,
    lists: VerletList,
    present: Option<Rc<Present>>,
}

impl NearLists {
    /// Lists of pairs whose centres are closer than `reach`.
    pub fn new(reach: f64, partition: &Partition) -> Self {
        Self { reach, lists: VerletList::new(reach, partition), present: None }
    }

    /// Largest centre distance of a near pair.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Neighbours of each particle at the last positions.
    pub fn neighbours(&self) -> &Neighbours {
        self.lists.neighbours()
    }

    /// The particles, of known species, with ghosts, and the lists at their positions: as they are, if no particle has
    /// moved. Collective.
    pub fn follow(&mut self, particles: &Particles, species: Vec<u32>, view: DomainView) -> Rc<Present> {
        let _stage = stage("lists of near pairs");
        let DomainView { cell, partition } = view;
        let known = self.present.take().filter(|present| present.is_of(particles, &species, cell));
        let has_moved = partition.comm().any(known.is_none());
        let present = known.filter(|_| !has_moved).unwrap_or_else(|| {
            let present = Present::new(particles, species, view, self.reach);
            let (owned, ids, positions) = (particles.len(), &present.ids[..], &present.positions[..]);
            self.lists.update(cell, &LocalAndGhosts { owned, ids, positions });
            Rc::new(present)
        });
        self.present = Some(Rc::clone(&present));
        present
    }
}

impl Present {
    /// Collects the ghosts within a reach. Collective.
    pub fn new(
        particles: &Particles,
        mut species: Vec<u32>,
        DomainView { cell, partition }: DomainView,
        reach: f64,
    ) -> Self {
        let halo = Halo::plan(partition, cell, &particles.positions, [reach; 2]);
        let (mut positions, mut ids) = (Vec::new(), Vec::new());
        let mut loops = FusedLoops::default();
        loops.copied(&mut positions, &particles.positions);
        loops.copied(&mut ids, &particles.ids);
        loops.run();
        halo.extend(&mut positions);
        halo.extend(&mut ids);
        halo.extend(&mut species);
        Self { cell: *cell, halo, positions, ids, species }
    }

    /// Whether the particles of this rank are still the same, at the same positions in the same box.
    fn is_of(&self, particles: &Particles, species: &[u32], cell: &PeriodicBox) -> bool {
        let owned = particles.len();
        let Self { positions, ids, species: known, .. } = self;
        let now = (&particles.positions, &particles.ids);
        let is_same = |row: usize| positions[row] == now.0[row] && ids[row] == now.1[row] && known[row] == species[row];
        self.halo.owned() == owned && self.cell == *cell && all_rows(owned, is_same)
    }
}
