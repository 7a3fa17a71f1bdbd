//! Stokes solve in a box whose third lattice vector is tilted.

use super::{Multiplier, Stokes, part, project};
use crate::{Grid, Real};
use simd::{SimdVector, VectorKernel, exponential};

/// Additional tables of the solve in a lattice whose third vector is tilted by `t` and `r`: the wavevector's third
/// component is `k3 + shift(k1, k2)`, and the Gaussian of its square is no product of functions along the axes. So
/// the multiplier is `exp(level(k1, k2) + level(k3) - width^2 k^2)`, computed on the fly, in which no factor
/// overflows or underflows `T` unless the product does.
pub(super) struct TiltedTables<T> {
    /// Values for each m2 and m1.
    shift: Vec<T>,
    level: Vec<T>,
    /// Values for each m3.
    axis: Vec<T>,
    /// `-width^2`
    falling: T,
}

impl<T: Real> TiltedTables<T> {
    /// For modes `m1`, `m2` by their wavevectors at `m3 = 0`.
    pub fn new<P, A>(grid: &Grid, modes: &[domain::Vector], multiplier: &Multiplier<P, A>) -> Self
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> f64,
    {
        let Multiplier { plane, axis, width, .. } = multiplier;
        Self {
            shift: modes.iter().map(|k| T::from_f64(k.z)).collect(),
            level: modes.iter().map(|k| T::from_f64(plane(k.x, k.y).ln())).collect(),
            axis: (0..grid.points()[2]).map(|m3| T::from_f64(axis(grid.wavenumber(2, m3).abs()).ln())).collect(),
            falling: T::from_f64(-width * width),
        }
    }

    #[cfg(test)]
    pub fn bytes(&self) -> usize {
        [&self.shift, &self.level, &self.axis].map(|table| size_of_val(&table[..])).iter().sum()
    }

    pub fn shift(&self, in_plane: usize) -> f64 {
        self.shift[in_plane].to_f64()
    }

    /// Multiplier of a mode whose wavevector has this square.
    pub fn multiplier(&self, in_plane: usize, m3: usize, square: f64) -> f64 {
        let levels = self.level[in_plane].to_f64() + self.axis[m3].to_f64();
        (levels + self.falling.to_f64() * square).exp()
    }
}

/// Kernel of [`Stokes::multiply`] for a tilted lattice.
pub(super) struct MultiplyTilted<'a, T, const C: usize> {
    pub operator: &'a Stokes<T, C>,
    pub tilted: &'a TiltedTables<T>,
    pub place: [usize; 2],
    pub components: [*mut T; C],
}

impl<T: Real, const C: usize> VectorKernel<T> for MultiplyTilted<'_, T, C> {
    type Output = ();

    #[inline(always)]
    fn run<V: SimdVector<T>>(self) {
        let Stokes { points, k1, k2, plane, inverse, k3, widening, .. } = self.operator;
        let TiltedTables { shift, level, axis, falling } = self.tilted;
        let nz = points[2];
        let [block, mode] = self.place;
        let column = block * T::LANES;
        let in_plane = mode * k1.len() + column;
        let [k1, k2] = [part::<T, V>(k1, column), part::<T, V>(k2, in_plane)];
        let [shift, level, plane] = [shift, level, plane].map(|table| part::<T, V>(table, in_plane));
        let in_plane_square = k2.mul_add(k2, k1.mul(k1));
        let [one, zero, widening, falling] =
            [T::from_f64(1.0), T::default(), *widening, *falling].map(|value| V::splat(value));
        for m3 in 0..nz {
            if m3 == nz / 2 {
                // SAFETY: the columns have nz elements.
                unsafe { project::<T, V, C>(self.components, [k1, k2, zero], [zero, zero], m3) };
                continue;
            }
            let k3 = shift.add(V::splat(k3[m3]));
            let square = k3.mul_add(k3, in_plane_square);
            // The origin is at m3 = 0.
            let inverse = if m3 == 0 { part::<T, V>(inverse, in_plane) } else { one.div(square) };
            let exponent = square.mul_add(falling, level.add(V::splat(axis[m3])));
            let bracket = square.mul_add(widening, one);
            let factor = plane.mul(exponential::<T, V>(exponent)).mul(inverse).mul(bracket).mul(bracket);
            // SAFETY: the columns have nz elements.
            unsafe { project::<T, V, C>(self.components, [k1, k2, k3], [inverse, factor], m3) };
        }
    }
}
