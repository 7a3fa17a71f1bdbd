//! Assembly of the near-field resistance matrix from neighbour lists.

use crate::ambient::StrainRate;
use crate::bodies::present::PresentBodies;
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::lanes::{LANES, StoredLanes};
use crate::pairs::matrix::packed_rows::{NearPair, PackedKind, PackedPairs, STIFF, SizedPair, Soft, Stiff};
use crate::pairs::matrix::row_sums::RowSums;
use crate::pairs::matrix::sparse::{MatrixPart, ROWS, Slice};
use crate::six_vector::SixVector;
use crate::springs::{PairSprings, Springs};
use domain::parallel::MeasuredLoop;
use domain::{Neighbour, Neighbours, PeriodicBox, Traceless, Vector};
use lubrication::SPHERE_ROW;
use rayon::prelude::*;
use simd::{SimdVector as Width, VectorKernel};
use solver::Real;
use std::marker::PhantomData;

/// Local particles, ghosts and neighbour lists.
pub struct PairArrangement<'a> {
    pub lubrication: Option<&'a PairLubrication>,
    pub springs: Option<&'a Springs<'a>>,
    pub bodies: Option<&'a PresentBodies>,
    /// Radii by species.
    pub radii: &'a [f64],
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    pub ids: &'a [u64],
    pub species: &'a [u32],
    pub neighbours: &'a Neighbours,
    /// Ambient strain rate.
    pub strain_rate: StrainRate,
}

/// Matrix rows of a block of a rank's particles: stiff pairs in double precision, and soft pairs.
pub struct Assembled<T> {
    pub stiff: MatrixPart<f64>,
    pub soft: MatrixPart<T>,
}

/// Assembly of the `rows` rows from `first` on. Soft pairs are stored as numbers of type `T`. The loads and first
/// moments that all these pairs exert in the ambient flow, on particles at rest relative to it, are added to `loads`
/// and `moments`.
pub struct Assembly<'a, T> {
    arrangement: &'a PairArrangement<'a>,
    first: usize,
    rows: usize,
    loads: &'a mut [SixVector],
    moments: &'a mut [Traceless],
    stored: PhantomData<T>,
}

/// Pairs of one kind, stiff or soft, in the order of the rows of a block.
struct PairList {
    pairs: Vec<NearPair>,
    /// Spring resistances of each pair, if there are springs.
    springs: Vec<PairSprings>,
    /// End of each row in `pairs`.
    ends: Vec<usize>,
}

impl<T: StoredLanes> VectorKernel<f64> for Assembly<'_, T> {
    type Output = Assembled<T>;

    #[inline(always)]
    fn run<V: Width<f64>>(mut self) -> Assembled<T> {
        let [stiff, soft] = self.listed();
        let lubrication = self.arrangement.lubrication;
        let stiff = self.part::<V, _, _, STIFF>(&stiff, || Stiff::new(lubrication));
        let soft = self.part::<V, _, _, SPHERE_ROW>(&soft, || Soft(lubrication));
        Assembled { stiff, soft }
    }
}

impl<T: StoredLanes> Assembly<'_, T> {
    /// Rows of all particles of a rank, whose loads and moments are added to those given.
    pub fn of_all(
        arrangement: &PairArrangement,
        loads: &mut [SixVector],
        moments: &mut [Traceless],
    ) -> Vec<Assembled<T>> {
        let part = |(k, (loads, moments)): (usize, (&mut [SixVector], &mut [Traceless]))| {
            let (first, rows) = (k * ROWS, loads.len());
            f64::dispatch(Assembly { arrangement, first, rows, loads, moments, stored: PhantomData })
        };
        loads.par_chunks_mut(ROWS).zip(moments.par_chunks_mut(ROWS)).enumerate().map(part).measured().collect()
    }

    /// Lists the stiff and the soft pairs.
    #[inline(always)]
    fn listed(&self) -> [PairList; 2] {
        let rows = self.first..self.first + self.rows;
        let most: usize = rows.clone().map(|row| self.arrangement.neighbours.of(row).len()).sum();
        let mut listed = [PairList::with_room(self.rows, most / 4), PairList::with_room(self.rows, most)];
        for row in rows {
            for neighbour in self.arrangement.neighbours.of(row).iter() {
                self.list(row, neighbour, &mut listed);
            }
            for list in &mut listed {
                list.ends.push(list.pairs.len());
            }
        }
        listed
    }

    /// Appends the pair of a row and a neighbour to the stiff or the soft pairs, if they interact.
    #[inline(always)]
    fn list(&self, row: usize, neighbour: Neighbour, [stiff, soft]: &mut [PairList; 2]) {
        let PairArrangement { lubrication, springs, bodies, radii, cell, positions, ids, species, .. } =
            *self.arrangement;
        let other = neighbour.row as usize;
        let mut separation = positions[other] - positions[row];
        if neighbour.steps != [0; 3] {
            separation += cell.lattice(neighbour.steps.map(i32::from));
        }
        let (pair, distance) = ([species[row], species[other]], separation.length());
        let gap = lubrication.and_then(|pairs| pairs.force.gap(distance, pair));
        let sizes = pair.map(|s| radii[s as usize]);
        let within_body = bodies.and_then(|bodies| bodies.share([row, other], separation, sizes));
        let gap = gap.filter(|_| within_body != Some(0.0));
        let between = |springs: &Springs| springs.between(row, ids[other], distance, pair.map(|s| radii[s as usize]));
        let resisted =
            springs.map(|springs| if within_body.is_some() { PairSprings::default() } else { between(springs) });
        let spring = resisted.map_or(0.0, |springs| springs.along);
        if gap.is_none() && spring == 0.0 {
            return;
        }
        let is_stiff = |pairs: &PairLubrication| gap.is_some_and(|gap| pairs.is_stiff(pair, gap));
        let list = if spring > 0.0 || lubrication.is_some_and(is_stiff) { stiff } else { soft };
        let (other, is_lubricated) = (neighbour.row, gap.is_some());
        let height = positions[row].z + 0.5 * separation.z;
        list.pairs.push(NearPair { separation, distance, height, other, species: pair, is_lubricated, within_body });
        list.springs.extend(resisted);
    }

    /// Assembles the rows of one kind of pairs, and adds their loads and moments in the ambient flow.
    #[inline(always)]
    fn part<V: Width<f64>, S: StoredLanes, K: PackedKind<N>, const N: usize>(
        &mut self,
        listed: &PairList,
        kind: impl Fn() -> K,
    ) -> MatrixPart<S> {
        let order = listed.order();
        let groups = order.chunks(LANES).map(|rows| listed.of(rows[0]).len()).sum();
        let mut part = MatrixPart::new(self.rows, groups);
        for rows in order.chunks(LANES) {
            let slice = Slice::new(rows);
            let mut sums = RowSums::<V>::zero();
            for place in 0..listed.of(rows[0]).len() {
                let mut packed = PackedPairs::empty(kind(), (self.first + rows[0] as usize) as u32);
                self.pack::<V, K, N>(listed, rows, place, &mut packed);
                packed.assemble(part.group(), &mut sums, self.arrangement.strain_rate.at_zero);
                self.mark_bodies(listed, rows, place, &mut part);
            }
            part.end_slice(slice, &sums.resistance.totals());
            let (added, moved) = sums.in_strain.totals();
            for (lane, &row) in rows.iter().enumerate() {
                self.loads[row as usize] += added[lane];
                self.moments[row as usize] += moved[lane];
            }
        }
        part.sort_marked();
        part
    }

    /// Marks the pairs within bodies at one position of the rows' lists, which are in the last group.
    #[inline(always)]
    fn mark_bodies<S: StoredLanes>(&self, listed: &PairList, rows: &[u32], place: usize, part: &mut MatrixPart<S>) {
        if self.arrangement.bodies.is_none() {
            return;
        }
        for (lane, &row) in rows.iter().enumerate() {
            let range = listed.of(row);
            if place < range.len() && listed.pairs[range.start + place].within_body.is_some() {
                part.mark_body(row, lane);
            }
        }
    }

    /// Packs the pairs at one position of the rows' lists.
    #[inline(always)]
    fn pack<V: Width<f64>, K: PackedKind<N>, const N: usize>(
        &self,
        listed: &PairList,
        rows: &[u32],
        place: usize,
        packed: &mut PackedPairs<K, N>,
    ) {
        let PairArrangement { radii, strain_rate, .. } = *self.arrangement;
        for (lane, &row) in rows.iter().enumerate() {
            let range = listed.of(row);
            if place < range.len() {
                let k = range.start + place;
                let pair = &listed.pairs[k];
                let sized = SizedPair { pair, radii: pair.species.map(|s| radii[s as usize]) };
                packed.set::<V>(lane, sized, listed.springs.get(k), strain_rate.slope);
            }
        }
    }
}

impl PairList {
    fn with_room(rows: usize, pairs: usize) -> Self {
        Self { pairs: Vec::with_capacity(pairs), springs: Vec::new(), ends: Vec::with_capacity(rows) }
    }

    /// Range of a row in `pairs`.
    #[inline(always)]
    fn of(&self, row: u32) -> std::ops::Range<usize> {
        let row = row as usize;
        (if row == 0 { 0 } else { self.ends[row - 1] })..self.ends[row]
    }

    /// Rows with at least one pair, those with the most pairs first.
    fn order(&self) -> Vec<u32> {
        let mut rows: Vec<u32> = (0..self.ends.len() as u32).filter(|&row| !self.of(row).is_empty()).collect();
        rows.sort_by_key(|&row| std::cmp::Reverse(self.of(row).len()));
        rows
    }
}
