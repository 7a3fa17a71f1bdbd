//! Derivatives of a potential, interpolated with windows.

use super::kernel::{PAIRS, pair};
use crate::grid::kernel::WeightedSums;
use crate::grid::window::kaiser_bessel::DERIVATIVES;
use crate::grid::window::lattice::Slants;
use simd::SimdVector as Lanes;
use solver::Real;

/// Orders along the lattice of the derivatives of a potential.
const ORDERS: [[usize; 3]; 9] =
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [2, 0, 0], [1, 1, 0], [1, 0, 1], [0, 2, 0], [0, 1, 1], [0, 0, 2]];

/// Sums over the columns: of the first derivatives along the lattice, and of the second ones if `ORDER` has them.
#[inline(always)]
pub(super) fn totals<T: Real, V: Lanes<T>, const ORDER: usize, const C: usize, const WIDTH: usize>(
    columns: &[[V; WIDTH]; DERIVATIVES],
    sums: &[[[V; WIDTH]; C]; PAIRS],
) -> [V; 12] {
    let mut totals = [V::splat(T::default()); 12];
    for (total, [n, m, l]) in totals.iter_mut().zip(ORDERS) {
        if n + m + l <= ORDER {
            for part in 0..WIDTH {
                *total = columns[n][part].mul_add(sums[pair(m, l)][0][part], *total);
            }
        }
    }
    totals
}

/// Converts these derivatives to those along the axes.
#[inline(always)]
pub(super) fn weighed<T: Real>(slopes: ([T; 3], Slants<T>), totals: [T; 12]) -> WeightedSums<T> {
    let ([x, y, z], Slants { s, r, f }) = slopes;
    let axes = |[along, across, up]: [T; 3]| {
        let [along, across, up] = [along * x, across * y, up * z];
        [along, across - s * along, up - r * across - f * along]
    };
    let [a, b, c, aa, ab, ac, bb, bc, cc, ..] = totals;
    // Along the axes for one derivative, and then for the other.
    let mixed = [[aa, ab, ac], [ab, bb, bc], [ac, bc, cc]].map(axes);
    let gradient = std::array::from_fn(|axis| axes(mixed.map(|along| along[axis])));
    WeightedSums { velocity: axes([a, b, c]), gradient }
}
