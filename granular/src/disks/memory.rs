//! Predicted memory of runs of disks.

use super::observe::{AveragedProfile, Disk};
use super::state::{Body, DiskBlock, DiskMotion, Identity, LANES};
use super::verlet_list::{DiskCells, DiskPair, ListMargin, PairChunk};
use super::{DiskModel, Size};
use domain::{Bytes, GROWING, Particles};
use glam::DVec2;

/// Numbers of a disk in the particle store: velocity, and what the integrator and the Verlet list continue from.
const STORED: usize = 3 + 6 + 9;

impl DiskModel {
    /// A run of these disks with a profile of `strips` strips: the disks, the Verlet list, snapshots and checkpoints.
    pub fn bytes(&self, strips: usize) -> Bytes {
        let count = self.sizes().len() as f64;
        let profile = Bytes::keep(strips as f64 * AveragedProfile::STRIP);
        let pictures = Bytes::list::<(Disk, usize)>(count).freed();
        let stored = Particles::bytes(count, STORED);
        let copies = Bytes::list::<(usize, DiskMotion)>(count).then(self.state()).freed();
        let checkpoint = Bytes::keep(GROWING * stored.kept).then(copies).then(stored).freed();
        let passes = self.search().or(pictures).or(checkpoint);
        Self::size_bytes(count).then(self.state()).then(self.pairs()).then(profile).then(passes)
    }

    /// The list of sizes that a model keeps of so many disks, and the run a copy.
    pub fn size_bytes(count: f64) -> Bytes {
        Bytes::list::<[Size; 2]>(count)
    }

    fn state(&self) -> Bytes {
        let count = self.sizes().len() as f64;
        Bytes::list::<(Identity, [i32; 2], Body, DVec2)>(count)
            .then(Bytes::list::<DiskBlock>((count / LANES as f64).ceil()))
    }

    /// The Verlet list: each pair once, and the last step at which it touched.
    fn pairs(&self) -> Bytes {
        Bytes::list::<(DiskPair, u32)>(GROWING * self.listed()).then(Bytes::list::<PairChunk>(1.0))
    }

    /// The rebuild of the list while the old one still exists: the disks in the order of cells, and the pairs in
    /// contact.
    fn search(&self) -> Bytes {
        let count = self.sizes().len() as f64;
        let mean_radius = self.sizes().iter().map(|size| size.radius).sum::<f64>() / count;
        let cells = DiskCells::counts(DVec2::from_array(self.parameters().edges), mean_radius, count);
        let cells = Bytes::list::<u32>(cells.element_product()).then(Bytes::list::<([f64; 4], [u32; 4])>(count));
        let touching = Bytes::list::<[u32; 8]>(count);
        cells.then(touching).then(self.pairs()).freed()
    }

    /// Pairs that a list has: those nearer than the cutoff, as many as in a circle of that radius less the disk itself.
    fn listed(&self) -> f64 {
        let sizes = self.sizes();
        let count = sizes.len() as f64;
        let moment = |power: i32| sizes.iter().map(|s| s.radius.powi(power)).sum::<f64>() / count;
        let margin = ListMargin::new(self.smallest(), self.largest());
        let (skin, [mean, square]) = (margin.cutoff(0.0), [moment(1), moment(2)]);
        let stretch = margin.cutoff(1.0) - skin;
        // The mean square of `stretch (a + b) + skin`.
        let contact_distance =
            stretch * stretch * 2.0 * (square + mean * mean) + 4.0 * stretch * skin * mean + skin * skin;
        let [length, height] = self.parameters().edges;
        0.5 * count * (count * std::f64::consts::PI * contact_distance / (length * height) - 1.0).max(0.0)
    }
}
