//! Coefficients of products of the window's derivatives.

use crate::grid::window::kaiser_bessel::DERIVATIVES;
use crate::grid::window::lattice::{SECOND, Smoothing, UPRIGHT};
use solver::Real;

/// Coefficients by the orders along x, y and z, and by component.
pub(super) type WindowCoefficients<T, const C: usize> = [[[[T; C]; DERIVATIVES]; DERIVATIVES]; DERIVATIVES];

/// Adds a load's derivative to the coefficients, and those of its Laplacian, as far as the order goes.
#[inline(always)]
pub(super) fn add<T: Real, const C: usize, const ORDER: usize>(
    all: &mut WindowCoefficients<T, C>,
    [n, m, l]: [usize; 3],
    load: [T; C],
    smoothing: Smoothing<T>,
) {
    for c in 0..C {
        all[n][m][l][c] += load[c];
    }
    if n + m + l + 2 <= ORDER {
        add_laplacian(all, [n, m, l], load, smoothing);
    }
}

/// Adds the Laplacian of a load's derivative, times a factor that is part of the smoothing's.
#[inline(always)]
pub(super) fn add_laplacian<T: Real, const C: usize>(
    all: &mut WindowCoefficients<T, C>,
    [n, m, l]: [usize; 3],
    load: [T; C],
    smoothing: Smoothing<T>,
) {
    for second in 0..SECOND.len() {
        if second >= UPRIGHT && !smoothing.is_tilted {
            break;
        }
        let (factor, [dn, dm, dl]) = (smoothing.factors[second], SECOND[second]);
        for c in 0..C {
            all[n + dn][m + dm][l + dl][c] += factor * load[c];
        }
    }
}
