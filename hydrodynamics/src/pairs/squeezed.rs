//! Pairs so close that their resistance to approach is far larger than that of single spheres.

use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::inverse_block::Block;
use crate::pairs::matrix::pair_rows::AxialPair;
use crate::pairs::search::NearPairs;
use crate::six_vector::{SixVector, SixVectors};
use domain::parallel::{change, of_rows};
use domain::{Comm, Halo, Interrupt, Vector};
use fcm::{Iterate, Limits, Linear, System, conjugate_gradients};

/// Resistance of close pairs to approach, `N K N^T`, in a preconditioner with diagonal blocks.
///
/// A pair whose spheres are at the places `i`, `j` along the unit vector `d` from `i` to `j` resists its rate of
/// approach `d.(u_i - u_j)` with `k`, which grows like the inverse gap. Without coupling between spheres, the
/// preconditioner would hold both spheres of such a pair in place, and the number of iterations would grow like
/// `k^(1/2)`. With the other resistances `D`, block by block of the spheres, the inverse is
///
/// ```text
/// (D + N K N^T)^-1 = D^-1 - D^-1 N S^-1 N^T D^-1,        S = K^-1 + N^T D^-1 N,
/// ```
///
/// by Woodbury's identity. `S` has one row a pair, couples pairs that share a sphere, and has a condition number that
/// depends on the arrangement alone, not on the gaps.
pub struct SqueezedPairs {
    /// Pairs of each of the rank's spheres, row by row, so that a pair of two of them is there twice, with `d` as the
    /// axis and `k` as the resistance.
    pairs: Vec<AxialPair>,
    /// End of each row in the pairs.
    ends: Vec<usize>,
    /// Rows that have pairs.
    rows: Vec<u32>,
    /// Diagonal of `S`, pair by pair.
    diagonal: Vec<f64>,
    /// Error of the forces of approach.
    tolerance: f64,
}

/// Resistance to approach, over the drag on the smaller sphere alone, above which a pair is squeezed: at gaps below
/// about a fortieth of the radius.
pub const SQUEEZED: f64 = 10.0;

/// Resistance of its pairs, over the drag alone, above which a passive sphere is pressed onto others: at gaps below
/// some 3e-4 of the radius. The coupling would cost more than it saves where no sphere is.
pub const PRESSED: f64 = 1e3;

/// Error of the rates of approach. It is larger than that of the forces by `k` over the drag.
const TOLERANCE: f64 = 1e-5;

/// Least error of the forces.
const LEAST_TOLERANCE: f64 = 1e-10;

/// Largest number of iterations for the forces of approach.
const MOST_ITERATIONS: usize = 1000;

impl SqueezedPairs {
    /// The squeezed pairs among the stiff ones of spheres with the given single-sphere resistances; `None` if there are
    /// none on any rank, or if no sphere is held by its pairs with more than `least` times its drag. Collective.
    pub fn among(near: &NearPairs, single: &[SixVector], least: f64, comm: &Comm) -> Option<Self> {
        if !comm.any(near.stiff().holds(single, least)) {
            return None;
        }
        let species = &near.around.species;
        let towards_other = |pair: AxialPair| {
            let is_larger = species[pair.row] > species[pair.other];
            AxialPair { axis: if is_larger { -pair.axis } else { pair.axis }, ..pair }
        };
        let mut drags = of_rows(single.len(), |row| single[row].0[0]);
        near.around.halo.extend(&mut drags);
        let over_drag = |pair: &AxialPair| pair.resistance / drags[pair.row].min(drags[pair.other]);
        let is_squeezed = |pair: &AxialPair| over_drag(pair) > SQUEEZED;
        let mut pairs: Vec<AxialPair> = near.stiff.axial_pairs().filter(is_squeezed).map(towards_other).collect();
        let mut largest = [pairs.iter().map(over_drag).fold(0.0, f64::max)];
        comm.max(&mut largest);
        if largest == [0.0] {
            return None;
        }
        let tolerance = (TOLERANCE / largest[0]).max(LEAST_TOLERANCE);
        pairs.sort_by_key(|pair| pair.row);
        let mut ends = vec![0; single.len()];
        for pair in &pairs {
            ends[pair.row] += 1;
        }
        ends.iter_mut().fold(0, |before, end| {
            *end += before;
            *end
        });
        let mut rows: Vec<u32> = pairs.iter().map(|pair| pair.row as u32).collect();
        rows.dedup();
        Some(Self { pairs, ends, rows, diagonal: Vec::new(), tolerance })
    }

    /// Takes over `D^-1` of each sphere, before motions are corrected. Collective.
    pub fn couple(&mut self, near: &NearPairs, inverse: &[Block]) {
        // xx, xy, xz, yy, yz, zz of the mobility of each sphere.
        let mut mobilities = of_rows(inverse.len(), |row| [0, 1, 2, 7, 8, 14].map(|k| inverse[row].0[k]));
        near.around.halo.extend(&mut mobilities);
        let along = |[xx, xy, xz, yy, yz, zz]: [f64; 6], d: Vector| {
            d.x * (xx * d.x + 2.0 * (xy * d.y + xz * d.z)) + d.y * (yy * d.y + 2.0 * yz * d.z) + zz * d.z * d.z
        };
        self.diagonal = of_rows(self.pairs.len(), |k| {
            let AxialPair { row, other, axis, resistance } = self.pairs[k];
            1.0 / resistance + along(mobilities[row], axis) + along(mobilities[other], axis)
        });
    }

    /// Removes the resistance to approach from the diagonal block of a row.
    pub fn remove_from(&self, row: usize, block: &mut DiagonalBlock<f64>) {
        for pair in self.of(row) {
            let (d, k) = (pair.axis, pair.resistance);
            let products = [d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z];
            block.force.iter_mut().zip(products).for_each(|(sum, product)| *sum -= k * product);
        }
    }

    /// Changes motions under loads without the resistance to approach to those with it, given `D^-1`. Collective.
    pub fn correct(&self, at: SpheresOfPairs, motions: &mut SixVectors) {
        let SpheresOfPairs { near, comm, inverse } = at;
        let mut velocities = motions.linear();
        near.around.halo.extend(&mut velocities);
        let mut residual = self.approach(&velocities);
        let mut forces = PairNumbers(vec![0.0; self.pairs.len()]);
        let mut z = forces.clone();
        let mut system = ApproachSystem { pairs: self, halo: &near.around.halo, inverse };
        let iterate = Iterate { x: &mut forces, residual: &mut residual, z: &mut z };
        let limits = Limits { tolerance: self.tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER };
        conjugate_gradients(comm, &mut system, iterate, limits);
        for &row in &self.rows {
            let row = row as usize;
            motions.0[row] += -inverse[row].under_force(self.force(row, &forces));
        }
    }

    /// Rates of approach for the velocities of spheres and ghosts, `N^T u`.
    fn approach(&self, velocities: &[Vector]) -> PairNumbers {
        PairNumbers(of_rows(self.pairs.len(), |k| {
            let AxialPair { row, other, axis, .. } = self.pairs[k];
            axis.dot(velocities[row] - velocities[other])
        }))
    }

    /// Force on a sphere, a row of `N` times forces of approach.
    fn force(&self, row: usize, forces: &PairNumbers) -> Vector {
        let range = self.range(row);
        let sum = self.pairs[range.clone()].iter().zip(&forces.0[range]);
        sum.fold(Vector::ZERO, |sum, (pair, &force)| sum + pair.axis * force)
    }

    fn of(&self, row: usize) -> &[AxialPair] {
        &self.pairs[self.range(row)]
    }

    fn range(&self, row: usize) -> std::ops::Range<usize> {
        (if row == 0 { 0 } else { self.ends[row - 1] })..self.ends[row]
    }
}

/// The spheres that pairs couple.
#[derive(Clone, Copy)]
pub struct SpheresOfPairs<'a> {
    /// The near pairs among which the squeezed ones are.
    pub near: &'a NearPairs,
    pub comm: &'a Comm,
    /// `D^-1` of each sphere.
    pub inverse: &'a [Block],
}

/// One number for each pair of the rank's spheres.
#[derive(Clone)]
struct PairNumbers(Vec<f64>);

impl Linear for PairNumbers {
    fn add(&mut self, factor: f64, other: &Self) {
        change(&mut self.0, &other.0, |a, b| *a += factor * b);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        change(&mut self.0, &other.0, |a, b| *a = b + factor * *a);
    }
}

/// `S`, preconditioned by its diagonal.
struct ApproachSystem<'a> {
    pairs: &'a SqueezedPairs,
    halo: &'a Halo,
    inverse: &'a [Block],
}

impl System for ApproachSystem<'_> {
    type Unknowns = PairNumbers;
    type Residual = PairNumbers;

    /// Pairs of two spheres of the ranks count twice.
    fn product(&self, residual: &PairNumbers, x: &PairNumbers) -> f64 {
        residual.0.iter().zip(&x.0).map(|(a, b)| a * b).sum()
    }

    fn apply(&mut self, direction: &PairNumbers) -> PairNumbers {
        let Self { pairs, halo, inverse, .. } = self;
        let moved = of_rows(pairs.rows.len(), |k| {
            let row = pairs.rows[k] as usize;
            inverse[row].under_force(pairs.force(row, direction)).linear()
        });
        let mut velocities = of_rows(inverse.len(), |_| Vector::ZERO);
        pairs.rows.iter().zip(moved).for_each(|(&row, velocity)| velocities[row as usize] = velocity);
        halo.extend(&mut velocities);
        let mut image = pairs.approach(&velocities);
        let of_pairs = pairs.pairs.iter().zip(&direction.0);
        image.0.iter_mut().zip(of_pairs).for_each(|(rate, (pair, force))| *rate += force / pair.resistance);
        image
    }

    fn on_step(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &PairNumbers) -> PairNumbers {
        PairNumbers(residual.0.iter().zip(&self.pairs.diagonal).map(|(rate, diagonal)| rate / diagonal).collect())
    }

    fn size(&self, x: &PairNumbers) -> f64 {
        x.0.iter().zip(&self.pairs.diagonal).map(|(force, diagonal)| force * force * diagonal).sum()
    }
}
