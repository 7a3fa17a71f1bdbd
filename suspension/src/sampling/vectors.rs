//! Moments and probability densities of vectors of the particles.

use bytemuck::Pod;
use domain::parallel::MeasuredLoop;
use domain::{IdBlocks, Vector, power_of_two};
use rayon::prelude::*;
use statistics::{Counts, Fluctuations, Histogram, SecondMoments, VectorSum};
use std::ops::Range;

/// This rank's blocks of ids, and the rows of the particles of each.
#[derive(Clone, Copy)]
pub struct BlockRows<'a> {
    pub blocks: &'a IdBlocks,
    pub rows: &'a [Range<usize>],
}

/// Moments of a vector over the particles of a species, and probability densities of its components about the mean at
/// each time, in a unit in which fourth powers are representable. The moments are on the first rank; each rank has the
/// densities of its own particles.
pub struct VectorMoments {
    pub unit: f64,
    pub moments: Fluctuations,
    pub densities: [Histogram; 3],
}

/// Magnitudes between this and its inverse are averaged without a change of unit.
const ORDINARY: f64 = 1e36;

impl VectorMoments {
    /// No samples yet, for vectors of about the given magnitude.
    pub fn about(size: f64) -> Self {
        let is_ordinary = (1.0 / ORDINARY..ORDINARY).contains(&size);
        let unit = if is_ordinary { 1.0 } else { power_of_two(size) };
        Self { unit, moments: Fluctuations::default(), densities: std::array::from_fn(|_| Histogram::default()) }
    }

    /// Adds the vectors of the particles of each species at one time; each rank adds those of its blocks. Collective.
    pub fn add(all: &mut [Self], BlockRows { blocks, rows }: BlockRows, species: &[u32], vectors: &[Vector]) {
        let scales: Vec<f64> = all.iter().map(|own| 1.0 / own.unit).collect();
        let scaled = |row: usize| (species[row] as usize, vectors[row] * scales[species[row] as usize]);
        let sums = blocks.total(&map_blocks(rows, |rows| {
            let mut sums = vec![VectorSum::default(); scales.len()];
            for (species, vector) in rows.map(scaled) {
                sums[species].add(vector);
            }
            sums
        }));
        let sums: &[VectorSum] = bytemuck::cast_slice(&sums);
        let means: Vec<Vector> = sums.iter().map(VectorSum::mean).collect();
        let from_means =
            |rows: Range<usize>| rows.map(scaled).map(|(species, vector)| (species, vector - means[species]));
        let second_moments = blocks.total(&map_blocks(rows, |rows| {
            let mut second_moments = vec![SecondMoments::default(); means.len()];
            from_means(rows).for_each(|(species, vector)| second_moments[species].add(vector));
            second_moments
        }));
        let counted = |rows: &Range<usize>| {
            let mut densities = vec![<[Histogram; 3]>::default(); means.len()];
            for (species, vector) in from_means(rows.clone()) {
                densities[species].iter_mut().zip(vector.to_array()).for_each(|(density, value)| density.add(value));
            }
            densities
        };
        for block in rows.par_iter().map(counted).measured().collect::<Vec<_>>() {
            let densities = all.iter_mut().flat_map(|own| &mut own.densities);
            densities.zip(block.iter().flatten()).for_each(|(density, more)| density.merge(more));
        }
        if blocks.comm().is_first() {
            for (own, (sum, moments)) in all.iter_mut().zip(sums.iter().zip(bytemuck::cast_slice(&second_moments))) {
                own.moments.add_sums(sum, moments);
            }
        }
    }
}

/// Evaluates a function for each range of rows, as flat lists of numbers.
pub fn map_blocks<T: Pod>(rows: &[Range<usize>], of: impl Fn(Range<usize>) -> Vec<T> + Sync) -> Vec<Vec<f64>> {
    rows.par_iter().map(|rows| bytemuck::cast_slice(&of(rows.clone())).to_vec()).measured().collect()
}
