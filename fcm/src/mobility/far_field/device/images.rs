//! Images in walls, which the host lists for a device.

use crate::pairs::pair_correction::LoadedParticles;
use crate::plan::Plan;
use crate::walls::wall_images::WallImages;
use domain::{LocalAndGhosts, Particles, Partition, PeriodicBox, Vector, VerletList};
use gpu::ImageLists;

/// Images of a plan, in internal units.
pub(super) struct HostImages {
    pub images: WallImages,
    lists: VerletList,
}

impl HostImages {
    /// For a plan in internal units; `None` without walls.
    pub fn new(plan: &Plan, partition: &Partition) -> Option<Self> {
        let images = WallImages::new(plan)?;
        Some(Self { images, lists: VerletList::new(plan.cutoff(), partition) })
    }

    /// Images of particles at some positions in a box, in internal units.
    pub fn of(&mut self, cell: &PeriodicBox, particles: &Particles, present: PlacedClasses) -> ImageLists {
        let PlacedClasses { positions, classes } = present;
        let owned = positions.len();
        self.lists.update(cell, &LocalAndGhosts { owned, ids: &particles.ids, positions });
        let placed = LoadedParticles { cell, positions, classes, forces: &[], dipoles: &[] };
        self.images.arrange(&placed, self.lists.neighbours(), owned);
        self.images.lists()
    }
}

/// Positions and classes of radius.
#[derive(Clone, Copy)]
pub(super) struct PlacedClasses<'a> {
    pub positions: &'a [Vector],
    pub classes: &'a [u32],
}
