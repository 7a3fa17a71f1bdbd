//! Construction of the Verlet list.

use super::grid::{Entry, Grid};
use super::touching::Touching;
use super::{Batch, Chunk, List, ListMargin, Pair};
use crate::disks::stage::Law;
use crate::disks::state::{CHUNK, Identity, State};
use crate::disks::{Model, Progress, for_each_part};
use domain::PeriodicBox;
use glam::DVec2;
use std::ops::Range;

/// Width and height of a cell in units of the mean diameter: few rows to search, and few disks in each.
const CELL: DVec2 = DVec2::new(0.5, 2.0);

/// Disks are sorted in memory again at the first rebuild after this number of steps.
const SORT_EVERY: u64 = 2048;

/// The input of the search for pairs.
struct Search<'a> {
    grid: Grid,
    state: &'a State,
    cell: &'a PeriodicBox,
    slack: ListMargin,
    touching: &'a Touching,
    /// Step at which those pairs were in contact, modulo 2^32.
    touched: u32,
}

impl List {
    /// Builds the list of a system at a step. Wraps the positions, and from time to time sorts the disks in the order
    /// of their cells. Marks the pairs that were in contact at the previous step according to the previous list.
    pub(in crate::disks) fn make(
        state: &mut State,
        model: &Model,
        law: &Law,
        step: u64,
        before: Option<&Self>,
    ) -> Self {
        let cell = model.cell(law.strain(step));
        let turns = |step: u64| (law.strain(step) * cell.edges().y / cell.edges().x + 0.5).floor() as i32;
        let born = before.map_or(step, |list| list.born);
        state.wrap(&cell, law, turns(step) - turns(born));
        state.refer();
        let mut rows: Vec<u32> = (0..state.len() as u32).collect();
        if before.is_none_or(|list| list.born / SORT_EVERY < step / SORT_EVERY) {
            let order = Grid::sort(&cell, state, cell_edges(&state.identities)).order();
            state.arrange(&order, law, model);
            for (new, &old) in order.iter().enumerate() {
                rows[old as usize] = new as u32;
            }
        }
        let last = step.wrapping_sub(1);
        let touching = before.map(|list| {
            let pairs = list.touching(last).map(|pair| pair.map(|row| rows[row as usize]));
            Touching::of(pairs, rows.len())
        });
        Self::link(state, &cell, step, (&touching.unwrap_or_default(), last))
    }

    /// Rebuilds the list of a stored state, from the positions at which it was first built.
    pub(in crate::disks) fn remake(state: &State, model: &Model, law: &Law, progress: &Progress) -> Self {
        let born = progress.list_made;
        let touching = Touching::of(progress.touching.iter().copied(), state.len());
        let mut list = Self::link(state, &model.cell(law.strain(born)), born, (&touching, progress.step));
        list.move_images(law, progress.step);
        list
    }

    /// Finds the pairs at the reference positions of the drift. The pairs in `touching` were in contact at step `last`.
    fn link(state: &State, cell: &PeriodicBox, born: u64, (touching, last): (&Touching, u64)) -> Self {
        let radii = state.identities.iter().map(|d| d.radius);
        let slack = ListMargin::new(radii.clone().fold(f64::INFINITY, f64::min), radii.fold(0.0, f64::max));
        let search = Search {
            grid: Grid::sort(cell, state, cell_edges(&state.identities)),
            state,
            cell,
            slack,
            touching,
            touched: last as u32,
        };
        let count = state.len();
        let mut chunks: Vec<Chunk> =
            (0..count).step_by(CHUNK).map(|start| Chunk::new(start..count.min(start + CHUNK))).collect();
        for_each_part(&mut chunks, |chunk| search.fill(chunk));
        Self { born, strain: cell.strain(), edges: cell.edges().truncate(), slack, chunks }
    }
}

/// A disk that may touch another, and the lattice steps to its nearest image.
#[derive(Debug, Clone, Copy, Default)]
struct Candidate {
    entry: u32,
    steps: [i16; 2],
}

impl Search<'_> {
    /// Lists the pairs whose larger disk is in the chunk.
    fn fill(&self, chunk: &mut Chunk) {
        let entries = self.grid.entries();
        let mut near = Vec::new();
        for row in chunk.rows.clone() {
            let (first, mut count) = (&Entry::of(self.state, row), 0);
            self.grid.for_each_near(first.place, self.slack.cutoff(2.0 * first.radius), |steps, range| {
                if near.len() < count + range.len() {
                    near.resize(count + range.len(), Candidate::default());
                }
                count = self.gather(first, steps, range, count, &mut near);
            });
            for candidate in &near[..count] {
                let second = &entries[candidate.entry as usize];
                let touched = self.touched.wrapping_sub(u32::from(!self.touching.holds(first.row, second.row)));
                chunk.list(self.pair(first, second), candidate.steps.map(i32::from), touched);
            }
        }
        chunk.make_room();
    }

    /// Adds the entries of a range that are within the cutoff of a disk and below it in rank, without a branch.
    /// Returns the number of candidates so far.
    #[inline(always)]
    fn gather(
        &self,
        first: &Entry,
        steps: [i32; 2],
        range: Range<usize>,
        mut count: usize,
        near: &mut [Candidate],
    ) -> usize {
        let start = self.shift(steps) - first.place;
        let steps = steps.map(|s| s as i16);
        let base = range.start as u32;
        for (k, second) in self.grid.entries()[range].iter().enumerate() {
            let cutoff = self.slack.cutoff(first.radius + second.radius);
            let close = (second.place + start).length_squared() < cutoff * cutoff;
            near[count] = Candidate { entry: base + k as u32, steps };
            count += usize::from(close) & usize::from(second.rank < first.rank);
        }
        count
    }

    fn pair(&self, first: &Entry, second: &Entry) -> Pair {
        let light = |entry: &Entry| self.state.identities[entry.row as usize].lightness;
        Pair {
            i: first.row,
            j: second.row,
            reach: first.radius + second.radius,
            lightness: light(first) + light(second),
        }
    }

    fn shift(&self, steps: [i32; 2]) -> DVec2 {
        if steps == [0; 2] { DVec2::ZERO } else { self.cell.lattice([steps[0], steps[1], 0]).truncate() }
    }
}

impl Chunk {
    fn new(rows: Range<usize>) -> Self {
        Self { rows, inner: Vec::new(), border: Vec::new(), found: Vec::new(), pushes: Vec::new() }
    }

    fn list(&mut self, pair: Pair, steps: [i32; 2], touched: u32) {
        let batches = if self.rows.contains(&(pair.j as usize)) { &mut self.inner } else { &mut self.border };
        let place = batches.iter().position(|b| b.steps == steps).unwrap_or_else(|| {
            batches.push(Batch { steps, ..Batch::default() });
            batches.len() - 1
        });
        batches[place].pairs.push(pair);
        batches[place].touched.push(touched);
    }

    fn make_room(&mut self) {
        let longest = self.inner.iter().chain(&self.border).map(|b| b.pairs.len()).max().unwrap_or(0);
        self.found.resize(longest, 0);
    }
}

fn cell_edges(disks: &[Identity]) -> DVec2 {
    cell_of(disks.iter().map(|d| d.radius).sum::<f64>() / disks.len() as f64)
}

/// Width and height of a cell for disks with this mean radius.
pub(in crate::disks) fn cell_of(mean_radius: f64) -> DVec2 {
    CELL * 2.0 * mean_radius
}
