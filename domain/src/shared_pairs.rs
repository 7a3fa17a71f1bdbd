//! Pairs of the particles of all ranks within any distance, without storing them.

use crate::pairs::{SearchedParticles, fold_some_pairs};
use crate::parallel::sort;
use crate::{DomainView, Halo, Particles, Vector};
use rayon::prelude::*;

/// Number of ghosts whose memory is negligible.
pub(crate) const FEW: usize = 1 << 16;

/// Folds over the pairs of different particles of all ranks within a cutoff as [`crate::fold_pairs`] does. Each pair,
/// and each image of it, is visited once, on the rank that owns the particle with the smaller id, with the species of
/// both, that of the smaller id first, and the separation from it to the image of the other. Separations have the
/// same bits on any number of ranks. However large the cutoff, there are no more ghosts at a time than a rank has
/// particles, or 65,536. Each rank passes the particles inside its pencil. Collective.
pub fn fold_shared_pairs<T: Send>(
    domain: DomainView,
    particles: &Particles,
    cutoff: f64,
    start: impl Fn() -> T + Sync,
    visit: impl Fn(&mut T, [u32; 2], Vector) + Sync,
) -> Vec<T> {
    fold_in_rounds(&SharedSearch { domain, particles, cutoff, few: FEW }, start, visit)
}

/// A search for pairs of the particles of all ranks.
struct SharedSearch<'a> {
    domain: DomainView<'a>,
    particles: &'a Particles,
    cutoff: f64,
    /// Number of ghosts that a rank may have at a time even if it owns fewer particles.
    few: usize,
}

fn fold_in_rounds<T: Send>(
    search: &SharedSearch,
    start: impl Fn() -> T + Sync,
    visit: impl Fn(&mut T, [u32; 2], Vector) + Sync,
) -> Vec<T> {
    let &SharedSearch { domain: DomainView { cell, partition }, particles, cutoff, few } = search;
    let halo = Halo::plan(partition, cell, &particles.positions, [cutoff; 2]);
    let (owned, ghosts) = (halo.owned(), halo.present() - halo.owned());
    let all = partition.comm().all_gather(&[[owned, ghosts.div_ceil(owned.max(few))]]);
    let total = all.iter().map(|[owned, _]| owned).sum();
    let rounds = all.iter().map(|[_, rounds]| *rounds).max().unwrap_or(0).max(1);
    let mut parts = Vec::new();
    for round in 0..rounds {
        let near = ParticlesById::of(&halo.part(round, rounds), particles);
        // Pairs within this rank are visited in the first round.
        let of_round = |[_, j]: [u32; 2]| round == 0 || !near.is_own(j);
        parts.extend(fold_some_pairs(
            &SearchedParticles { cell, positions: &near.positions, total, cutoff },
            |row| near.is_own(row),
            &start,
            |seen, pair, separation| {
                if of_round(pair) {
                    visit(seen, pair.map(|row| near.species[row as usize]), separation);
                }
            },
        ));
    }
    parts
}

/// Particles and ghosts in the order of their ids.
struct ParticlesById {
    positions: Vec<Vector>,
    species: Vec<u32>,
    owned: Vec<bool>,
}

impl ParticlesById {
    fn of(halo: &Halo, particles: &Particles) -> Self {
        let mut ids = particles.ids.clone();
        halo.extend(&mut ids);
        let mut order: Vec<u32> = (0..ids.len() as u32).collect();
        sort(ids.len(), || order.par_sort_unstable_by_key(|&row| ids[row as usize]));
        drop(ids);
        let (mut positions, mut species) = (particles.positions.clone(), particles.species.clone());
        halo.extend(&mut positions);
        halo.extend(&mut species);
        Self {
            positions: order.iter().map(|&row| positions[row as usize]).collect(),
            species: order.iter().map(|&row| species[row as usize]).collect(),
            owned: order.iter().map(|&row| (row as usize) < halo.owned()).collect(),
        }
    }

    fn is_own(&self, row: u32) -> bool {
        self.owned[row as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Comm, Partition, PeriodicBox, Random, fold_pairs};

    /// Visited pairs, sorted, to the last bit.
    fn sorted(parts: Vec<Vec<([u32; 2], Vector)>>) -> Vec<([u32; 2], [u64; 3])> {
        let bits = |(pair, separation): ([u32; 2], Vector)| (pair, separation.to_array().map(f64::to_bits));
        let mut all: Vec<_> = parts.into_iter().flatten().map(bits).collect();
        all.sort_unstable();
        all
    }

    fn keep(seen: &mut Vec<([u32; 2], Vector)>, pair: [u32; 2], separation: Vector) {
        seen.push((pair, separation));
    }

    /// Species are ids here. Cutoffs extend beyond the box, where a pair has several images.
    #[test]
    fn pairs_are_those_of_one_rank_bit_for_bit() {
        for (strain, cutoff) in [(0.0, 0.8), (0.3, 2.1), (-0.4, 5.0)] {
            let cell = PeriodicBox::sheared(Vector::new(4.0, 5.0, 6.0), strain).unwrap();
            let mut all = Particles::default();
            for id in 0..70 {
                all.push(id, cell.wrap(Random::new(1, id).point() * cell.edges()).0, 1.0, id as u32);
            }
            let expected = sorted(fold_pairs(&cell, &all.positions, cutoff, Vec::new, keep));
            assert!(!expected.is_empty());
            for (ranks, few) in [(1, FEW), (2, FEW), (3, 1), (4, 9), (7, FEW), (7, 1), (13, 1)] {
                let found = Comm::threads(ranks, |comm| {
                    let partition = Partition::new(&comm, [8, 8]);
                    let rows: Vec<usize> = (0..70).filter(|row| row % ranks == comm.rank()).collect();
                    let mut own = all.selected(&rows);
                    own.migrate(&partition, &cell);
                    let domain = DomainView { cell: &cell, partition: &partition };
                    fold_in_rounds(&SharedSearch { domain, particles: &own, cutoff, few }, Vec::new, keep).concat()
                });
                assert!(sorted(found) == expected, "{ranks} ranks, cutoff {cutoff}");
            }
        }
    }

    /// Each of five rounds brings a fifth of the ghosts, rounded up per rank, and together they bring all.
    #[test]
    fn ghosts_come_in_rounds() {
        let cell = PeriodicBox::new(Vector::splat(4.0)).unwrap();
        Comm::threads(6, |comm| {
            let partition = Partition::new(&comm, [12, 12]);
            let mut own = Particles::default();
            for id in (0..240_u64).filter(|id| *id as usize % 6 == comm.rank()) {
                own.push(id, Random::new(2, id).point() * 4.0, 1.0, 0);
            }
            own.migrate(&partition, &cell);
            let halo = Halo::plan(&partition, &cell, &own.positions, [4.0; 2]);
            assert_eq!(halo.present(), 240);
            let parts: Vec<Vec<u64>> = (0..5)
                .map(|round| {
                    let part = halo.part(round, 5);
                    let mut ids = own.ids.clone();
                    part.extend(&mut ids);
                    assert!(part.present() - part.owned() <= (240 - own.len()) / 5 + 5);
                    ids.split_off(own.len())
                })
                .collect();
            let mut all = [own.ids.clone(), parts.concat()].concat();
            all.sort_unstable();
            assert_eq!(all, (0..240).collect::<Vec<_>>());
        });
    }
}
