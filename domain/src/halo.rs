//! Halo of a rank: its ghosts, which are copies of other ranks' particles, and the return of sums from ghosts to
//! owners.

use crate::parallel::check_row_numbers;
use crate::{Incoming, Outgoing, Partition, PeriodicBox, Vector, block};
use bytemuck::Pod;
use std::borrow::Cow;
use std::ops::AddAssign;

/// Distance that a particle's influence extends beyond its own pencil, along y and along z.
pub type Reach = [f64; 2];

/// Plan of the halo exchange: the particles that each rank sends to each other rank. [`Halo::extend`] appends the
/// values of ghosts, the particles of other ranks that reach into this rank's pencil, to those of the particles that
/// the rank owns. [`Halo::collect`] returns sums of ghosts to their owners. A single rank has no ghosts. Messages go to
/// those ranks alone whose pencils are within reach.
pub struct Halo {
    comm: crate::Comm,
    owned: usize,
    leaving: Vec<Vec<u32>>,
    arriving: Vec<usize>,
}

impl Halo {
    /// Plans the halo for the particles at `positions`, inside the box, that each rank owns.
    pub fn plan(partition: &Partition, cell: &PeriodicBox, positions: &[Vector], reach: Reach) -> Self {
        check_row_numbers(positions.len());
        let comm = partition.comm().clone();
        let mut leaving = vec![Vec::new(); comm.size()];
        if comm.size() > 1 {
            let places: Vec<[f64; 2]> = positions.iter().map(|&position| Pencil::place(cell, position)).collect();
            let bounds = bounds(&places);
            for rank in (0..comm.size()).filter(|rank| *rank != comm.rank()) {
                let pencil = Pencil::of(partition, cell, rank);
                if pencil.may_reach(reach, bounds) {
                    let near = |(_, place): &(usize, &[f64; 2])| pencil.is_within(reach, **place);
                    leaving[rank] = places.iter().enumerate().filter(near).map(|(i, _)| i as u32).collect();
                }
            }
        }
        let arriving = comm.exchange_counts(&leaving.iter().map(Vec::len).collect::<Vec<_>>());
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

    /// Whether one rank has all particles, so that nothing is exchanged.
    pub fn is_alone(&self) -> bool {
        self.comm.size() == 1
    }

    /// The values of the owned particles followed by those of the ghosts: the list itself if no rank has any.
    pub fn extended<'a, T: Pod>(&self, values: &'a [T]) -> Cow<'a, [T]> {
        let mut all = Cow::Borrowed(values);
        if !self.is_alone() {
            self.extend(all.to_mut());
        }
        all
    }

    /// Appends the ghosts' values to those of the owned particles.
    pub fn extend<T: Pod>(&self, values: &mut Vec<T>) {
        assert_eq!(values.len(), self.owned, "one value a particle owned");
        if self.comm.size() == 1 {
            return;
        }
        let sent: Vec<T> = self.leaving.iter().flatten().map(|&i| values[i as usize]).collect();
        values.resize(self.present(), T::zeroed());
        let room = Incoming { room: &mut values[self.owned..], counts: &self.arriving };
        self.comm.send_receive(Outgoing { values: &sent, counts: &self.leaving_counts() }, room);
    }

    /// Adds the ghosts' values to those of the particles of which they are copies, in rank order, and drops the
    /// ghosts.
    pub fn collect<T: Pod + AddAssign>(&self, values: &mut Vec<T>) {
        assert_eq!(values.len(), self.present(), "one value a particle present");
        if self.comm.size() == 1 {
            return;
        }
        let counts = self.leaving_counts();
        let mut returned = vec![T::zeroed(); counts.iter().sum()];
        let room = Incoming { room: &mut returned, counts: &counts };
        self.comm.send_receive(Outgoing { values: &values[self.owned..], counts: &self.arriving }, room);
        values.truncate(self.owned);
        for (&i, value) in self.leaving.iter().flatten().zip(returned) {
            values[i as usize] += value;
        }
    }

    /// Number of particles that this rank sends to each other rank.
    fn leaving_counts(&self) -> Vec<usize> {
        self.leaving.iter().map(Vec::len).collect()
    }
}

/// Smallest and largest coordinates.
fn bounds(places: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let of_axis = |d: usize| {
        let coordinates = || places.iter().map(|place| place[d]);
        [coordinates().fold(f64::INFINITY, f64::min), coordinates().fold(f64::NEG_INFINITY, f64::max)]
    };
    [of_axis(0), of_axis(1)]
}

/// Pencil of a rank: intervals of the lattice coordinates along y and z, with their periods or 0.
pub(crate) struct Pencil {
    intervals: [Option<[f64; 2]>; 2],
    periods: [f64; 2],
    stretch: [f64; 2],
}

impl Pencil {
    pub fn of(partition: &Partition, cell: &PeriodicBox, rank: usize) -> Self {
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
        let period = |d: usize| if cell.is_periodic(d + 1) { lengths[d] } else { 0.0 };
        let stretch = cell.coordinate_stretch();
        Self {
            intervals: [interval(0), interval(1)],
            periods: [period(0), period(1)],
            stretch: [stretch[1], stretch[2]],
        }
    }

    /// Lattice coordinates along y and z, from the origin of the box.
    pub fn place(cell: &PeriodicBox, position: Vector) -> [f64; 2] {
        let coordinates = cell.lattice_coordinates(position) - cell.origin();
        [coordinates[1], coordinates[2]]
    }

    /// Whether a particle with these lattice coordinates reaches into the pencil.
    pub fn is_within(&self, reach: Reach, place: [f64; 2]) -> bool {
        self.may_reach(reach, place.map(|coordinate| [coordinate; 2]))
    }

    /// Whether particles with lattice coordinates between these bounds may reach into the pencil.
    fn may_reach(&self, reach: Reach, bounds: [[f64; 2]; 2]) -> bool {
        let is_near = |d: usize| {
            self.intervals[d].is_some_and(|i| distance(i, bounds[d], self.periods[d]) <= reach[d] * self.stretch[d])
        };
        is_near(0) && is_near(1)
    }
}

/// Distance between an interval and the nearest image of another one, or without a period the other one itself.
fn distance([low, high]: [f64; 2], [first, last]: [f64; 2], period: f64) -> f64 {
    let shifts = [-period, 0.0, period];
    shifts.map(|s| (low - (last + s)).max((first + s) - high).max(0.0)).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Comm, Particles};

    #[test]
    fn distances_are_those_from_the_nearest_image() {
        let cases = [(1.0, 1.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0), (5.5, 1.5), (7.5, 2.5), (-0.25, 2.25), (9.5, 0.5)];
        for (coordinate, expected) in cases {
            assert!((distance([2.0, 4.0], [coordinate; 2], 8.0) - expected).abs() < 1e-15, "{coordinate}");
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
                assert!(positions.iter().all(|&p| mine.is_within(reach, Pencil::place(&cell, p))));
                let mut counts = vec![1.0; positions.len()];
                halo.collect(&mut counts);
                for (count, &position) in counts.iter().zip(&particles.positions) {
                    let place = Pencil::place(&cell, position);
                    let near = |rank: &usize| Pencil::of(&partition, &cell, *rank).is_within(reach, place);
                    assert_eq!(*count as usize, (0..ranks).filter(near).count());
                }
            });
        }
    }
}
