//! Entries of the matrix: exact sums over pairs, their periodic images and wavevectors.
//!
//! As with the split method, a wide Gaussian common to all spheres is summed over wavevectors, and what it leaves out
//! of the envelopes over pairs in space. Both sums end where their terms are below round-off, and neither has a grid,
//! so the entries are exact.

use super::pair_sum::PairSum;
use super::wave_sum::WaveSum;
use crate::envelope::{Common, Envelope};
use crate::mobility::noise::{COMPONENTS, ParticleComponents};
use crate::pairs::table::PairFunctions;
use crate::plan::Plan;
use domain::parallel::MeasuredLoop;
use domain::{PeriodicBox, Vector};
use rayon::prelude::*;

/// Exponent of the Gaussians at which the sums end; brackets amplify the highest wavenumbers.
pub(super) const EXPONENT: f64 = 46.0;

/// Edge of a cubic box over the width of the common Gaussian, for which the two sums take about as long.
const EDGE_OVER_WIDTH: f64 = 6.0;

/// A sphere of the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocatedSphere {
    pub position: Vector,
    /// Class of its radius.
    pub class: u32,
}

/// Motions of one sphere that each load of another causes: a row for each load.
pub(super) type PairBlock = [ParticleComponents; COMPONENTS];

/// Envelopes of the spheres of a plan, and the wide Gaussian that they share.
pub(super) struct Shapes {
    pub envelopes: Vec<Envelope>,
    pub common: Common,
    pub viscosity: f64,
    /// Rows of the matrix for each sphere.
    pub rows: usize,
}

impl Shapes {
    /// With a common Gaussian that suits a box and `rows` rows of the matrix for each sphere.
    pub fn new(plan: &Plan, cell: &PeriodicBox, rows: usize) -> Self {
        let envelopes: Vec<Envelope> = plan.radii.iter().map(|&radius| Envelope::of_sphere(radius)).collect();
        let widest = envelopes.iter().map(|envelope| envelope.monopole).fold(0.0, f64::max);
        let width = widest.max(cell.volume().cbrt() / EDGE_OVER_WIDTH);
        let common = Common::new(width, envelopes.iter().map(|envelope| envelope.dipole));
        Self { envelopes, common, viscosity: plan.viscosity, rows }
    }

    /// Wavenumber at which sums over wavevectors end.
    pub fn largest_wavenumber(&self) -> f64 {
        EXPONENT.sqrt() / self.common.width
    }
}

/// Rows of the spheres `own`, one sphere after the other.
pub(super) fn rows_of(shapes: &Shapes, cell: &PeriodicBox, spheres: &[LocatedSphere], own: &[usize]) -> Vec<f64> {
    let (height, length) = (shapes.rows, spheres.len() * shapes.rows);
    let mut rows = vec![0.0; own.len() * height * length];
    if rows.is_empty() {
        return rows;
    }
    // The other blocks are transposes.
    let mut is_own = vec![false; spheres.len()];
    for &i in own {
        is_own[i] = true;
    }
    let is_summed = |i: usize, j: usize| j >= i || !is_own[j];
    let pairs = PairSum::new(shapes, cell, PairFunctions::new);
    rows.par_chunks_mut(height * length).zip(own).measured().for_each(|(rows, &i)| {
        for j in (0..spheres.len()).filter(|&j| is_summed(i, j)) {
            let block = pairs.between(&spheres[i], &spheres[j]);
            for (load, motion) in block.iter().take(height).enumerate() {
                for (row, component) in motion.iter().take(height).enumerate() {
                    rows[row * length + j * height + load] = *component;
                }
            }
        }
    });
    let mut waves = WaveSum::new(shapes, cell);
    while waves.next_chunk(spheres) {
        rows.par_chunks_mut(height * length).zip(own).measured().for_each(|(rows, &i)| {
            for (row, values) in rows.chunks_mut(length).enumerate() {
                for j in (0..spheres.len()).filter(|&j| is_summed(i, j)) {
                    for (load, value) in values[j * height..][..height].iter_mut().enumerate() {
                        *value += waves.product(i * height + row, j * height + load);
                    }
                }
            }
        });
    }
    mirror(&mut rows, own, [height, length]);
    rows
}

/// Fills the blocks below the diagonal among the rows of the spheres `own` with the transposes of those above.
fn mirror(rows: &mut [f64], own: &[usize], [height, length]: [usize; 2]) {
    for (upper, &i) in own.iter().enumerate() {
        for (lower, &j) in own.iter().enumerate().filter(|&(_, &j)| j > i) {
            for (a, b) in (0..height).flat_map(|a| (0..height).map(move |b| (a, b))) {
                rows[(lower * height + b) * length + i * height + a] =
                    rows[(upper * height + a) * length + j * height + b];
            }
        }
    }
}
