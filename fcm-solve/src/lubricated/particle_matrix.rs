//! The resistance of particles without far field, a sparse matrix, and what it makes of the modes of pairs.

use super::block::Block;
use super::near_pairs::{Modes, NearPair, NearPairs};
use super::screw::{Screw, Screws};
use domain::{Comm, Exchange};
use fcm::{Limits, System, conjugate_gradients};
use rayon::prelude::*;

/// `M_0^-1 + B B^T`, with `M_0` the mobility of single spheres: what particles resist to their rigid motions if they
/// feel one another by lubrication alone, and by that of the stiff pairs among them.
pub struct ParticleMatrix<'a> {
    comm: Comm,
    near: &'a NearPairs,
    exchange: &'a Exchange,
    /// Which pairs are stiff.
    stiff: Vec<bool>,
    diagonal: Vec<Block>,
    inverse: Vec<Block>,
    /// Where each present row starts in `entries`.
    starts: Vec<usize>,
    /// Column and block off the diagonal.
    entries: Vec<(u32, Block)>,
}

/// Error left in a solve. The outer iteration does not know how exact it is, but the preconditioned modes of the nearest
/// pairs are the small differences of large numbers: at gaps of 1e-6 an error of 1e-3 takes several times as many outer
/// iterations.
const LIMITS: Limits = Limits { tolerance: 1e-5, iterations: 2000 };

/// A pair is stiff if it resists some motion of a sphere more than this part of what the sphere does alone: within gaps of about
/// half a radius. Most pairs within reach are not, and cost without making iterations fewer.
const STIFF: f64 = 0.1;

impl<'a> ParticleMatrix<'a> {
    /// For near pairs of particles with the given resistances alone. Collective.
    pub fn new(comm: &Comm, near: &'a NearPairs, single: &[Screw]) -> Self {
        let exchange = near.exchange();
        let blocks = stiff_blocks(near, single);
        let mut diagonal = vec![Block::default(); exchange.present()];
        let mut places = Vec::new();
        for (pair, blocks) in near.list().iter().zip(&blocks) {
            let (Some([first, across, second]), [i, j]) = (blocks, pair.rows) else { continue };
            diagonal[i] += *first;
            diagonal[j] += *second;
            places.push((i, j, *across));
            places.push((j, i, across.transposed()));
        }
        exchange.collect(&mut diagonal);
        for (block, single) in diagonal.iter_mut().zip(single) {
            (0..6).for_each(|k| block.0[k][k] += single.0[k]);
        }
        places.sort_by_key(|&(row, ..)| row);
        let starts = (0..=exchange.present()).map(|row| places.partition_point(|place| place.0 < row)).collect();
        let entries = places.into_iter().map(|(_, column, block)| (column as u32, block)).collect();
        let inverse = diagonal.iter().map(Block::inverse).collect();
        let stiff = blocks.iter().map(Option::is_some).collect();
        Self { comm: comm.clone(), near, exchange, stiff, diagonal, inverse, starts, entries }
    }

    /// Takes from the amplitudes of stiff pairs what the motions by these alone do to them, `B^T (M_0^-1 + B B^T)^-1 B` times
    /// them, nearly; the motions. Collective.
    pub fn relieve(&mut self, modes: &mut [Modes]) -> Screws {
        let alone = modes.iter().zip(&self.stiff).map(|(modes, &stiff)| if stiff { *modes } else { Modes::default() });
        let alone: Vec<Modes> = alone.collect();
        let motions = self.solve(self.near.loads(&alone));
        let known = self.near.rigid_modes(&motions);
        for ((modes, known), _) in modes.iter_mut().zip(&known).zip(&self.stiff).filter(|(_, stiff)| **stiff) {
            modes.iter_mut().zip(known).for_each(|(mode, known)| *mode -= known);
        }
        motions
    }

    /// The motions under the given loads, nearly. Collective.
    fn solve(&mut self, loads: Screws) -> Screws {
        let (mut motions, mut residual) = (Screws(vec![Screw::default(); loads.0.len()]), loads);
        let comm = self.comm.clone();
        conjugate_gradients(&comm, self, (&mut motions, &mut residual), LIMITS);
        motions
    }
}

impl System for ParticleMatrix<'_> {
    type Unknowns = Screws;

    fn apply(&mut self, direction: &Screws) -> Screws {
        let mut present = direction.0.clone();
        self.exchange.extend(&mut present);
        let row = |row: usize| {
            let mut sum = self.diagonal.get(row).map_or_else(Screw::default, |block| block.times(&present[row]));
            for (column, block) in &self.entries[self.starts[row]..self.starts[row + 1]] {
                sum += block.times(&present[*column as usize]);
            }
            sum
        };
        let mut loads = (0..present.len()).into_par_iter().map(row).collect();
        self.exchange.collect(&mut loads);
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

/// The blocks of the pairs that are stiff. Collective.
fn stiff_blocks(near: &NearPairs, single: &[Screw]) -> Vec<Option<[Block; 3]>> {
    let mut resistance = single.to_vec();
    near.exchange().extend(&mut resistance);
    let exceeds = |block: &Block, row: usize| (0..6).any(|k| block.0[k][k] > STIFF * resistance[row].0[k]);
    let stiff = |pair: &NearPair| {
        let blocks = blocks(pair);
        (exceeds(&blocks[0], pair.rows[0]) || exceeds(&blocks[2], pair.rows[1])).then_some(blocks)
    };
    near.list().par_iter().map(stiff).collect()
}

/// The blocks 11, 12 and 22 of a pair's resistance.
fn blocks(pair: &NearPair) -> [Block; 3] {
    let mut blocks = [Block::default(); 3];
    for column in 0..6 {
        let loads = [0, 1].map(|moves| {
            let mut spheres = [Screw::default(); 2];
            spheres[moves].0[column] = 1.0;
            let modes = pair.factor.rigid_modes(spheres.map(Screw::linear), spheres.map(Screw::angular));
            pair.factor.rigid_loads(&modes)
        });
        let on = |moves: usize, sphere: usize| Screw::new(loads[moves][0][sphere], loads[moves][1][sphere]).0;
        for (block, load) in blocks.iter_mut().zip([on(0, 0), on(1, 0), on(1, 1)]) {
            block.0.iter_mut().zip(load).for_each(|(row, value)| row[column] = value);
        }
    }
    blocks
}
