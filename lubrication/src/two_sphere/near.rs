//! Near-contact expansion of the resistance functions, below the smallest gap at which they are computed.

use super::singular::Singularity;
use crate::dense;
use rayon::prelude::*;

/// Number of terms of a regular part.
pub const REGULAR: usize = 8;

/// `g1/xi + g2 ln(1/xi) + g3 xi ln(1/xi)` for `N` functions plus a regular part fitted to exact values, with `xi` the
/// gap over the mean radius, or over the radius of a sphere at a wall. With more than [`REGULAR`] terms, logarithms
/// with coefficients that are not known are fitted too.
#[derive(Debug, Clone)]
pub struct NearContact<const N: usize, const TERMS: usize> {
    /// Radius that is the unit of `xi`.
    unit: f64,
    singular: [Singularity; N],
    regular: [[f64; N]; TERMS],
}

impl<const N: usize, const TERMS: usize> NearContact<N, TERMS> {
    /// Fit to values at gaps from `start` to 16 times that.
    pub fn fit(
        unit: f64,
        singular: [Singularity; N],
        start: f64,
        exact: impl Fn(f64) -> [f64; N] + Send + Sync,
    ) -> Self {
        let mut near = Self { unit, singular, regular: [[0.0; N]; TERMS] };
        let gaps: [f64; TERMS] = std::array::from_fn(|j| start * 16.0_f64.powf(j as f64 / (TERMS - 1) as f64));
        let regular = |gap: f64| {
            let (exact, singular) = (exact(gap), near.singular_part(gap));
            std::array::from_fn(|i| exact[i] - singular[i])
        };
        let values: Vec<[f64; N]> = gaps.into_par_iter().map(regular).collect();
        near.regular = dense::solve(gaps.map(terms), std::array::from_fn(|j| values[j]));
        near
    }

    /// All functions at `gap`.
    pub fn at(&self, gap: f64) -> [f64; N] {
        let terms = terms::<TERMS>(gap);
        let mut values = self.singular_part(gap);
        for (term, coefficients) in terms.iter().zip(&self.regular) {
            values.iter_mut().zip(coefficients).for_each(|(value, c)| *value += term * c);
        }
        values
    }

    fn singular_part(&self, gap: f64) -> [f64; N] {
        let xi = gap / self.unit;
        let log = -xi.ln();
        self.singular.map(|[g1, g2, g3]| g1 / xi + (g2 + g3 * xi) * log)
    }
}

/// `1, x, x² L, x², x³ L, x³, x⁴ L, x⁴`, with `x` the gap and `L = ln 1/x`, and then `L, x L`.
fn terms<const TERMS: usize>(x: f64) -> [f64; TERMS] {
    let log = -x.ln();
    let all = [1.0, x, x * x * log, x * x, x.powi(3) * log, x.powi(3), x.powi(4) * log, x.powi(4), log, x * log];
    std::array::from_fn(|term| all[term])
}
