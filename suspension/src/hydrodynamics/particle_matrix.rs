//! The resistance of particles without far field, a sparse matrix, and what it makes of the modes of pairs.

use super::block::Block;
use super::near_pairs::{Modes, NearPairs};
use super::screw::{Screw, Screws};
use domain::{Comm, Halo, Interrupt};
use fcm::{Limits, System, conjugate_gradients};
use rayon::prelude::*;

/// `M_0^-1 + B B^T`, with `M_0` the mobility of single spheres: what particles resist to their rigid motions if they
/// feel one another by lubrication alone, and by that of the stiff pairs among them.
pub struct ParticleMatrix<'a> {
    comm: Comm,
    near: &'a NearPairs,
    halo: &'a Halo,
    diagonal: Vec<Block>,
    inverse: Vec<Block>,
    /// Where each present row starts in `entries`.
    starts: Vec<usize>,
    /// Column and block off the diagonal.
    entries: Vec<(u32, Block)>,
    /// Error left in a solve.
    tolerance: f64,
}

/// Error left in a solve at first, the least, and by what it is made smaller. The outer iteration does not know how
/// exact a solve is, but the preconditioned modes of the nearest pairs are the small differences of large numbers: with
/// an error of 1e-5 a suspension of 55%, with gaps of 1e-6, takes several times as many outer iterations, and now and
/// then a residual has a product below zero with what it is preconditioned to.
const TOLERANCE: f64 = 1e-7;
const LEAST_TOLERANCE: f64 = 1e-13;
const SHARPER: f64 = 1e-2;

/// Most iterations of a solve.
const MOST_ITERATIONS: usize = 2000;

impl<'a> ParticleMatrix<'a> {
    /// For near pairs of particles with the given resistances alone. Collective.
    pub fn new(comm: &Comm, near: &'a NearPairs, single: &[Screw]) -> Self {
        let (halo, pairs) = (near.halo(), &near.list()[..near.stiff()]);
        let mut diagonal = vec![Block::default(); halo.present()];
        // Where each row ends, and while it is filled, how far it is.
        let mut ends = vec![0; halo.present() + 1];
        for row in pairs.iter().flat_map(|pair| pair.rows) {
            ends[row + 1] += 1;
        }
        for row in 1..ends.len() {
            ends[row] += ends[row - 1];
        }
        let starts = ends.clone();
        let mut entries = vec![(0, Block::default()); 2 * pairs.len()];
        for pair in pairs {
            let resistance = pair.factor.rigid_resistance();
            for (k, l) in [(0, 1), (1, 0)] {
                let (row, column) = (pair.rows[k], pair.rows[l]);
                diagonal[row] += Block(resistance.block(k, k));
                entries[ends[row]] = (column as u32, Block(resistance.block(k, l)));
                ends[row] += 1;
            }
        }
        halo.collect(&mut diagonal);
        for (block, single) in diagonal.iter_mut().zip(single) {
            (0..6).for_each(|k| block.0[k][k] += single.0[k]);
        }
        let inverse = diagonal.iter().map(Block::inverse).collect();
        Self { comm: comm.clone(), near, halo, diagonal, inverse, starts, entries, tolerance: TOLERANCE }
    }

    /// Takes from the amplitudes of stiff pairs what the motions by these alone do to them, `B^T (M_0^-1 + B B^T)^-1 B`
    /// times them, nearly; the motions. Collective.
    pub fn relieve(&mut self, modes: &mut [Modes]) -> Screws {
        let stiff = &mut modes[..self.near.stiff()];
        let motions = self.solve(self.near.loads(stiff));
        let known = self.near.rigid_modes(&motions, stiff.len());
        for (mode, known) in stiff.as_flattened_mut().iter_mut().zip(known.as_flattened()) {
            *mode -= known;
        }
        motions
    }

    /// Solves more exactly from now on, unless that is as exact as it can be.
    pub fn sharpen(&mut self) -> bool {
        let can = self.tolerance > LEAST_TOLERANCE;
        self.tolerance = (self.tolerance * SHARPER).max(LEAST_TOLERANCE);
        can
    }

    /// The motions under the given loads, nearly. Collective.
    fn solve(&mut self, loads: Screws) -> Screws {
        let (mut motions, mut residual) = (Screws(vec![Screw::default(); loads.0.len()]), loads);
        let comm = self.comm.clone();
        let limits = Limits { tolerance: self.tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER };
        conjugate_gradients(&comm, self, (&mut motions, &mut residual), limits);
        motions
    }
}

impl System for ParticleMatrix<'_> {
    type Unknowns = Screws;

    fn apply(&mut self, direction: &Screws) -> Screws {
        let mut present = direction.0.clone();
        self.halo.extend(&mut present);
        let row = |row: usize| {
            let mut sum = self.diagonal.get(row).map_or_else(Screw::default, |block| block.times(&present[row]));
            for (column, block) in &self.entries[self.starts[row]..self.starts[row + 1]] {
                sum += block.times(&present[*column as usize]);
            }
            sum
        };
        let mut loads = (0..present.len()).into_par_iter().map(row).collect();
        self.halo.collect(&mut loads);
        Screws(loads)
    }

    fn stepped(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &Screws) -> Screws {
        Screws(self.inverse.par_iter().zip(&residual.0).map(|(block, r)| block.times(r)).collect())
    }

    fn size(&self, x: &Screws) -> f64 {
        let own = |(block, x): (&Block, &Screw)| block.times(x).0.iter().zip(x.0).map(|(y, x)| y * x).sum::<f64>();
        self.diagonal.iter().zip(&x.0).map(own).sum()
    }
}
