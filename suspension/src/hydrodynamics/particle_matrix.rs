//! The resistance of particles without far field, a sparse matrix, and what particles do by it alone.

use super::block::Block;
use super::near_pairs::NearPairs;
use super::screw::{Screw, Screws};
use domain::{Comm, Interrupt};
use fcm::{Limits, Linear, System, conjugate_gradients};
use rayon::prelude::*;

/// `M_0^-1 + R`, with `M_0` the mobility of single spheres and `R` the resistance of the stiff pairs: what particles
/// resist to their rigid motions if they feel one another by the lubrication of these alone.
pub struct ParticleMatrix<'a> {
    comm: Comm,
    near: &'a NearPairs,
    single: &'a [Screw],
    /// Inverse blocks of the diagonal.
    inverse: Vec<Block>,
    /// Error left in a solve.
    tolerance: f64,
    /// Size of the loads of the solve at hand.
    goal: f64,
}

/// Error left in a solve at first, the least, and by what it is made smaller. The outer iteration corrects the error: at 40%
/// it takes as many iterations as with exact solves, 15, and 17 instead of 15 if a pair is brought to a gap of 1e-5; with an
/// error of 0.05 it would take 19 and 29.
const TOLERANCE: f64 = 0.01;
const LEAST_TOLERANCE: f64 = 1e-13;
const SHARPER: f64 = 1e-2;

/// Most iterations of a solve.
const MOST_ITERATIONS: usize = 2000;

impl<'a> ParticleMatrix<'a> {
    /// For near pairs of particles with the given resistances alone.
    pub fn new(comm: &Comm, near: &'a NearPairs, single: &'a [Screw]) -> Self {
        let block = |(mut block, single): (Block, &Screw)| {
            (0..6).for_each(|k| block.0[k][k] += single.0[k]);
            block.inverse()
        };
        let inverse = near.stiff().diagonal().zip(single).map(block).collect();
        Self { comm: comm.clone(), near, single, inverse, tolerance: TOLERANCE, goal: 0.0 }
    }

    /// The motions under the given loads, nearly, and what the stiff pairs resist to them. Collective.
    pub fn solve(&mut self, loads: &Screws) -> [Screws; 2] {
        let (mut motions, mut residual) = (Screws::zero(loads.0.len()), loads.clone());
        let comm = self.comm.clone();
        let mut goal = [loads.dot(&self.precondition(loads))];
        comm.sum(&mut goal);
        self.goal = goal[0] / comm.size() as f64;
        let limits = Limits { tolerance: self.tolerance, iterations: MOST_ITERATIONS, interrupt: &Interrupt::NEVER };
        conjugate_gradients(&comm, self, (&mut motions, &mut residual), limits);
        let mut resisted = loads.clone();
        resisted.add(-1.0, &residual);
        resisted.add_resisted(-1.0, self.single, &motions);
        [motions, resisted]
    }

    /// Solves more exactly from now on, unless that is as exact as it can be.
    pub fn sharpen(&mut self) -> bool {
        let can = self.tolerance > LEAST_TOLERANCE;
        self.tolerance = (self.tolerance * SHARPER).max(LEAST_TOLERANCE);
        can
    }
}

impl System for ParticleMatrix<'_> {
    type Unknowns = Screws;
    type Residual = Screws;

    fn product(&self, residual: &Screws, x: &Screws) -> f64 {
        residual.dot(x)
    }

    fn apply(&mut self, direction: &Screws) -> Screws {
        let mut loads = self.near.times(self.near.stiff(), direction);
        loads.add_resisted(1.0, self.single, direction);
        loads
    }

    fn stepped(&mut self, _: f64) {}

    fn precondition(&mut self, residual: &Screws) -> Screws {
        Screws(self.inverse.par_iter().with_min_len(256).zip(&residual.0).map(|(block, r)| block.times(r)).collect())
    }

    /// That of the loads: the error left is relative to them.
    fn size(&self, _: &Screws) -> f64 {
        self.goal
    }
}
