//! Stress of moments on the grid.

use super::spectral_grid::SpectralGrid;
use domain::{Tensor, Vector};
use num_complex::Complex;
use solver::Real;

impl<T: Real> SpectralGrid<T> {
    /// Derivative of the energy of the spread moments with respect to a deformation `e` of the lattice and of the
    /// positions, `x -> x + e x`, at constant moments and envelopes: with `q = k . M(k)` and the common Gaussian's
    /// width `Sigma`,
    ///
    /// ```text
    /// U             = 1/(2V) sum_k exp(-k^2 Sigma^2) |q|^2 / k^2
    /// dU / d e_ab   = 1/V sum_k exp(-k^2 Sigma^2) / k^2
    ///                 [(Sigma^2 + 1/k^2) |q|^2 k_a k_b - delta_ab |q|^2 / 2 - k_a Re(q* M_b)]
    /// ```
    ///
    /// The sum over this rank's modes, of which one of each pair of opposite wavevectors is kept. The field, which
    /// holds the spread moments, is overwritten.
    pub(super) fn first_moments_by_modes(&mut self) -> Tensor {
        let Self { plan, grid, transform, field, .. } = self;
        let (window, common) = (plan.window().expect("moments have windows"), plan.common().expect("and a Gaussian"));
        let (spacing, strain, width) = (grid.spacing(), grid.strain(), common.width);
        let visit = |sum: Tensor, mode: [usize; 3], values: [Complex<T>; 3]| {
            let k = grid.wavevector(mode);
            let square = k.length_squared();
            if square == 0.0 || (0..3).any(|axis| grid.is_nyquist(axis, mode)) {
                return sum;
            }
            let [along_x, along_y] = [k.x * spacing.x, (k.y + strain * k.x) * spacing.y];
            let along_z = grid.wavenumber(2, mode[2]) * spacing.z;
            let windows = window.transform(along_x) * window.transform(along_y) * window.transform(along_z);
            let weight = if mode[0] == 0 { 1.0 } else { 2.0 } / (windows * windows);
            let density = weight * (-square * width * width).exp() / square;
            sum + of_mode(k, values.map(|value| [value.re.to_f64(), value.im.to_f64()]), width) * density
        };
        let parts = transform.fold_modes(field, || Tensor::ZERO, visit);
        let sum = parts.into_iter().fold(Tensor::ZERO, |sum, part| sum + part) * (1.0 / grid.cell().volume());
        grid.cell().axes().map_or(sum, |axes| *axes * sum * axes.transpose())
    }
}

/// The bracket of the sum, for a spectrum `M` given by real and imaginary parts.
fn of_mode(k: Vector, spectrum: [[f64; 2]; 3], width: f64) -> Tensor {
    let [real, imaginary] = [0, 1].map(|part| Vector::from_array(spectrum.map(|value| value[part])));
    let (q, p) = (k.dot(real), k.dot(imaginary));
    let (intensity, along) = (q * q + p * p, real * q + imaginary * p);
    let level = (width * width + 1.0 / k.length_squared()) * intensity;
    let column = |b: usize| {
        let mut column = k * (level * k[b] - along[b]);
        column[b] -= 0.5 * intensity;
        column
    };
    Tensor::from_cols(column(0), column(1), column(2))
}
