//! Relative divergence of a velocity field.

use crate::{Field, Grid, Real, Spectral};
use domain::{Comm, Vector};

/// The largest `|k.u_hat|` of all modes over the largest `|k| |u_hat|`, on every rank the same: 0 for a solenoidal
/// field, 1 for a gradient, and 0 for no field at all. The highest modes of each axis, which have no derivative, do not
/// count.
pub fn divergence<T: Real>(grid: &Grid, velocity: &Field<T, Spectral>, comm: &Comm) -> f64 {
    // Squares, whose roots are taken once.
    let squares = velocity.largest_of_modes(|mode, values| {
        if (0..3).any(|axis| grid.is_nyquist(axis, mode[axis])) {
            return [0.0; 2];
        }
        let k = grid.wavevector(mode);
        let [re, im] =
            [values.map(|value| value.re.to_f64()), values.map(|value| value.im.to_f64())].map(Vector::from_array);
        let along = [k.dot(re), k.dot(im)];
        [along[0] * along[0] + along[1] * along[1], k.length_squared() * (re.length_squared() + im.length_squared())]
    });
    let mut largest = squares.map(f64::sqrt);
    comm.max(&mut largest);
    if largest[1] > 0.0 { largest[0] / largest[1] } else { 0.0 }
}
