//! Resistance functions closer than any gap where they are computed: the near-contact expansion.

use super::exact;
use super::functions::{Function, ResistanceFunctions};
use super::singular::{self, Singularity};
use crate::dense;
use rayon::prelude::*;

/// Terms of the regular part: `1, x, x² L, x², x³ L, x³, x⁴ L, x⁴`, with `x` the gap and `L = ln 1/x`.
const TERMS: usize = 8;

/// `g1/xi + g2 ln(1/xi) + g3 xi ln(1/xi)` plus a regular part fitted to exact values, `xi = 2 gap/(a1 + a2)`.
#[derive(Debug, Clone)]
pub struct NearContact {
    ratio: f64,
    singular: [Singularity; 44],
    regular: [[f64; 44]; TERMS],
}

impl NearContact {
    /// Fitted to values at gaps from `start` up to 16 times that.
    pub fn fit(ratio: f64, start: f64) -> Self {
        let mut near = Self { ratio, singular: singularities(ratio), regular: [[0.0; 44]; TERMS] };
        let gaps: [f64; TERMS] = std::array::from_fn(|j| start * 16.0_f64.powf(j as f64 / (TERMS - 1) as f64));
        let values: Vec<[f64; 44]> = gaps.into_par_iter().map(|gap| near.regular_part(gap)).collect();
        near.regular = dense::solve(gaps.map(terms), std::array::from_fn(|j| values[j]));
        near
    }

    /// All functions at `gap`.
    pub fn at(&self, gap: f64) -> [f64; 44] {
        let terms = terms(gap);
        let mut values = self.singular_part(gap);
        for (term, coefficients) in terms.iter().zip(&self.regular) {
            values.iter_mut().zip(coefficients).for_each(|(value, c)| *value += term * c);
        }
        values
    }

    fn regular_part(&self, gap: f64) -> [f64; 44] {
        let ResistanceFunctions(exact) = exact::resistance(self.ratio, gap);
        let (exact, singular) = (exact.as_flattened().as_flattened(), self.singular_part(gap));
        std::array::from_fn(|i| exact[i] - singular[i])
    }

    fn singular_part(&self, gap: f64) -> [f64; 44] {
        let xi = 2.0 * gap / (1.0 + self.ratio);
        let log = -xi.ln();
        self.singular.map(|[g1, g2, g3]| g1 / xi + (g2 + g3 * xi) * log)
    }
}

fn terms(x: f64) -> [f64; TERMS] {
    let log = -x.ln();
    [1.0, x, x * x * log, x * x, x.powi(3) * log, x.powi(3), x.powi(4) * log, x.powi(4)]
}

/// Singularities of the functions in table order, for both spheres.
fn singularities(ratio: f64) -> [Singularity; 44] {
    std::array::from_fn(|i| {
        let function = Function::ALL[i / 4];
        let (bears, moves) = (i / 2 % 2, i % 2);
        let (lambda, flip) =
            if bears == 0 { (ratio, 1.0) } else { (1.0 / ratio, if function.is_odd() { -1.0 } else { 1.0 }) };
        let singularity =
            if bears == moves { singular::own(function, lambda) } else { singular::other(function, lambda) };
        singularity.map(|g| g * flip)
    })
}
