//! Tables of functions of the gap between two surfaces, from contact to any distance.

use rayon::prelude::*;

use super::near::{NearContact, REGULAR};
use super::singular::Singularity;
use crate::chebyshev::{Chebyshev, Samples};

/// Smallest gap, over the smaller radius, at which values are computed; the near-contact expansion holds below.
const NEAREST: f64 = 2e-3;
/// Factor by which consecutive intervals of interpolation grow.
const GROWTH: f64 = 4.0;
/// Interpolation points per interval.
const NODES: usize = 14;

/// Common parameters of the functions.
#[derive(Debug, Clone, Copy)]
pub struct Tabulated<const N: usize> {
    /// Distance at contact: the sum of the radii, or the distance of a sphere's centre from a wall.
    pub size: f64,
    /// Smaller radius.
    pub least: f64,
    /// Unit of the gap in the singularities: the mean radius, or the radius of a sphere at a wall.
    pub unit: f64,
    /// Whether each function over its leading power of `t`, `size` over the distance, is even in `t`.
    pub is_even: bool,
    /// Lowest power of `t` in each function.
    pub leading: [usize; N],
}

/// Functions of a gap: the near-contact expansion from contact to 2e-3 of the smaller radius, then Chebyshev series
/// in the logarithm of the gap, and beyond a gap of about the distance at contact a Chebyshev series in `t` or its
/// square.
#[derive(Debug, Clone)]
pub struct GapTable<const N: usize, const TERMS: usize = REGULAR> {
    tabulated: Tabulated<N>,
    near: NearContact<N, TERMS>,
    pieces: Vec<Chebyshev<N, NODES>>,
    far: Chebyshev<N, NODES>,
    far_from: f64,
}

impl<const N: usize, const TERMS: usize> GapTable<N, TERMS> {
    /// Computes the tables of functions with given singularities at contact.
    pub fn compute(
        tabulated: Tabulated<N>,
        singularities: [Singularity; N],
        exact: impl Fn(f64) -> [f64; N] + Send + Sync,
    ) -> Self {
        let Tabulated { size, is_even, .. } = tabulated;
        let nearest = tabulated.nearest();
        let count = (size / nearest).log(GROWTH).ceil() as usize;
        let edges: Vec<f64> = (0..=count).map(|k| nearest * GROWTH.powi(k as i32)).collect();
        let far_from = edges[count];
        // Divided by the leading power of t: smooth down to t = 0.
        let reduced = |gap: f64| tabulated.times_leading(&exact(gap), (size + gap) / size);
        let piece = |edge: &[f64]| {
            let (from, to) = (edge[0].ln(), edge[1].ln());
            Chebyshev::through(from, to, &sampled(from, to, |log| reduced(log.exp())))
        };
        let nearest_far = tabulated.far_variable(size / (size + far_from));
        let of_far = |x: f64| reduced(size * (1.0 / if is_even { x.sqrt() } else { x } - 1.0));
        Self {
            tabulated,
            near: NearContact::fit(tabulated.unit, singularities, nearest, &exact),
            pieces: edges.par_windows(2).map(piece).collect(),
            far: Chebyshev::through(0.0, nearest_far, &sampled(0.0, nearest_far, of_far)),
            far_from,
        }
    }

    /// All functions at a positive gap.
    pub fn at(&self, gap: f64) -> [f64; N] {
        let (nearest, size) = (self.tabulated.nearest(), self.tabulated.size);
        let t = size / (size + gap);
        if gap < nearest {
            self.near.at(gap)
        } else if gap < self.far_from {
            let log = gap.ln();
            let piece = (log - nearest.ln()) / GROWTH.ln();
            self.tabulated.times_leading(&self.pieces[(piece as usize).min(self.pieces.len() - 1)].at(log), t)
        } else {
            self.tabulated.times_leading(&self.far.at(self.tabulated.far_variable(t)), t)
        }
    }

    /// Gap at which the last series begins.
    #[cfg(test)]
    pub fn far_from(&self) -> f64 {
        self.far_from
    }
}

impl<const N: usize> Tabulated<N> {
    fn nearest(&self) -> f64 {
        NEAREST * self.least
    }

    fn far_variable(&self, t: f64) -> f64 {
        if self.is_even { t * t } else { t }
    }

    fn times_leading(&self, values: &[f64; N], t: f64) -> [f64; N] {
        std::array::from_fn(|i| values[i] * t.powi(self.leading[i] as i32))
    }
}

/// Values at the nodes of an interval, computed in parallel.
fn sampled<const N: usize>(from: f64, to: f64, function: impl Fn(f64) -> [f64; N] + Send + Sync) -> Samples<N, NODES> {
    let values: Vec<_> = Chebyshev::<N, NODES>::nodes(from, to).into_par_iter().map(function).collect();
    std::array::from_fn(|j| values[j])
}
