//! Sum over wavevectors: the flow of the common Gaussians.

use super::entries::{LocatedSphere, Shapes};
use super::pair_sum::{UnitLoad, unit_loads};
use crate::envelope::Common;
use crate::lanczos::product;
use domain::parallel::MeasuredLoop;
use domain::{PeriodicBox, Vector};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Wavevectors of a chunk.
const CHUNK: usize = 64;

/// Numbers of a wavevector in a row: real and imaginary parts of two polarisations.
const NUMBERS: usize = 4;

/// Sum `2 / (mu V) sum_k Re[c_a* c_b] / k^2` over one of each pair of opposite wavevectors, with `c_b` the force
/// density of load `b` along two directions normal to `k`. It is the product of a matrix with its transpose, whose
/// columns are found chunk by chunk.
pub(super) struct WaveSum<'a> {
    shapes: &'a Shapes,
    /// Wavevectors that are left.
    left: Vec<Vector>,
    scale: f64,
    columns: Vec<f64>,
}

impl<'a> WaveSum<'a> {
    pub fn new(shapes: &'a Shapes, cell: &PeriodicBox) -> Self {
        let scale = 2.0 / (cell.volume() * shapes.viscosity);
        Self { shapes, left: wavevectors(cell, shapes.largest_wavenumber()), scale, columns: Vec::new() }
    }

    /// Finds the columns of the next wavevectors; false if there are none.
    pub fn next_chunk(&mut self, spheres: &[LocatedSphere]) -> bool {
        let chunk = self.left.split_off(self.left.len().saturating_sub(CHUNK));
        self.columns.clear();
        self.columns.resize(spheres.len() * self.shapes.rows * CHUNK * NUMBERS, 0.0);
        let loads = unit_loads();
        self.columns.par_chunks_mut(self.shapes.rows * CHUNK * NUMBERS).zip(spheres).measured().for_each(
            |(rows, sphere)| {
                for (place, k) in chunk.iter().enumerate() {
                    let wave = Wave::new(*k, self.scale, self.shapes, sphere);
                    for (row, load) in rows.chunks_mut(CHUNK * NUMBERS).zip(&loads) {
                        row[place * NUMBERS..][..NUMBERS].copy_from_slice(&wave.amplitudes(load));
                    }
                }
            },
        );
        !chunk.is_empty()
    }

    /// Contribution of the chunk to an entry of the matrix.
    pub fn product(&self, row: usize, column: usize) -> f64 {
        let of = |row: usize| &self.columns[row * CHUNK * NUMBERS..][..CHUNK * NUMBERS];
        product(of(row), of(column))
    }
}

/// One of each pair of opposite wavevectors up to the largest, without zero.
pub(super) fn wavevectors(cell: &PeriodicBox, largest: f64) -> Vec<Vector> {
    let vectors = cell.lattice_vectors();
    let [a, b, c] = vectors;
    let reciprocal = [b.cross(c), c.cross(a), a.cross(b)].map(|normal| normal * (TAU / a.dot(b.cross(c))));
    // A wavevector of m steps has the component 2 pi m along a lattice vector, times that vector's length.
    let [x, y, z] = vectors.map(|vector| (largest * vector.length() / TAU) as i32);
    let half = (0..=x).flat_map(|i| (-y..=y).flat_map(move |j| (-z..=z).map(move |k| [i, j, k])));
    let all = half.filter(|&[i, j, k]| i > 0 || j > 0 || (j == 0 && k > 0));
    let wavevectors = all.map(|steps| {
        let [i, j, k] = steps.map(f64::from);
        reciprocal[0] * i + reciprocal[1] * j + reciprocal[2] * k
    });
    wavevectors.filter(|k| k.length_squared() <= largest * largest).collect()
}

/// Wavevector as one sphere sees it.
struct Wave {
    k: Vector,
    /// Directions normal to it.
    normal: [Vector; 2],
    /// Cosine and sine of the phase times the transform of the force's envelope, and of the dipole's.
    force: [f64; 2],
    dipole: [f64; 2],
}

impl Wave {
    fn new(k: Vector, scale: f64, shapes: &Shapes, sphere: &LocatedSphere) -> Self {
        let square = k.length_squared();
        let size = (scale / square).sqrt();
        let first = (k / square.sqrt()).any_orthonormal_vector();
        let normal = [first, k.cross(first) / square.sqrt()];
        let envelope = &shapes.envelopes[sphere.class as usize];
        let (sin, cos) = k.dot(sphere.position).sin_cos();
        let [force, dipole] = [envelope.monopole, envelope.dipole].map(|sigma| {
            let amplitude = size * transform(&shapes.common, sigma, square);
            [cos * amplitude, sin * amplitude]
        });
        Self { k, normal, force, dipole }
    }

    /// Force density `F w exp(-i k.Y) + i G k w' exp(-i k.Y)` along the normals, real and imaginary parts.
    fn amplitudes(&self, load: &UnitLoad) -> [f64; NUMBERS] {
        let ([fc, fs], [gc, gs]) = (self.force, self.dipole);
        let along = load.dipole * self.k;
        let [a, b] = self.normal.map(|e| {
            let (f, g) = (e.dot(load.force), e.dot(along));
            [f * fc + g * gs, g * gc - f * fs]
        });
        [a[0], a[1], b[0], b[1]]
    }
}

/// Transform of the common Gaussian with the brackets of an envelope, at a wavenumber given by its square.
pub(super) fn transform(common: &Common, sigma: f64, square: f64) -> f64 {
    let bracket = |increment: f64| 1.0 + 0.5 * increment * square;
    bracket(common.increment) * bracket(common.rest(sigma)) * (-0.5 * square * common.width * common.width).exp()
}
