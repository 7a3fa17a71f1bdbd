//! Near-field resistance matrix in sparse storage.

use crate::pairs::matrix::diagonal_block::{DiagonalBlock, Inverses};
use crate::pairs::matrix::inverse_block::Block;
use crate::pairs::matrix::lanes::{LANES, SimdLanes, StoredLanes, transpose};
use crate::pairs::matrix::within_bodies::StoredPair;
use crate::six_vector::SixVector;
use bytemuck::{Pod, Zeroable};
use domain::Traceless;
use domain::parallel::{all_rows, in_blocks};
use lubrication::Arithmetic;
use simd::{SimdVector as Width, VectorKernel};
use solver::Real;

/// Number of rows that one thread processes at a time.
pub const ROWS: usize = 64;

/// Resistance of near pairs to rigid-body motions, as a sparse matrix: with the unit vector `z` along each pair, the
/// loads of [`lubrication::Coefficients`]. The row of each particle of a rank has all of its pairs, so that a pair is
/// stored in the rows of both particles.
///
/// Rows are processed in SIMD lanes, pair by pair. Each slice has rows of similar length, longest first, so that few
/// lanes are empty (sliced ELLPACK, Kreutzer et al. 2014, doi:10.1137/130930352). Coefficients of pairs are stored in
/// single or double precision; sums and diagonal blocks are always in double precision.
pub struct PairMatrix<T> {
    pub(super) parts: Vec<MatrixPart<T>>,
}

/// Matrix rows of a block of particles.
pub struct MatrixPart<T> {
    /// Diagonal blocks.
    pub(super) own: Vec<DiagonalBlock<f64>>,
    slices: Vec<Slice>,
    pub(super) groups: Vec<LaneGroup<T>>,
    moments: Vec<MomentGroup<T>>,
    /// Pairs within rigid bodies.
    pub(super) within_bodies: Vec<StoredPair>,
    /// Number of groups that have been filled.
    filled: usize,
}

/// Rows that are processed together, one per lane; rows without pairs are in no slice.
#[derive(Debug, Clone, Copy)]
pub struct Slice {
    /// Rows within the block; the first `count` entries are valid.
    rows: [u32; LANES],
    count: usize,
    /// End of the slice in the groups.
    end: usize,
}

/// One pair of each row of a slice: coefficients of the loads due to the motion of the other particle; empty lanes are
/// zero.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub struct LaneGroup<T> {
    pub axis: [[T; LANES]; 3],
    pub ya: [T; LANES],
    /// Translation along the axis minus translation across it: `xa - ya`.
    pub axial_excess: [T; LANES],
    pub yc: [T; LANES],
    /// Rotation about the axis minus rotation across it: `xc - yc`.
    pub spin_excess: [T; LANES],
    /// Coefficients of the force due to the other's angular velocity, and of the torque due to its velocity.
    pub yb: [[T; LANES]; 2],
    /// Rows of the other particles.
    pub others: [u32; LANES],
}

/// A group of pairs to be filled: coefficients of loads and of first moments.
pub struct GroupOfPairs<'a, T> {
    pub group: &'a mut LaneGroup<T>,
    pub moments: &'a mut MomentGroup<T>,
}

/// Coefficients of the first moments on the rows' particles, due to their own motions and to those of the others.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub struct MomentGroup<T> {
    pub xg: [[T; LANES]; 2],
    pub yg: [[T; LANES]; 2],
    pub yh: [[T; LANES]; 2],
}

impl Slice {
    /// A slice of at most [`LANES`] rows of a block.
    pub fn new(rows: &[u32]) -> Self {
        let mut slice = Self { rows: [0; LANES], count: rows.len(), end: 0 };
        slice.rows[..rows.len()].copy_from_slice(rows);
        slice
    }

    /// The rows of the slice, lane by lane.
    pub fn rows(&self) -> &[u32] {
        &self.rows[..self.count]
    }
}

impl<T: StoredLanes> MatrixPart<T> {
    /// A block of `rows` rows, with room for `groups` groups.
    pub fn new(rows: usize, groups: usize) -> Self {
        Self {
            own: vec![DiagonalBlock::default(); rows],
            slices: Vec::with_capacity(rows.div_ceil(LANES)),
            groups: vec![LaneGroup::zeroed(); groups],
            moments: vec![MomentGroup::zeroed(); groups],
            within_bodies: Vec::new(),
            filled: 0,
        }
    }

    /// The next group of the current slice.
    #[inline(always)]
    pub fn group(&mut self) -> GroupOfPairs<'_, T> {
        let next = self.filled;
        self.filled += 1;
        GroupOfPairs { group: &mut self.groups[next], moments: &mut self.moments[next] }
    }

    /// Marks the pair of a row in a lane of the last group as one within a rigid body.
    pub fn mark_body(&mut self, row: u32, lane: usize) {
        self.within_bodies.push(StoredPair { row, group: self.filled as u32 - 1, lane: lane as u32 });
    }

    /// Sorts the marked pairs by their rows.
    pub fn sort_marked(&mut self) {
        self.within_bodies.sort_unstable();
    }

    /// Ends a slice and stores the diagonal blocks of its rows, given lane by lane.
    pub fn end_slice(&mut self, slice: Slice, own: &[DiagonalBlock<f64>; LANES]) {
        for (&row, own) in slice.rows().iter().zip(own) {
            self.own[row as usize] = *own;
        }
        self.slices.push(Slice { end: self.filled, ..slice });
    }

    /// Slices with the ranges of their groups.
    pub(super) fn slices(&self) -> impl Iterator<Item = (&Slice, std::ops::Range<usize>)> {
        let starts = std::iter::once(0).chain(self.slices.iter().map(|slice| slice.end));
        self.slices.iter().zip(starts).map(|(slice, start)| (slice, start..slice.end))
    }
}

impl<T: StoredLanes> PairMatrix<T> {
    /// The matrix of blocks of [`ROWS`] rows each, except for the last.
    pub fn new(parts: Vec<MatrixPart<T>>) -> Self {
        Self { parts }
    }

    /// The matrix of rows without pairs.
    pub fn without_pairs(rows: usize) -> Self {
        let part = |part: usize| MatrixPart::new((rows - part * ROWS).min(ROWS), 0);
        Self::new((0..rows.div_ceil(ROWS)).map(part).collect())
    }

    /// Adds to the diagonal block of a row.
    pub fn add_own(&mut self, row: usize, own: &DiagonalBlock<f64>) {
        self.parts[row / ROWS].own[row % ROWS].add(own);
    }

    /// Whether a sphere has a resistance to translation, summed over three directions, of more than `least` times its
    /// drag alone.
    pub fn holds(&self, single: &[SixVector], least: f64) -> bool {
        !all_rows(single.len(), |row| {
            let DiagonalBlock { force: [xx, _, _, yy, _, zz], .. } = self.parts[row / ROWS].own[row % ROWS];
            xx + yy + zz <= least * single[row].0[0]
        })
    }

    /// Inverses of the diagonal blocks plus the single-sphere resistances, after a function has changed each block.
    pub fn inverses(&self, single: &[SixVector], change: impl Fn(usize, &mut DiagonalBlock<f64>) + Sync) -> Vec<Block> {
        let inverses = in_blocks(single.len(), ROWS, |first, blocks| {
            let (mut own, single) = (self.parts[first / ROWS].own.clone(), &single[first..first + blocks.len()]);
            own.iter_mut().zip(first..).for_each(|(own, row)| change(row, own));
            f64::dispatch(Inverses { own: &own, single, blocks });
        });
        inverses.0
    }
}

/// Near-field resistance matrix, stored in either precision.
pub trait Resistance: Sync {
    /// Whether there are no pairs.
    fn is_empty(&self) -> bool;

    /// Adds the loads due to the motions of particles and ghosts, for the rows of a block.
    fn add_loads(&self, part: usize, present: &[Padded], loads: &mut [SixVector]);

    /// Adds the first moments due to the motions of particles and ghosts, for the rows of a block.
    fn add_moments(&self, part: usize, present: &[Padded], moments: &mut [Traceless]);
}

impl<T: StoredLanes> Resistance for PairMatrix<T> {
    fn is_empty(&self) -> bool {
        self.parts.iter().all(|part| part.groups.is_empty())
    }

    fn add_loads(&self, part: usize, present: &[Padded], loads: &mut [SixVector]) {
        if let Some(rows) = self.parts.get(part) {
            f64::dispatch(Product { part: rows, first: part * ROWS, present, loads });
        }
    }

    fn add_moments(&self, part: usize, present: &[Padded], moments: &mut [Traceless]) {
        if let Some(rows) = self.parts.get(part) {
            f64::dispatch(MomentRows { part: rows, first: part * ROWS, present, sums: moments });
        }
    }
}

/// A motion padded to a whole SIMD vector.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Padded([f64; LANES]);

impl Padded {
    /// A motion with zeros behind it.
    pub fn of(vector: &SixVector) -> Self {
        let [ux, uy, uz, ox, oy, oz] = vector.0;
        Self([ux, uy, uz, ox, oy, oz, 0.0, 0.0])
    }
}

/// Velocities and angular velocities of the particles in `rows`, one per lane.
#[inline(always)]
fn gathered<V: Width<f64>>(present: &[Padded], rows: &[u32; LANES]) -> [[SimdLanes<V>; 3]; 2] {
    let mut records = [[0.0; LANES]; LANES];
    for lane in 0..LANES {
        records[lane] = present[rows[lane] as usize].0;
    }
    let mut lanes = [[0.0; LANES]; LANES];
    transpose::<V, LANES>(&records, 0, &mut lanes);
    let mut motions = [[SimdLanes::constant(0.0); 3]; 2];
    for k in 0..3 {
        motions[0][k] = SimdLanes::read(&lanes[k]);
        motions[1][k] = SimdLanes::read(&lanes[3 + k]);
    }
    motions
}

/// Transposes sums from lanes to rows; missing numbers are zero.
#[inline(always)]
pub fn scattered<V: Width<f64>>(sums: &[SimdLanes<V>]) -> [[f64; LANES]; LANES] {
    let mut lanes = [[0.0; LANES]; LANES];
    for k in 0..sums.len() {
        sums[k].write(&mut lanes[k]);
    }
    let mut records = [[0.0; LANES]; LANES];
    transpose::<V, LANES>(&lanes, 0, &mut records);
    records
}

#[inline(always)]
fn dot<V: Width<f64>>(a: [SimdLanes<V>; 3], b: [SimdLanes<V>; 3]) -> SimdLanes<V> {
    (a[0] * b[0]).plus(a[1], b[1]).plus(a[2], b[2])
}

#[inline(always)]
fn cross<V: Width<f64>>(a: [SimdLanes<V>; 3], b: [SimdLanes<V>; 3]) -> [SimdLanes<V>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn axis<T: StoredLanes, V: Width<f64>>(group: &LaneGroup<T>) -> [SimdLanes<V>; 3] {
    [T::lanes(&group.axis[0]), T::lanes(&group.axis[1]), T::lanes(&group.axis[2])]
}

/// Product of a block of rows and the motions.
struct Product<'a, T> {
    part: &'a MatrixPart<T>,
    first: usize,
    present: &'a [Padded],
    loads: &'a mut [SixVector],
}

impl<T: StoredLanes> VectorKernel<f64> for Product<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for (k, (own, loads)) in self.part.own.chunks(LANES).zip(self.loads.chunks_mut(LANES)).enumerate() {
            let mut rows = [(self.first + k * LANES) as u32; LANES];
            (0..own.len()).for_each(|lane| rows[lane] += lane as u32);
            let records = scattered(&DiagonalBlock::<SimdLanes<V>>::of(own).times(gathered(self.present, &rows)));
            for (load, record) in loads.iter_mut().zip(&records) {
                for k in 0..6 {
                    load.0[k] += record[k];
                }
            }
        }
        for (slice, groups) in self.part.slices() {
            let mut sums = [SimdLanes::<V>::constant(0.0); 6];
            for group in &self.part.groups[groups] {
                group.add(self.present, &mut sums);
            }
            let records = scattered(&sums);
            for (&row, record) in slice.rows().iter().zip(&records) {
                let load = &mut self.loads[row as usize].0;
                for k in 0..6 {
                    load[k] += record[k];
                }
            }
        }
    }
}

impl<T: StoredLanes> LaneGroup<T> {
    /// Adds the loads due to the motions of the other particles.
    #[inline(always)]
    fn add<V: Width<f64>>(&self, present: &[Padded], sums: &mut [SimdLanes<V>; 6]) {
        let ([u, o], z) = (gathered::<V>(present, &self.others), axis::<T, V>(self));
        let along = dot(z, u) * T::lanes(&self.axial_excess);
        let spin = dot(z, o) * T::lanes(&self.spin_excess);
        let (turning, moving) = (cross(o, z), cross(z, u));
        let (across, roll) = (T::lanes(&self.ya), T::lanes(&self.yc));
        let coupling = [T::lanes(&self.yb[0]), T::lanes(&self.yb[1])];
        for k in 0..3 {
            sums[k] = sums[k].plus(across, u[k]).plus(along, z[k]).plus(coupling[0], turning[k]);
            sums[3 + k] = sums[3 + k].plus(roll, o[k]).plus(spin, z[k]).plus(coupling[1], moving[k]);
        }
    }
}

/// First moments of a block of rows.
struct MomentRows<'a, T> {
    part: &'a MatrixPart<T>,
    first: usize,
    present: &'a [Padded],
    sums: &'a mut [Traceless],
}

impl<T: StoredLanes> VectorKernel<f64> for MomentRows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for (slice, groups) in self.part.slices() {
            let mut rows = [self.first as u32; LANES];
            for (lane, row) in slice.rows().iter().enumerate() {
                rows[lane] += row;
            }
            let own = gathered::<V>(self.present, &rows);
            let mut sums = [SimdLanes::<V>::constant(0.0); 5];
            for k in groups {
                self.part.moments[k].add(&self.part.groups[k], self.present, own, &mut sums);
            }
            let records = scattered(&sums);
            for (&row, record) in slice.rows().iter().zip(&records) {
                let moment = &mut self.sums[row as usize].0;
                for k in 0..5 {
                    moment[k] += record[k];
                }
            }
        }
    }
}

impl<T: StoredLanes> MomentGroup<T> {
    /// Adds the moments due to the motions of the rows' particles and of the others.
    #[inline(always)]
    fn add<V: Width<f64>>(
        &self,
        group: &LaneGroup<T>,
        present: &[Padded],
        of_own: [[SimdLanes<V>; 3]; 2],
        sums: &mut [SimdLanes<V>; 5],
    ) {
        let z = axis::<T, V>(group);
        let of_others = gathered::<V>(present, &group.others);
        let mut stretch = SimdLanes::constant(0.0);
        let mut shear = [SimdLanes::constant(0.0); 3];
        for (k, [u, o]) in [of_own, of_others].into_iter().enumerate() {
            let (along, turning) = (dot(z, u), cross(o, z));
            let (drag, turn) = (T::lanes(&self.yg[k]), T::lanes(&self.yh[k]));
            stretch = stretch.plus(along, T::lanes(&self.xg[k]));
            for i in 0..3 {
                shear[i] = shear[i].plus(drag, u[i] - along * z[i]).plus(turn, turning[i]);
            }
        }
        add_tensor(stretch, shear, z, sums);
    }
}

/// Adds `stretch (3 zz - 1) + z s + s z`, with `s` the shear, to the five components of symmetric traceless tensors.
#[inline(always)]
pub fn add_tensor<V: Width<f64>>(
    stretch: SimdLanes<V>,
    shear: [SimdLanes<V>; 3],
    z: [SimdLanes<V>; 3],
    sums: &mut [SimdLanes<V>; 5],
) {
    let three = SimdLanes::constant(3.0) * stretch;
    for (k, (i, j)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2)].into_iter().enumerate() {
        sums[k] = sums[k].plus(three * z[i], z[j]).plus(z[i], shear[j]).plus(shear[i], z[j]);
    }
    sums[0] = sums[0] - stretch;
    sums[3] = sums[3] - stretch;
}
