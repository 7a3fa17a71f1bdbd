//! Particles of all ranks in the order of their ids, block by block on the first rank.

use crate::rows::{RowMove, RowValue, Selection};
use crate::{Comm, Particles, Vector};

/// Particles of all ranks as the first rank reads them: property by property, in the order of the ids, with no more
/// than a block of 65,536 of them in memory at a time. Made by [`Particles::by_id`].
pub struct ById<'a> {
    particles: &'a Particles,
    comm: &'a Comm,
    /// Number of ids in a block.
    block: u64,
    /// This rank's rows in the order of their ids.
    order: Vec<usize>,
    /// Number of particles of all ranks, and their last id plus one.
    count: usize,
    ids: u64,
    /// This rank's pieces, and the lengths of the pieces of all ranks.
    pieces: &'a [Vec<u8>],
    lengths: Vec<usize>,
}

/// Bytes of pieces that are sent at a time.
const PART: usize = 1 << 20;

/// Property to read; columns by their index.
#[derive(Debug, Clone, Copy)]
enum Property {
    Ids,
    Positions,
    Steps,
    Radii,
    Species,
    Piece,
    Column(usize),
}

impl Property {
    fn number(self) -> u64 {
        match self {
            Self::Ids => 0,
            Self::Positions => 1,
            Self::Steps => 2,
            Self::Radii => 3,
            Self::Species => 4,
            Self::Piece => 5,
            Self::Column(place) => 6 + place as u64,
        }
    }

    fn of(number: u64) -> Self {
        match number {
            0 => Self::Ids,
            1 => Self::Positions,
            2 => Self::Steps,
            3 => Self::Radii,
            4 => Self::Species,
            5 => Self::Piece,
            column => Self::Column(column as usize - 6),
        }
    }
}

impl Particles {
    /// Calls `read` with all particles on the first rank, to which the other ranks send theirs, and returns its
    /// result there; `None` on the others. All ranks have the same columns, and ids are unique. Collective.
    pub fn by_id<R>(&self, comm: &Comm, read: impl FnOnce(&ById) -> R) -> Option<R> {
        self.by_id_with(&[], comm, read)
    }

    /// The same, also with pieces of bytes to read; piece `k` of all ranks is on rank `k mod ranks`.
    pub fn by_id_with<R>(&self, pieces: &[Vec<u8>], comm: &Comm, read: impl FnOnce(&ById) -> R) -> Option<R> {
        ById::new(self, pieces, comm, ById::BLOCK).read(read)
    }
}

impl<'a> ById<'a> {
    /// Number of ids in a block.
    pub(crate) const BLOCK: u64 = 1 << 16;

    fn new(particles: &'a Particles, pieces: &'a [Vec<u8>], comm: &'a Comm, block: u64) -> Self {
        let mut order: Vec<usize> = (0..particles.len()).collect();
        order.sort_unstable_by_key(|&row| particles.ids[row]);
        let end = order.last().map_or(0, |&row| particles.ids[row] + 1);
        let all = comm.all_gather(&[[particles.len() as u64, end]]);
        let count = all.iter().map(|[count, _]| *count as usize).sum();
        let ids = all.iter().map(|[_, end]| *end).max().unwrap_or(0);
        let lengths = lengths(pieces, comm);
        Self { particles, comm, block, order, count, ids, pieces, lengths }
    }

    fn read<R>(&self, read: impl FnOnce(&Self) -> R) -> Option<R> {
        if !self.comm.is_first() {
            self.answer_requests();
            return None;
        }
        let found = read(self);
        self.request(None);
        Some(found)
    }

    /// Number of particles.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Names and widths of the columns.
    pub fn columns(&self) -> impl Iterator<Item = (&str, usize)> {
        self.particles.columns.iter().map(|column| (column.name.as_str(), column.width))
    }

    /// Passes the ids to `each`, block by block.
    pub fn ids<E>(&self, each: impl FnMut(&[u64]) -> Result<(), E>) -> Result<(), E> {
        self.each_block(Property::Ids, &self.particles.ids, 1, each)
    }

    /// Passes the positions to `each`, block by block.
    pub fn positions<E>(&self, each: impl FnMut(&[Vector]) -> Result<(), E>) -> Result<(), E> {
        self.each_block(Property::Positions, &self.particles.positions, 1, each)
    }

    /// Passes the lattice steps to `each`, block by block.
    pub fn steps<E>(&self, each: impl FnMut(&[[i32; 3]]) -> Result<(), E>) -> Result<(), E> {
        self.each_block(Property::Steps, &self.particles.steps, 1, each)
    }

    /// Passes the radii to `each`, block by block.
    pub fn radii<E>(&self, each: impl FnMut(&[f64]) -> Result<(), E>) -> Result<(), E> {
        self.each_block(Property::Radii, &self.particles.radii, 1, each)
    }

    /// Passes the species to `each`, block by block.
    pub fn species<E>(&self, each: impl FnMut(&[u32]) -> Result<(), E>) -> Result<(), E> {
        self.each_block(Property::Species, &self.particles.species, 1, each)
    }

    /// Passes the values of the column of an index to `each`, block by block; those of a particle are adjacent.
    pub fn column<E>(&self, place: usize, each: impl FnMut(&[f64]) -> Result<(), E>) -> Result<(), E> {
        let column = &self.particles.columns[place];
        self.each_block(Property::Column(place), &column.values, column.width, each)
    }

    /// Lengths of the pieces.
    pub fn lengths(&self) -> &[usize] {
        &self.lengths
    }

    /// Passes the bytes of the pieces to `each`, one piece after another, a MiB at a time.
    pub fn pieces<E>(&self, mut each: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        for (piece, &length) in self.lengths.iter().enumerate() {
            for part in 0..length.div_ceil(PART) {
                let number = part_number(piece, part);
                self.request(Some((Property::Piece, number)));
                each(&self.part(number))?;
            }
        }
        Ok(())
    }

    /// A part of a piece, on the first rank. Collective.
    fn part(&self, number: u64) -> Vec<u8> {
        let (piece, start) = ((number >> 32) as usize, PART * (number as u32) as usize);
        let ranks = self.comm.size();
        if piece % ranks != self.comm.rank() {
            return self.comm.gather(&[]);
        }
        let own = &self.pieces[piece / ranks];
        self.comm.gather(&own[start..own.len().min(start + PART)])
    }

    fn each_block<T: RowValue, E>(
        &self,
        property: Property,
        values: &[T],
        width: usize,
        mut each: impl FnMut(&[T]) -> Result<(), E>,
    ) -> Result<(), E> {
        for block in 0..self.ids.div_ceil(self.block) {
            self.request(Some((property, block)));
            let found = self.gathered(block, values, width);
            if !found.is_empty() {
                each(&found)?;
            }
        }
        Ok(())
    }

    /// Tells the other ranks what to send, or that reading is finished.
    fn request(&self, what: Option<(Property, u64)>) {
        if self.comm.size() > 1 {
            self.comm
                .broadcast(&mut what.into_iter().flat_map(|(property, block)| [property.number(), block]).collect());
        }
    }

    /// Answers the requests of the first rank until it has finished.
    fn answer_requests(&self) {
        let p = self.particles;
        loop {
            let mut asked = Vec::new();
            self.comm.broadcast(&mut asked);
            let [property, block] = asked[..] else { return };
            match Property::of(property) {
                Property::Ids => drop(self.gathered(block, &p.ids, 1)),
                Property::Positions => drop(self.gathered(block, &p.positions, 1)),
                Property::Steps => drop(self.gathered(block, &p.steps, 1)),
                Property::Radii => drop(self.gathered(block, &p.radii, 1)),
                Property::Species => drop(self.gathered(block, &p.species, 1)),
                Property::Piece => drop(self.part(block)),
                Property::Column(place) => {
                    drop(self.gathered(block, &p.columns[place].values, p.columns[place].width));
                }
            }
        }
    }

    /// Values of a block of ids in their order, on the first rank. Collective.
    fn gathered<T: RowValue>(&self, block: u64, values: &[T], width: usize) -> Vec<T> {
        let ids = block * self.block..(block + 1) * self.block;
        let before = |id: u64| self.order.partition_point(|&row| self.particles.ids[row] < id);
        let rows = &self.order[before(ids.start)..before(ids.end)];
        let own = Selection(rows).of(values, width);
        if self.comm.size() == 1 {
            return own;
        }
        let places: Vec<u32> = rows.iter().map(|&row| (self.particles.ids[row] - ids.start) as u32).collect();
        let (places, all) = (self.comm.gather(&places), self.comm.gather(&own));
        let mut order: Vec<usize> = (0..places.len()).collect();
        order.sort_unstable_by_key(|&row| places[row]);
        Selection(&order).of(&all, width)
    }
}

/// Number of a part of a piece.
fn part_number(piece: usize, part: usize) -> u64 {
    ((piece as u64) << 32) | part as u64
}

/// Lengths of the pieces of all ranks. Collective.
fn lengths(pieces: &[Vec<u8>], comm: &Comm) -> Vec<usize> {
    let own: Vec<usize> = pieces.iter().map(Vec::len).collect();
    let all = comm.all_gather_lists(&own);
    let count = all.iter().map(Vec::len).sum();
    (0..count).map(|piece| all[piece % all.len()][piece / all.len()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Partition, PeriodicBox};

    #[expect(clippy::unnecessary_wraps, reason = "readers may fail")]
    fn append<T: Copy>(all: &mut Vec<T>, more: &[T]) -> Result<(), ()> {
        all.extend_from_slice(more);
        Ok(())
    }

    fn scattered(count: u64) -> Particles {
        let mut particles = Particles::default();
        for k in 0..count {
            let t = k as f64;
            // Ids with gaps.
            particles.push(3 * k, Vector::new(t * 0.37, t * 0.73, t * 0.57) % 1.0 * 4.0, 1.0 + t, (k % 3) as u32);
        }
        for (id, v) in particles.vectors("velocity").iter_mut().enumerate() {
            *v = Vector::splat(id as f64);
        }
        particles.column("age", 2).values.iter_mut().enumerate().for_each(|(k, v)| *v = k as f64);
        particles.steps.iter_mut().enumerate().for_each(|(k, steps)| *steps = [k as i32, -1, 2]);
        particles
    }

    /// All data read, assembled, and the largest amount at a time.
    fn collected(rows: &ById) -> (Particles, usize) {
        let mut all = Particles::default();
        let mut most = 0;
        let ids = rows.ids(|ids| {
            most = most.max(ids.len());
            all.ids.extend(ids);
            Ok::<(), ()>(())
        });
        ids.unwrap();
        rows.positions(|x| append(&mut all.positions, x)).unwrap();
        rows.steps(|steps| append(&mut all.steps, steps)).unwrap();
        rows.radii(|radii| append(&mut all.radii, radii)).unwrap();
        rows.species(|species| append(&mut all.species, species)).unwrap();
        for (place, (name, width)) in rows.columns().enumerate() {
            let mut values = Vec::new();
            rows.column(place, |more| append(&mut values, more)).unwrap();
            all.columns.push(crate::Column { name: name.to_owned(), width, values: values.into() });
        }
        assert_eq!(rows.count(), all.len());
        (all, most)
    }

    #[test]
    fn the_first_rank_reads_all_in_blocks() {
        let cell = PeriodicBox::new(Vector::splat(4.0)).unwrap();
        let alone = scattered(60);
        for (ranks, block) in [(1, 7), (1, ById::BLOCK), (2, 1), (3, 7), (7, 50), (13, ById::BLOCK)] {
            let found = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let rows: Vec<usize> = (0..60).rev().filter(|r| r % ranks == comm.rank()).collect();
                let mut particles = alone.selected(&rows);
                particles.migrate(&partition, &cell);
                ById::new(&particles, &[], &comm, block).read(collected)
            });
            let (all, most) = found[0].clone().unwrap();
            assert_eq!(all, alone, "{ranks} ranks, blocks of {block}");
            assert!(most as u64 <= block);
            assert!(found[1..].iter().all(Option::is_none));
        }
    }

    /// A reader that fails leaves no rank waiting.
    #[test]
    fn the_first_rank_may_stop_anywhere() {
        let alone = scattered(20);
        let found = Comm::threads(3, |comm| {
            let rows: Vec<usize> = (0..20).filter(|r| r % 3 == comm.rank()).collect();
            let particles = alone.selected(&rows);
            let mut blocks = 0;
            let read = ById::new(&particles, &[], &comm, 5).read(|rows| {
                rows.radii(|_| {
                    blocks += 1;
                    if blocks == 2 { Err("no more") } else { Ok(()) }
                })
            });
            (read, particles.by_id(&comm, |rows| [rows.count(), rows.columns().count()]))
        });
        assert_eq!(found[0], (Some(Err("no more")), Some([20, alone.columns.len()])));
    }

    /// Pieces of any length, also longer than a part, arrive in the order of their numbers.
    #[test]
    fn pieces_are_read_in_their_order() {
        let all: Vec<Vec<u8>> =
            (0..9_u8).map(|k| vec![k; if k == 4 { 2 * PART + 7 } else { usize::from(k) * 3 }]).collect();
        for (ranks, count) in [(1, 9), (2, 9), (3, 8), (7, 9), (13, 9), (3, 1), (2, 0)] {
            let found = Comm::threads(ranks, |comm| {
                let own: Vec<Vec<u8>> = all[..count].iter().skip(comm.rank()).step_by(ranks).cloned().collect();
                Particles::default().by_id_with(&own, &comm, |rows| {
                    let mut bytes = Vec::new();
                    rows.pieces(|part| {
                        assert!(part.len() <= PART);
                        append(&mut bytes, part)
                    })
                    .unwrap();
                    (bytes, rows.lengths().to_vec())
                })
            });
            let lengths = all[..count].iter().map(Vec::len).collect();
            assert_eq!(found[0], Some((all[..count].concat(), lengths)), "{ranks} ranks, {count} pieces");
        }
    }
}
