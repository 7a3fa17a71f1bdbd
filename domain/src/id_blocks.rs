//! Particles distributed by their ids, for sums over all of them that do not depend on the number of ranks.

use crate::parallel::sort;
use crate::rows::{RowExchange, RowMove, Selection, SortedExchange};
use crate::{ById, Comm, Particles, block};
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// Blocks of consecutive ids. Block `b`, with all its particles, is on rank `b mod ranks`, whatever part of space the
/// ranks own. A sum over particles that is taken block by block, and then over the blocks in their order, has the
/// same bits on any number of ranks.
#[derive(Clone)]
pub struct IdBlocks {
    comm: Comm,
    size: u64,
    count: usize,
}

impl IdBlocks {
    /// Number of ids in a block.
    pub const SIZE: u64 = ById::BLOCK;

    /// Blocks of `size` ids for the particles of all ranks; each rank passes its own. At least one block. Collective.
    pub fn of(particles: &Particles, comm: &Comm, size: u64) -> Self {
        let end = particles.ids.iter().max().map_or(0, |&id| id + 1);
        let end = comm.all_gather(&[end]).into_iter().max().unwrap_or(0);
        Self { comm: comm.clone(), size, count: end.div_ceil(size).max(1) as usize }
    }

    /// Communicator of the ranks.
    pub fn comm(&self) -> &Comm {
        &self.comm
    }

    /// Number of blocks of all ranks.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Numbers of this rank's blocks.
    pub fn own(&self) -> impl Iterator<Item = usize> + use<> {
        (self.comm.rank()..self.count).step_by(self.comm.size())
    }

    /// Particles of this rank's blocks in the order of their ids, with only the columns whose names are wanted; if
    /// they are here already, they are borrowed, with all their columns. Each rank passes its own particles.
    /// Collective.
    pub fn distributed<'a>(&self, particles: &'a Particles, wanted: impl Fn(&str) -> bool) -> Cow<'a, Particles> {
        if self.comm.size() == 1 && particles.ids.is_sorted() {
            return Cow::Borrowed(particles);
        }
        let ranks = self.comm.size() as u64;
        let owners: Vec<usize> = particles.ids.iter().map(|id| (id / self.size % ranks) as usize).collect();
        let exchange = RowExchange::plan(&owners, &self.comm);
        let ids = exchange.of(&particles.ids, 1);
        let mut order: Vec<usize> = (0..ids.len()).collect();
        sort(ids.len(), || order.par_sort_unstable_by_key(|&row| ids[row]));
        Cow::Owned(particles.mapped(&SortedExchange { exchange, order: Selection(&order) }, wanted))
    }

    /// Rows of each of this rank's blocks among its distributed particles.
    pub fn rows(&self, distributed: &Particles) -> Vec<Range<usize>> {
        let before = |id: u64| distributed.ids.partition_point(|&other| other < id);
        self.own().map(|block| block as u64).map(|b| before(b * self.size)..before((b + 1) * self.size)).collect()
    }

    /// Sums over the blocks before each of this rank's blocks, of integers that each rank passes for each of its own
    /// blocks, equally many for each. Collective.
    pub fn before(&self, parts: &[Vec<u64>]) -> Vec<Vec<u64>> {
        let (ranks, all) = (self.comm.size(), self.comm.all_gather_lists(&parts.concat()));
        let width = all[0].len() / self.count.div_ceil(ranks);
        let mut sums = vec![0; width];
        let mut before = Vec::new();
        for block in 0..self.count {
            if block % ranks == self.comm.rank() {
                before.push(sums.clone());
            }
            let part = &all[block % ranks][block / ranks * width..][..width];
            sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        before
    }

    /// Sums over all blocks in their order, on every rank, of numbers that each rank passes for each of its own
    /// blocks, equally many for each. No rank holds more than its share of the blocks' numbers at a time. Collective.
    pub fn total(&self, parts: &[Vec<f64>]) -> Vec<f64> {
        let ranks = self.comm.size();
        let mut width = parts.first().map(Vec::len).into_iter().collect();
        self.comm.broadcast(&mut width);
        let shares: Vec<Range<usize>> = (0..ranks).map(|rank| block(width[0], ranks, rank)).collect();
        let of_rank = |share: &Range<usize>| parts.iter().flat_map(|part| &part[share.clone()]).copied().collect();
        let received = self.comm.exchange(&shares.iter().map(of_rank).collect::<Vec<Vec<f64>>>());
        let length = shares[self.comm.rank()].len();
        let mut sums = received[0][..length].to_vec();
        for block in 1..self.count {
            let part = &received[block % ranks][block / ranks * length..][..length];
            sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        self.comm.all_gather(&sums)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vector;

    fn numbered(count: u64) -> Particles {
        let mut particles = Particles::default();
        for id in 0..count {
            let t = id as f64;
            particles.push(id, Vector::new(t * 0.37, t * 0.73, t * 0.57) % 1.0, 1.0 / (1.0 + t), (id % 3) as u32);
        }
        particles.column("age", 2).values.iter_mut().enumerate().for_each(|(k, v)| *v = 1.0 / (k as f64 + 0.3));
        particles.column("unwanted", 1);
        particles
    }

    /// This rank's part of all particles, in an arbitrary order.
    fn share(all: &Particles, comm: &Comm) -> Particles {
        let rows = (0..all.len()).rev().filter(|row| row * row % 11 % comm.size() == comm.rank());
        all.selected(&rows.collect::<Vec<_>>())
    }

    #[test]
    fn each_block_is_whole_and_on_its_rank() {
        let all = numbered(50);
        for (ranks, size) in [(1, 7), (1, 64), (2, 64), (3, 7), (7, 1), (13, 20)] {
            let distributed = Comm::threads(ranks, |comm| {
                let own = share(&all, &comm);
                let blocks = IdBlocks::of(&own, &comm, size);
                assert_eq!(blocks.count(), 50_usize.div_ceil(size as usize));
                let distributed = blocks.distributed(&own, |name| name == "age").into_owned();
                distributed.check().unwrap();
                assert_eq!(distributed.columns.len(), 1);
                let rows = blocks.rows(&distributed);
                assert_eq!(rows.iter().map(Range::len).sum::<usize>(), distributed.len());
                blocks
                    .own()
                    .zip(rows)
                    .map(|(block, rows)| (block, distributed.selected(&rows.collect::<Vec<_>>())))
                    .collect()
            });
            let mut found: Vec<(usize, Particles)> =
                distributed.into_iter().flat_map(|blocks: Vec<_>| blocks).collect();
            found.sort_by_key(|(block, _)| *block);
            for (place, (block, particles)) in found.iter().enumerate() {
                assert_eq!(place, *block);
                let rows: Vec<usize> = (block * size as usize..50.min((block + 1) * size as usize)).collect();
                let expected = all.selected(&rows).with_columns(|name| name == "age");
                assert_eq!(*particles, expected, "{ranks} ranks, blocks of {size}");
            }
        }
    }

    #[test]
    fn sums_have_the_same_bits_on_any_ranks() {
        let all = numbered(50);
        for size in [1, 7, 20, 64] {
            let total = |ranks: usize| {
                let sums = Comm::threads(ranks, |comm| {
                    let own = share(&all, &comm);
                    let blocks = IdBlocks::of(&own, &comm, size);
                    let distributed = blocks.distributed(&own, |_| true);
                    let of_rows = |rows: Range<usize>| {
                        let values =
                            rows.map(|row| [distributed.radii[row], distributed.columns[0].values[2 * row], 1.0]);
                        values.fold(vec![0.0; 3], |sum, v| sum.iter().zip(v).map(|(s, v)| s + v).collect())
                    };
                    let parts: Vec<Vec<f64>> = blocks.rows(&distributed).into_iter().map(of_rows).collect();
                    assert!(blocks.total(&vec![Vec::new(); parts.len()]).is_empty());
                    blocks.total(&parts)
                });
                assert!(sums.iter().all(|sum| sum == &sums[0]));
                sums[0].clone()
            };
            let alone = total(1);
            assert!((alone[2] - 50.0).abs() < 1e-15);
            assert!([2, 3, 7, 13, 60].into_iter().all(|ranks| total(ranks) == alone), "blocks of {size}");
        }
    }

    #[test]
    fn what_comes_before_a_block_is_summed() {
        for ranks in [1, 2, 3, 7, 13] {
            Comm::threads(ranks, |comm| {
                let blocks = IdBlocks::of(&share(&numbered(50), &comm), &comm, 5);
                let parts: Vec<Vec<u64>> = blocks.own().map(|block| vec![1, block as u64]).collect();
                let expected: Vec<Vec<u64>> =
                    blocks.own().map(|block| block as u64).map(|b| vec![b, (0..b).sum()]).collect();
                assert_eq!(blocks.before(&parts), expected);
            });
        }
    }

    #[test]
    fn without_particles_there_is_a_block() {
        for ranks in [1, 3] {
            Comm::threads(ranks, |comm| {
                let none = Particles::default();
                let blocks = IdBlocks::of(&none, &comm, 4);
                assert_eq!((blocks.count(), blocks.own().count()), (1, usize::from(comm.is_first())));
                assert!(blocks.distributed(&none, |_| true).is_empty());
                assert_eq!(blocks.total(&vec![vec![2.0]; blocks.own().count()]), [2.0]);
            });
        }
    }
}
