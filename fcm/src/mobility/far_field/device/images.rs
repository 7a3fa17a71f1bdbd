//! Images in walls, which the host lists for a device.

use crate::pairs::pair_correction::LoadedParticles;
use crate::plan::Plan;
use crate::walls::wall_images::WallImages;
use domain::{LocalAndGhosts, Partition, PeriodicBox, Vector, VerletList};
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

    /// Images that act on the first of the particles present in a box, in internal units.
    pub fn of(&mut self, cell: &PeriodicBox, present: PlacedClasses, owned: usize) -> ImageLists {
        let PlacedClasses { ids, positions, classes } = present;
        self.lists.update(cell, &LocalAndGhosts { owned, ids, positions });
        let placed = LoadedParticles { cell, positions, classes, forces: &[], dipoles: &[] };
        self.images.arrange(&placed, self.lists.neighbours(), owned);
        self.images.lists()
    }
}

/// Ids, positions and classes of radius.
#[derive(Clone, Copy)]
pub(super) struct PlacedClasses<'a> {
    pub ids: &'a [u64],
    pub positions: &'a [Vector],
    pub classes: &'a [u32],
}
