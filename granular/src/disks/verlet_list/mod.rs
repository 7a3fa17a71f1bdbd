//! The Verlet list: pairs of disks that may touch before it is rebuilt, each with its own cutoff.

mod build;
mod grid;
mod margin;
#[cfg(test)]
mod tests;

use super::stage::Law;
use glam::DVec2;
use std::ops::Range;

pub(super) use grid::DiskCells;
pub(super) use margin::ListMargin;

/// Two disks that may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DiskPair {
    pub(super) i: u32,
    pub(super) j: u32,
    /// Sum of the radii.
    pub(super) contact_distance: f64,
    /// Sum of the inverse masses.
    pub(super) inverse_mass_sum: f64,
}

/// Pairs whose second disk is shifted by the same lattice steps.
#[derive(Debug, Clone, Default)]
pub(super) struct ImageBatch {
    /// Lattice steps added to the position of the second disk.
    pub(super) steps: [i32; 2],
    pub(super) pairs: Vec<DiskPair>,
    /// Present shift of those images.
    pub(super) image: ImageMotion,
    /// The last step, modulo 2^32, at which each pair touched.
    pub(super) touched: Vec<u32>,
}

/// Displacement and relative velocity of the images of a batch.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ImageMotion {
    pub(super) shift: DVec2,
    pub(super) velocity: f64,
}

/// The pairs that one thread processes: the first disk is in a range of rows. The second disk of the `inner`
/// pairs is in that range, too.
#[derive(Debug, Clone)]
pub(super) struct PairChunk {
    pub(super) rows: Range<usize>,
    pub(super) inner: Vec<ImageBatch>,
    pub(super) border: Vec<ImageBatch>,
    /// Buffer for the indices of the pairs in contact.
    pub(super) found: Vec<u32>,
    /// Forces of pairs whose second disk is in another range.
    pub(super) border_forces: Vec<(DiskPair, DVec2)>,
}

/// All pairs, the step at which they were found, and the margin that decides how long they remain valid.
#[derive(Debug, Clone)]
pub(super) struct List {
    /// Step at which the list was built.
    pub(super) built_at_step: u64,
    /// Strain of the lattice at that step, reduced to its range.
    strain: f64,
    edges: DVec2,
    margin: ListMargin,
    pub(super) chunks: Vec<PairChunk>,
}

impl List {
    /// Updates the images of all batches to a step.
    pub(super) fn move_images(&mut self, law: &Law, step: u64) {
        let strain = self.strain + law.strain_in(step - self.built_at_step);
        for batch in self.chunks.iter_mut().flat_map(|c| c.inner.iter_mut().chain(&mut c.border)) {
            let [along, up] = batch.steps.map(f64::from);
            let height = up * self.edges.y;
            let shift = DVec2::new(along * self.edges.x + strain * height, height);
            batch.image = ImageMotion { shift, velocity: law.profile.lattice_rate * height };
        }
    }

    /// Whether a pair that is not in the list may be in contact at a step, if no disk has moved by more than
    /// `drift` relative to the liquid.
    pub(super) fn is_stale(&self, law: &Law, step: u64, drift: f64) -> bool {
        self.margin.is_used_up(law.profile.steepest * law.dt * (step - self.built_at_step) as f64, drift)
    }

    /// Rows of the pairs that were in contact at a step.
    pub(in crate::disks) fn touching(&self, step: u64) -> impl Iterator<Item = [u32; 2]> + Clone {
        let pairs = self.batches().flat_map(|batch| batch.pairs.iter().zip(&batch.touched));
        pairs.filter(move |&(_, &last)| last == step as u32).map(|(pair, _)| [pair.i, pair.j])
    }

    fn batches(&self) -> impl Iterator<Item = &ImageBatch> + Clone {
        self.chunks.iter().flat_map(|c| c.inner.iter().chain(&c.border))
    }
}
