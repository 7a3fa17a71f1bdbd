//! Halo of a rank: its ghosts, which are copies of other ranks' particles, and the return of sums from ghosts to
//! owners.

use crate::{Partition, PeriodicBox, Vector, block};
use bytemuck::Pod;
use std::ops::AddAssign;

/// Distance that a particle's influence extends beyond its own pencil, along y and along z.
pub type Reach = [f64; 2];

/// Plan of the halo exchange: the particles that each rank sends to each other rank. [`Halo::extend`] appends the
/// values of ghosts, the particles of other ranks that reach into this rank's pencil, to those of the particles that
/// the rank owns. [`Halo::collect`] returns sums of ghosts to their owners. A single rank has no ghosts.
pub struct Halo {
    comm: crate::Comm,
    owned: usize,
    leaving: Vec<Vec<u32>>,
    arriving: Vec<usize>,
}

impl Halo {
    /// Plans the halo for the particles at `positions`, inside the box, that each rank owns.
    pub fn plan(partition: &Partition, cell: &PeriodicBox, positions: &[Vector], reach: Reach) -> Self {
        let comm = partition.comm().clone();
        let mut leaving = vec![Vec::new(); comm.size()];
        if comm.size() > 1 {
            let pencils: Vec<_> = (0..comm.size()).map(|rank| Pencil::of(partition, cell, rank)).collect();
            for (rank, pencil) in pencils.iter().enumerate().filter(|(rank, _)| *rank != comm.rank()) {
                let near = |(_, position): &(usize, &Vector)| pencil.is_within(reach, **position);
                leaving[rank] = positions.iter().enumerate().filter(near).map(|(i, _)| i as u32).collect();
            }
        }
        let counts: Vec<Vec<usize>> = leaving.iter().map(|list| vec![list.len()]).collect();
        let arriving = comm.exchange(&counts).concat();
        Self { comm, owned: positions.len(), leaving, arriving }
    }

    /// One of `parts` parts of this halo, of about equal size, which together are the whole.
    pub(crate) fn part(&self, index: usize, parts: usize) -> Self {
        let share = |length: usize| block(length, parts, index);
        let leaving = self.leaving.iter().map(|list| list[share(list.len())].to_vec()).collect();
        let arriving = self.arriving.iter().map(|&count| share(count).len()).collect();
        Self { comm: self.comm.clone(), owned: self.owned, leaving, arriving }
    }

    /// Number of particles that this rank owns.
    pub fn owned(&self) -> usize {
        self.owned
    }

    /// Number of owned particles and ghosts.
    pub fn present(&self) -> usize {
        self.owned + self.arriving.iter().sum::<usize>()
    }

    /// Appends the ghosts' values to those of the owned particles.
    pub fn extend<T: Pod>(&self, values: &mut Vec<T>) {
        assert_eq!(values.len(), self.owned, "one value a particle owned");
        if self.comm.size() == 1 {
            return;
        }
        let pick = |list: &Vec<u32>| list.iter().map(|&i| values[i as usize]).collect();
        let send: Vec<Vec<T>> = self.leaving.iter().map(pick).collect();
        let counts: Vec<usize> = send.iter().map(Vec::len).collect();
        values.resize(self.present(), T::zeroed());
        self.comm.all_to_all((&send.concat(), &counts), (&mut values[self.owned..], &self.arriving));
    }

    /// Adds the ghosts' values to those of the particles of which they are copies, in rank order, and drops the
    /// ghosts.
    pub fn collect<T: Pod + AddAssign>(&self, values: &mut Vec<T>) {
        assert_eq!(values.len(), self.present(), "one value a particle present");
        if self.comm.size() == 1 {
            return;
        }
        let counts: Vec<usize> = self.leaving.iter().map(Vec::len).collect();
        let mut returned = vec![T::zeroed(); counts.iter().sum()];
        self.comm.all_to_all((&values[self.owned..], &self.arriving), (&mut returned, &counts));
        values.truncate(self.owned);
        for (&i, value) in self.leaving.iter().flatten().zip(returned) {
            values[i as usize] += value;
        }
    }
}

/// Pencil of a rank: intervals of the lattice coordinates along y and z.
pub(crate) struct Pencil<'a> {
    cell: &'a PeriodicBox,
    intervals: [Option<[f64; 2]>; 2],
}

impl<'a> Pencil<'a> {
    pub fn of(partition: &Partition, cell: &'a PeriodicBox, rank: usize) -> Self {
        let lengths = [cell.edges().y, cell.edges().z];
        let owned = partition.owned_by(rank);
        let interval = |d: usize| {
            let line = lengths[d] / partition.lines()[d] as f64;
            let (range, repeats) = (&owned[d], cell.is_periodic(d + 1));
            // Positions outside of a box that is not periodic belong to the ranks at its ends.
            let low = if repeats || range.start > 0 { range.start as f64 * line } else { f64::NEG_INFINITY };
            let is_last = range.end == partition.lines()[d];
            let high = if repeats || !is_last { range.end as f64 * line } else { f64::INFINITY };
            (!range.is_empty()).then_some([low, high])
        };
        Self { cell, intervals: [interval(0), interval(1)] }
    }

    pub fn is_within(&self, reach: Reach, position: Vector) -> bool {
        let (coordinates, stretch) =
            (self.cell.lattice_coordinates(position) - self.cell.origin(), self.cell.coordinate_stretch());
        let is_near = |d: usize| {
            let repeats = self.cell.is_periodic(d + 1);
            let (coordinate, period) = (coordinates[d + 1], if repeats { self.cell.edges()[d + 1] } else { 0.0 });
            self.intervals[d].is_some_and(|i| distance(i, coordinate, period) <= reach[d] * stretch[d + 1])
        };
        is_near(0) && is_near(1)
    }
}

/// Distance of a coordinate from the nearest image of an interval, or without a period from the interval itself.
fn distance([low, high]: [f64; 2], coordinate: f64, period: f64) -> f64 {
    let images = [coordinate - period, coordinate, coordinate + period];
    images.map(|c| (low - c).max(c - high).max(0.0)).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Comm, Particles};

    #[test]
    fn distances_are_those_from_the_nearest_image() {
        let cases = [(1.0, 1.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0), (5.5, 1.5), (7.5, 2.5), (-0.25, 2.25), (9.5, 0.5)];
        for (coordinate, expected) in cases {
            assert!((distance([2.0, 4.0], coordinate, 8.0) - expected).abs() < 1e-15, "{coordinate}");
        }
    }

    /// Every rank counts the particles that reach into its pencil, and the owners must receive the sums.
    #[test]
    fn images_are_those_in_reach_and_their_sums_come_home() {
        let cell = PeriodicBox::new(Vector::splat(8.0)).unwrap();
        let reach = [1.3, 0.7];
        for ranks in [1, 2, 3, 4, 7, 12, 13, 16, 64] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::with_table(&comm, [8, 8], if ranks == 12 { [3, 4] } else { [1, ranks] });
                let mut particles = Particles::default();
                for id in (0..200_u64).filter(|id| *id as usize % ranks == comm.rank()) {
                    let t = id as f64;
                    particles.push(id, Vector::new(t * 0.37, t * 0.73, t * 0.57) % Vector::ONE * 8.0, 1.0, 0);
                }
                particles.migrate(&partition, &cell);
                let halo = Halo::plan(&partition, &cell, &particles.positions, reach);
                let mut positions = particles.positions.clone();
                halo.extend(&mut positions);
                assert_eq!((halo.owned(), halo.present()), (particles.len(), positions.len()));
                let mine = Pencil::of(&partition, &cell, comm.rank());
                assert!(positions.iter().all(|&p| mine.is_within(reach, p)));
                let mut counts = vec![1.0; positions.len()];
                halo.collect(&mut counts);
                for (count, &position) in counts.iter().zip(&particles.positions) {
                    let near = |rank: &usize| Pencil::of(&partition, &cell, *rank).is_within(reach, position);
                    assert_eq!(*count as usize, (0..ranks).filter(near).count());
                }
            });
        }
    }
}
