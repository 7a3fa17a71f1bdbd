//! Construction of the Verlet list.

use super::grid::{CellEntry, DiskCells};
use super::{DiskPair, ImageBatch, List, ListMargin, PairChunk};
use crate::disks::stage::Law;
use crate::disks::state::{CHUNK, DiskState};
use crate::disks::{DiskModel, Progress, for_each_part};
use domain::PeriodicBox;
use domain::parallel::{SortedRows, mapped};
use glam::DVec2;
use std::ops::Range;

/// Disks are sorted in memory again at the first rebuild after this number of steps.
const SORT_EVERY: u64 = 2048;

/// The input of the search for pairs.
struct PairSearch<'a> {
    grid: DiskCells,
    state: &'a DiskState,
    cell: &'a PeriodicBox,
    margin: ListMargin,
    touching: &'a TouchingPairs,
    /// Step at which those pairs were in contact, modulo 2^32.
    touched: u32,
}

impl List {
    /// Builds the list of a system at a step. Wraps the positions, and from time to time sorts the disks in the order
    /// of their cells. Marks the pairs that were in contact at the previous step according to the previous list.
    pub(in crate::disks) fn build(
        state: &mut DiskState,
        model: &DiskModel,
        law: &Law,
        step: u64,
        before: Option<&Self>,
    ) -> Self {
        let cell = model.cell(law.strain(step));
        let built_at_step = before.map_or(step, |list| list.built_at_step);
        state.wrap(&cell, law, law.lattice_shifts(model, built_at_step..step));
        state.set_references();
        let mut rows: Vec<u32> = (0..state.len() as u32).collect();
        if before.is_none_or(|list| list.built_at_step / SORT_EVERY < step / SORT_EVERY) {
            let cells = DiskCells::sort(&cell, state);
            state.reorder(cells.rows(), law, model);
            for (new, &old) in cells.rows().iter().enumerate() {
                rows[old as usize] = new as u32;
            }
        }
        let last = step.wrapping_sub(1);
        let pairs = before.into_iter().flat_map(|list| list.touching(last));
        let touching = TouchingPairs::of(pairs.map(|pair| pair.map(|row| rows[row as usize])), rows.len());
        Self::find_pairs(state, &cell, step, &touching, last)
    }

    /// Rebuilds the list of a stored state, from the positions at which it was first built.
    pub(in crate::disks) fn rebuild(state: &DiskState, model: &DiskModel, law: &Law, progress: &Progress) -> Self {
        let built_at_step = progress.list_built;
        let touching = TouchingPairs::of(progress.touching.iter().copied(), state.len());
        let mut list =
            Self::find_pairs(state, &model.cell(law.strain(built_at_step)), built_at_step, &touching, progress.step);
        list.move_images(law, progress.step);
        list
    }

    /// Finds the pairs at the reference positions of the drift. The pairs in `touching` were in contact at step `last`.
    fn find_pairs(
        state: &DiskState,
        cell: &PeriodicBox,
        built_at_step: u64,
        touching: &TouchingPairs,
        last: u64,
    ) -> Self {
        let radii = state.identities.iter().map(|d| d.radius);
        let margin = ListMargin::new(radii.clone().fold(f64::INFINITY, f64::min), radii.fold(0.0, f64::max));
        let search =
            PairSearch { grid: DiskCells::sort(cell, state), state, cell, margin, touching, touched: last as u32 };
        let count = state.len();
        let mut chunks: Vec<PairChunk> =
            (0..count).step_by(CHUNK).map(|start| PairChunk::new(start..count.min(start + CHUNK))).collect();
        for_each_part(&mut chunks, |chunk| search.fill(chunk));
        Self { built_at_step, strain: cell.strain(), edges: cell.edges().truncate(), margin, chunks }
    }
}

/// Pairs that were in contact when the list was rebuilt.
struct TouchingPairs {
    /// Both orders of each pair, by the first row.
    sorted: SortedRows,
    /// The second rows, in that order.
    partners: Vec<u32>,
}

impl TouchingPairs {
    fn of(pairs: impl Iterator<Item = [u32; 2]>, rows: usize) -> Self {
        let both = pairs.filter(|pair| pair.iter().all(|&row| (row as usize) < rows));
        let (firsts, seconds): (Vec<u32>, Vec<u32>) = both.flat_map(|[i, j]| [(i, j), (j, i)]).unzip();
        let sorted = SortedRows::by_key(&firsts, rows);
        Self { partners: mapped(sorted.rows(), |&place| seconds[place as usize]), sorted }
    }

    /// The rows that touch a row.
    fn of_row(&self, row: usize) -> &[u32] {
        let starts = self.sorted.starts();
        &self.partners[starts[row] as usize..starts[row + 1] as usize]
    }
}

/// A disk that may touch another, and the lattice steps to its nearest image.
#[derive(Debug, Clone, Copy, Default)]
struct NearDisk {
    entry: u32,
    steps: [i16; 2],
}

impl PairSearch<'_> {
    /// Lists the pairs whose larger disk is in the chunk.
    fn fill(&self, chunk: &mut PairChunk) {
        let entries = self.grid.entries();
        let mut near = Vec::new();
        for row in chunk.rows.clone() {
            let (first, mut count) = (&CellEntry::of(self.state, row), 0);
            self.grid.for_each_near(first.position, self.margin.cutoff(2.0 * first.radius), |steps, range| {
                if near.len() < count + range.len() {
                    near.resize(count + range.len(), NearDisk::default());
                }
                count = self.gather(first, steps, range, count, &mut near);
            });
            let touching = self.touching.of_row(row);
            for candidate in &near[..count] {
                let second = &entries[candidate.entry as usize];
                let touched = self.touched.wrapping_sub(u32::from(!touching.contains(&second.row)));
                chunk.list(self.pair(first, second), candidate.steps.map(i32::from), touched);
            }
        }
        chunk.resize_buffer();
    }

    /// Adds the entries of a range that are within the cutoff of a disk and below it in rank, without a branch.
    /// Returns the number of candidates so far.
    #[inline(always)]
    fn gather(
        &self,
        first: &CellEntry,
        steps: [i32; 2],
        range: Range<usize>,
        mut count: usize,
        near: &mut [NearDisk],
    ) -> usize {
        let start = self.shift(steps) - first.position;
        let steps = steps.map(|s| s as i16);
        let base = range.start as u32;
        for (k, second) in self.grid.entries()[range].iter().enumerate() {
            let cutoff = self.margin.cutoff(first.radius + second.radius);
            let close = (second.position + start).length_squared() < cutoff * cutoff;
            near[count] = NearDisk { entry: base + k as u32, steps };
            count += usize::from(close) & usize::from(second.rank < first.rank);
        }
        count
    }

    fn pair(&self, first: &CellEntry, second: &CellEntry) -> DiskPair {
        let light = |entry: &CellEntry| self.state.identities[entry.row as usize].inverse_mass;
        DiskPair {
            i: first.row,
            j: second.row,
            contact_distance: first.radius + second.radius,
            inverse_mass_sum: light(first) + light(second),
        }
    }

    fn shift(&self, steps: [i32; 2]) -> DVec2 {
        if steps == [0; 2] { DVec2::ZERO } else { self.cell.lattice([steps[0], steps[1], 0]).truncate() }
    }
}

impl PairChunk {
    fn new(rows: Range<usize>) -> Self {
        Self { rows, inner: Vec::new(), border: Vec::new(), found: Vec::new(), border_forces: Vec::new() }
    }

    fn list(&mut self, pair: DiskPair, steps: [i32; 2], touched: u32) {
        let batches = if self.rows.contains(&(pair.j as usize)) { &mut self.inner } else { &mut self.border };
        let index = batches.iter().position(|b| b.steps == steps).unwrap_or_else(|| {
            batches.push(ImageBatch { steps, ..ImageBatch::default() });
            batches.len() - 1
        });
        batches[index].pairs.push(pair);
        batches[index].touched.push(touched);
    }

    fn resize_buffer(&mut self) {
        let longest = self.inner.iter().chain(&self.border).map(|b| b.pairs.len()).max().unwrap_or(0);
        self.found.resize(longest, 0);
    }
}
