//! Relative divergence of a velocity field.

use crate::{Field, Grid, Physical, Real, Transform};
use domain::{Comm, Vector};
use num_complex::Complex;

/// The largest `|k.u_hat|` of all modes over the largest `|k| |u_hat|`, on every rank the same: 0 for a solenoidal
/// field, 1 for a gradient, and 0 for no field at all. The highest modes of each axis, which have no derivative, do not
/// count. The values of the field, whose halos are to be clear, are lost.
pub fn divergence<T: Real>(
    grid: &Grid,
    transform: &mut Transform<T>,
    velocity: &mut Field<T, Physical>,
    comm: &Comm,
) -> f64 {
    let mut largest = [0.0_f64; 2];
    transform.for_each_mode(velocity, |mode, values| {
        if (0..3).any(|axis| grid.is_nyquist(axis, mode[axis])) {
            return;
        }
        let k = grid.wavevector(mode);
        let u = values.map(|value| Complex::new(value.re.to_f64(), value.im.to_f64()));
        let [re, im] = [Vector::from_array(u.map(|u| u.re)), Vector::from_array(u.map(|u| u.im))];
        largest[0] = largest[0].max(k.dot(re).hypot(k.dot(im)));
        largest[1] = largest[1].max(k.length() * re.length().hypot(im.length()));
    });
    comm.max(&mut largest);
    if largest[1] > 0.0 { largest[0] / largest[1] } else { 0.0 }
}
