//! Verlet lists: neighbour lists with a skin, which stay valid while no particle moves farther than half the skin.

use crate::halo::Pencil;
use crate::neighbours::Batch;
use crate::parallel::{MeasuredLoop, all_rows, check_row_numbers, copied, of_rows, rows, sort};
use crate::{Halo, Neighbour, Neighbours, Partition, PeriodicBox, Tensor, Vector};
use rayon::prelude::*;
use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Neighbours of each particle within a cutoff. The lists extend beyond the cutoff by a skin and are rebuilt only
/// when some particle has moved too far (Verlet, Phys. Rev. 159, 98, 1967); neighbours within the cutoff are selected
/// from them.
///
/// Lists refer to particles by their rows at the last rebuild, since rows are sorted again as particles move. Each is
/// in the order of the ids, so results do not depend on when lists were rebuilt. With several ranks there are also
/// lists of particles that may migrate from other ranks.
pub struct VerletList {
    cutoff: f64,
    /// Skin over the cutoff.
    skin: f64,
    partition: Partition,
    stored: Option<StoredLists>,
    /// Present state of the listed particles, after [`Self::track`].
    now: Option<PresentState>,
    near: Neighbours,
    searches: u64,
}

/// Local particles of a rank followed by its ghosts, which are copies of particles of other ranks.
#[derive(Debug, Clone, Copy)]
pub struct LocalAndGhosts<'a> {
    /// Number of particles that the rank owns, which come first.
    pub owned: usize,
    /// Ids of all of them.
    pub ids: &'a [u64],
    /// Positions of all of them, inside the box.
    pub positions: &'a [Vector],
}

/// Lists of a rebuild, and the positions at that time.
struct StoredLists {
    cell: PeriodicBox,
    /// Rows at the rebuild.
    rows: RowById,
    positions: Vec<Vector>,
    /// Whether the list of each row is complete.
    listed: Vec<bool>,
    reach: f64,
    lists: Neighbours,
}

/// Skin over the cutoff. It makes lists a third longer, which is cheap compared with a rebuild.
const SKIN: f64 = 0.1;

/// Ratio of the largest id to the number of particles present up to which a table of ids is used.
pub(crate) const SPARSEST: usize = 8;

/// Particles whose lists one thread processes at a time.
const BATCH: usize = 256;

impl VerletList {
    /// Range of the lists over the cutoff.
    pub const REACH: f64 = 1.0 + SKIN;

    /// Empty lists, on the ranks of a domain decomposition.
    pub fn new(cutoff: f64, partition: &Partition) -> Self {
        let (partition, near) = (partition.clone(), Neighbours::default());
        Self { cutoff, skin: SKIN, partition, stored: None, now: None, near, searches: 0 }
    }

    /// The same with another skin over the cutoff.
    #[must_use]
    pub fn with_skin(self, skin: f64) -> Self {
        Self { skin, ..self }
    }

    /// Neighbours of each owned particle within the cutoff at the last positions, by row.
    pub fn neighbours(&self) -> &Neighbours {
        &self.near
    }

    /// Number of rebuilds so far.
    pub fn searches(&self) -> u64 {
        self.searches
    }

    /// Updates the neighbours to new positions, and rebuilds the lists if necessary. The ghosts have to include all
    /// particles within the cutoff of an owned one. Collective.
    pub fn update(&mut self, cell: &PeriodicBox, present: &LocalAndGhosts) {
        self.near = Neighbours::default();
        self.track(cell, present);
        self.near = self.within(self.cutoff);
        self.now = None;
    }

    /// Follows the particles to new positions, and rebuilds the lists if necessary, for [`Self::within`]. The ghosts
    /// have to include all particles within the cutoff of an owned one. Collective.
    pub fn track(&mut self, cell: &PeriodicBox, present: &LocalAndGhosts) {
        let cutoff = self.cutoff;
        let tracked = |stored: &StoredLists| stored.track(cell, present, cutoff);
        self.now = None;
        let now = self.stored.as_ref().and_then(tracked);
        if !self.partition.comm().any(now.is_none()) {
            self.now = now;
            return;
        }
        // Frees memory that is no longer needed.
        drop(now);
        self.stored = None;
        let found = self.search(cell, present);
        self.now = tracked(&found);
        self.stored = Some(found);
    }

    /// Neighbours of each owned particle within a range, which is at most the cutoff, at the positions of the last
    /// [`Self::track`].
    pub fn within(&self, range: f64) -> Neighbours {
        let Some(stored) = &self.stored else { return Neighbours::default() };
        // A position that is NaN can't be followed.
        self.now.as_ref().map_or_else(|| stored.lists.clone(), |now| stored.within(now, range))
    }

    fn search(&mut self, cell: &PeriodicBox, present: &LocalAndGhosts) -> StoredLists {
        let comm = self.partition.comm();
        let (mut ids, mut positions) = (Cow::Borrowed(present.ids), copied(present.positions));
        // A single search needs no skin.
        let skin = if self.searches > 0 { self.skin } else { 0.0 };
        self.searches += 1;
        let reach = (1.0 + skin) * self.cutoff;
        let mut listed = vec![true; present.owned];
        if skin > 0.0 && comm.size() > 1 {
            // Particles that may become owned before the next search, and all in their lists.
            let margin = 0.5 * (reach - self.cutoff);
            let halo = Halo::plan(&self.partition, cell, &positions[..present.owned], [reach + margin; 2]);
            ids = Cow::Owned(ids[..present.owned].to_vec());
            positions.truncate(present.owned);
            halo.extend(ids.to_mut());
            halo.extend(&mut positions);
            let pencil = Pencil::of(&self.partition, cell, comm.rank());
            listed = positions
                .iter()
                .map(|&position| pencil.is_within([margin; 2], Pencil::place(cell, position)))
                .collect();
        }
        let key = |neighbour: &Neighbour| (ids[neighbour.row as usize], neighbour.steps);
        let lists = Neighbours::find_in_order(cell, &positions, listed.len(), reach, key);
        listed.resize(ids.len(), false);
        let rows = RowById::new(&ids);
        StoredLists { cell: *cell, rows, positions, listed, reach, lists }
    }
}

/// Row of an id without a particle.
const NOBODY: u32 = u32::MAX;

/// Rows of ids: a table over all ids if it is not much longer than a list of those present.
enum RowById {
    Table(Vec<AtomicU32>),
    /// In the order of the ids.
    List(Vec<(u64, u32)>),
}

impl RowById {
    /// For ids in the order of their rows.
    fn new(ids: &[u64]) -> Self {
        check_row_numbers(ids.len());
        let last = ids.par_iter().with_min_len(BATCH).copied().measured().max().unwrap_or(0);
        if last >= (SPARSEST * ids.len()) as u64 {
            let mut list = of_rows(ids.len(), |row| (ids[row], row as u32));
            sort(list.len(), || list.par_sort_unstable());
            return Self::List(list);
        }
        let table = nobody(last as usize + 1);
        rows(ids.len()).measured().for_each(|row| table[ids[row] as usize].store(row as u32, Ordering::Relaxed));
        Self::Table(table)
    }

    fn get(&self, id: u64) -> Option<usize> {
        let row = match self {
            Self::Table(table) => table.get(usize::try_from(id).ok()?)?.load(Ordering::Relaxed),
            Self::List(list) => list[list.binary_search_by_key(&id, |&(known, _)| known).ok()?].1,
        };
        (row != NOBODY).then_some(row as usize)
    }
}

/// Rows without particles, which threads fill in.
fn nobody(count: usize) -> Vec<AtomicU32> {
    of_rows(count, |_| AtomicU32::new(NOBODY))
}

/// Present state of the particles of the last rebuild. Those that have left this rank have no neighbours.
struct PresentState {
    owned: usize,
    particles: Vec<PresentParticle>,
    /// Offset from the box to each image.
    offsets: Vec<Vector>,
}

/// Present state of a particle of the last rebuild, in half a cache line.
#[derive(Clone, Copy)]
#[repr(align(32))]
struct PresentParticle {
    /// Position without wrapping since then.
    place: Vector,
    /// Present row.
    row: u32,
    /// Shift that wrapping takes out of the entry of an image.
    shift: u32,
}

const _: () = assert!(size_of::<PresentParticle>() == 32);

impl StoredLists {
    /// Present state of the listed particles; `None` if a pair within the cutoff may be missing in the lists.
    ///
    /// A deformation of the box moves no particle in fractions of the lattice vectors. It reduces distances by its
    /// least stretch at most, which in simple shear is `sqrt(1 + g^2/4) - g/2` at the strain `g` since the rebuild. A
    /// box that follows the particles moves none either: positions are relative to its origin.
    fn track(&self, cell: &PeriodicBox, present: &LocalAndGhosts, cutoff: f64) -> Option<PresentState> {
        let (edges, images) = (cell.edges(), self.lists.images());
        if !images.reach(cell, cutoff) {
            return None;
        }
        let least_stretch = match (cell.axes(), self.cell.axes()) {
            (None, None) if edges == self.cell.edges() => {
                let half = 0.5 * (cell.strain() - self.cell.strain()).abs();
                (1.0 + half * half).sqrt() - half
            }
            (None, None) => return None,
            _ => least_stretch(&self.cell, cell),
        };
        images.check_rows(present.positions.len());
        let rows_now = self.rows_now(present)?;
        let spare = self.reach * least_stretch - cutoff;
        let before_to_now = edges / self.cell.edges();
        let all_near = AtomicBool::new(true);
        let track = |before: usize| {
            let row = rows_now[before].load(Ordering::Relaxed);
            let Some(&now) = present.positions.get(row as usize) else {
                return PresentParticle { place: Vector::NAN, row, shift: 0 };
            };
            let past = (self.cell.lattice_coordinates(self.positions[before]) - self.cell.origin()) * before_to_now;
            let moved = cell.lattice_coordinates(now) - cell.origin() - past;
            let steps = cell.whole_steps(moved);
            let moved = cell.position(moved - steps * edges);
            // Both particles of a pair may have moved. Images are checked by their owners.
            let is_near = 4.0 * moved.length_squared() <= spare * spare && spare >= 0.0;
            if (row as usize) < present.owned && !(is_near && self.listed[before]) {
                all_near.store(false, Ordering::Relaxed);
            }
            let steps = steps.to_array().map(|s| s as i32);
            let place = if steps == [0; 3] { now } else { now - cell.lattice(steps) };
            PresentParticle { place, row, shift: images.shift(steps) }
        };
        let particles = of_rows(rows_now.len(), track);
        let offsets = images.steps().map(|steps| cell.lattice(steps)).collect();
        all_near.into_inner().then_some(PresentState { owned: present.owned, particles, offsets })
    }

    /// Present rows by rows of the rebuild; `None` if the rank owns a particle that was not here then.
    fn rows_now(&self, present: &LocalAndGhosts) -> Option<Vec<AtomicU32>> {
        let rows_now = nobody(self.positions.len());
        let were_here = all_rows(present.ids.len(), |row| match self.rows.get(present.ids[row]) {
            Some(before) => {
                rows_now[before].store(row as u32, Ordering::Relaxed);
                true
            }
            None => row >= present.owned,
        });
        were_here.then_some(rows_now)
    }

    /// Neighbours in the lists that are within a cutoff.
    fn within(&self, now: &PresentState, cutoff: f64) -> Neighbours {
        let count = now.particles.len();
        let pick = |batch: usize| {
            let is_owned = |&row: &usize| (now.particles[row].row as usize) < now.owned;
            let rows = (batch * BATCH..count.min((batch + 1) * BATCH)).filter(is_owned);
            let mut picked = Batch::default();
            picked.ends.reserve_exact(rows.clone().count());
            picked.list.reserve_exact(rows.clone().map(|row| self.lists.entries(row).len()).sum());
            for row in rows {
                self.pick(row, now, cutoff, &mut picked.list);
                picked.ends.push((now.particles[row].row, picked.list.len()));
            }
            picked
        };
        let batches = (0..count.div_ceil(BATCH)).into_par_iter().map(pick).measured().collect();
        Neighbours::join(batches, now.owned, self.lists.images())
    }

    /// Appends the neighbours in a row's list that are within the cutoff.
    fn pick(&self, row: usize, now: &PresentState, cutoff: f64, picked: &mut Vec<u32>) {
        let (images, list) = (self.lists.images(), self.lists.entries(row));
        let PresentParticle { place, shift: home, .. } = now.particles[row];
        let mut found = picked.len();
        picked.resize(found + list.len(), 0);
        for &entry in list {
            let PresentParticle { place: there, row: other, shift: away, .. } =
                now.particles[images.row(entry) as usize];
            let x = place - there - now.offsets[images.number(entry)];
            // Without a branch, which would often be mispredicted.
            picked[found] = images.moved(entry, other, home.wrapping_sub(away));
            found += usize::from(x.length_squared() < cutoff * cutoff);
        }
        picked.truncate(found);
    }
}

/// Lower bound of the factors by which distances change when a box is deformed into another: `1 / (1 + |F^-1 - I|)`
/// with the inverse deformation `F^-1` in the Frobenius norm.
fn least_stretch(before: &PeriodicBox, now: &PeriodicBox) -> f64 {
    let vectors = |cell: &PeriodicBox| Tensor::from_cols_array_2d(&cell.lattice_vectors().map(|v| v.to_array()));
    let back = vectors(before) * vectors(now).inverse();
    let change = back - Tensor::IDENTITY;
    let norm = change.to_cols_array().into_iter().map(|x| x * x).sum::<f64>().sqrt();
    1.0 / (1.0 + norm)
}

#[cfg(test)]
mod tests;
