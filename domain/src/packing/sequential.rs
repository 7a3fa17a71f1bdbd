//! Random sequential addition of spheres, distributed over ranks.

use super::Occupied;
use crate::parallel::MeasuredLoop;
use crate::{Comm, Partition, PeriodicBox, Place, Random, Vector};
use rayon::prelude::*;

/// Tries for one sphere before it is placed with overlaps.
const TRIES: u64 = 20_000;
/// Number of spheres placed at a time.
const BATCH: usize = 1 << 13;
/// Smallest and largest number of tries of a sphere that are tested at a time.
const AT_ONCE: [f64; 2] = [2.0, 64.0];

/// Places every sphere, given by id and size and the largest first, at the first of its random positions that is free
/// of those before it. Returns this rank's spheres, and whether all were placed without overlap. `kinds` are all
/// sizes and the number of spheres with each. The result is the same on any number of ranks. Collective.
///
/// The ranks process a batch of spheres at a time. Each finds the first position of a sphere that is in its share and
/// free of the spheres of former batches; it knows those in its share and within reach around it. The first free
/// position over all ranks is that of the sphere unless one before it in the batch occupies it: then the ranks search
/// on.
pub(super) fn place(
    cell: &PeriodicBox,
    partition: &Partition,
    kinds: &[(f64, usize)],
    spheres: impl Iterator<Item = (u64, f64)>,
    seed: u64,
) -> (Vec<(u64, Vector)>, bool) {
    let (occupied, comm) = (Occupied::new(cell, kinds, Some(partition)), partition.comm());
    let local =
        LocalSearch { cell, place: partition.place(), rank: comm.rank(), seed, occupied, at_once: AT_ONCE[0] as u64 };
    let mut placing = Placing { comm, local };
    let (mut own, mut all_free) = (Vec::new(), true);
    let mut spheres = spheres.map(|(id, size)| PendingSphere { id, size, tried: 0, free: None }).peekable();
    while spheres.peek().is_some() {
        let mut batch: Vec<PendingSphere> = spheres.by_ref().take(BATCH).collect();
        let places = placing.place_batch(&mut batch);
        all_free &= batch.iter().all(|sphere| sphere.free.is_some());
        for (sphere, place) in batch.iter().zip(places) {
            placing.local.occupied.insert(sphere.size, place);
            if placing.local.has(place) {
                own.push((sphere.id, place));
            }
        }
    }
    (own, all_free)
}

/// A sphere that is not placed yet.
struct PendingSphere {
    id: u64,
    size: f64,
    /// Number of tries known not to be free.
    tried: u64,
    /// First try that is free of the spheres of former batches.
    free: Option<u64>,
}

struct Placing<'a> {
    comm: &'a Comm,
    local: LocalSearch<'a>,
}

/// Search of one rank, with all its threads.
struct LocalSearch<'a> {
    cell: &'a PeriodicBox,
    place: &'a Place,
    rank: usize,
    seed: u64,
    /// Spheres of former batches.
    occupied: Occupied<'a>,
    /// Number of tries of a sphere that are tested at a time.
    at_once: u64,
}

impl Placing<'_> {
    /// Positions for all spheres of a batch. Collective.
    fn place_batch(&mut self, batch: &mut [PendingSphere]) -> Vec<Vector> {
        self.find_first_free(batch);
        let kinds: Vec<(f64, usize)> = batch.iter().map(|sphere| (sphere.size, 1)).collect();
        let mut mates = Occupied::new(self.local.cell, &kinds, None);
        let mut places = Vec::with_capacity(batch.len());
        for k in 0..batch.len() {
            let place = self.place_in_batch(&mut batch[k..=k], &mates);
            mates.insert(batch[k].size, place);
            places.push(place);
        }
        let tried = batch.iter().map(|sphere| sphere.tried + 1).sum::<u64>() as f64 / batch.len() as f64;
        self.local.at_once = (2.0 * tried).ceil().clamp(AT_ONCE[0], AT_ONCE[1]) as u64;
        places
    }

    /// Position of a sphere that is also free of those before it in its batch. Collective.
    fn place_in_batch(&self, sphere: &mut [PendingSphere], mates: &Occupied) -> Vector {
        loop {
            let PendingSphere { id, size, free, .. } = sphere[0];
            let place = self.local.tries(id, size, free.unwrap_or(TRIES)).next().expect("tries have no end");
            if free.is_none() || mates.is_free(size, place, None) {
                return place;
            }
            (sphere[0].tried, sphere[0].free) = (free.map_or(TRIES, |tried| tried + 1), None);
            self.find_first_free(sphere);
        }
    }

    /// Finds the first free try of each sphere, if it has one. Collective.
    fn find_first_free(&self, spheres: &mut [PendingSphere]) {
        let mut left: Vec<&mut PendingSphere> = spheres.iter_mut().collect();
        while !left.is_empty() {
            let local = &self.local;
            let own: Vec<u64> = left.par_iter().map(|sphere| local.first_free(sphere)).measured().collect();
            let all = self.comm.all_gather(&own);
            for (k, sphere) in left.iter_mut().enumerate() {
                let first = all[k..].iter().step_by(own.len()).min().copied().unwrap_or(TRIES);
                sphere.free = (first < TRIES).then_some(first);
                sphere.tried = sphere.free.unwrap_or(sphere.tried + self.local.at_once);
            }
            left.retain(|sphere| sphere.free.is_none() && sphere.tried < TRIES);
        }
    }
}

impl LocalSearch<'_> {
    /// Whether a position is in this rank's share.
    fn has(&self, position: Vector) -> bool {
        self.place.owner(self.cell, position) == self.rank
    }

    /// First of the next few tries of a sphere that is in this rank's share and free; else the number of all tries.
    fn first_free(&self, &PendingSphere { id, size, tried, .. }: &PendingSphere) -> u64 {
        let until = (tried + self.at_once).min(TRIES);
        let mut tries = (tried..until).zip(self.tries(id, size, tried));
        let free = tries.find(|&(_, place)| self.has(place) && self.occupied.is_free(size, place, None));
        free.map_or(TRIES, |(number, _)| number)
    }

    /// Random positions of a sphere of a given size, clear of walls, from try number `first` on.
    fn tries(&self, id: u64, size: f64, first: u64) -> impl Iterator<Item = Vector> {
        let mut random = Random::new(self.seed, id);
        random.skip(3 * first);
        std::iter::repeat_with(move || self.cell.wrap(self.cell.off_walls(random.point() * self.cell.edges(), size)).0)
    }
}
