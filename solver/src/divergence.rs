//! Relative divergence of a velocity field.

use crate::{Field, Grid, Physical, Real, Transform};
use domain::{Comm, Vector};
use num_complex::Complex;

/// Largest `|k.u_hat|` of all modes over the largest `|k| |u_hat|`, the same on every rank: 0 for a solenoidal field,
/// 1 for a gradient, and 0 for a zero field. The highest modes of each axis, which have no derivative, are left out.
/// The field, whose halos must be clear, is overwritten.
pub fn divergence<T: Real>(
    grid: &Grid,
    transform: &mut Transform<T>,
    velocity: &mut Field<T, Physical>,
    comm: &Comm,
) -> f64 {
    // Squares; the square roots are taken once at the end.
    let visit = |largest: [f64; 2], mode: [usize; 3], values: [Complex<T>; 3]| {
        if (0..3).any(|axis| grid.is_nyquist(axis, mode)) {
            return largest;
        }
        let k = grid.wavevector(mode);
        let [re, im] =
            [values.map(|value| value.re.to_f64()), values.map(|value| value.im.to_f64())].map(Vector::from_array);
        let squares =
            [k.dot(re).powi(2) + k.dot(im).powi(2), k.length_squared() * (re.length_squared() + im.length_squared())];
        greater(largest, squares)
    };
    let parts = transform.fold_modes(velocity, || [0.0; 2], visit);
    let mut largest = parts.into_iter().fold([0.0; 2], greater).map(f64::sqrt);
    comm.max(&mut largest);
    if largest[1] > 0.0 { largest[0] / largest[1] } else { 0.0 }
}

fn greater([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a.max(c), b.max(d)]
}
