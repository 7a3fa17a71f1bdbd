//! What a wall sends back to the sphere that drives it, by the wavenumbers along it from one on.
//!
//! For a wavevector of length `k` along the wall at `z = 0`, with the direction `n` and `t = e_z x n`, the flow of a wall
//! (Blake 1971) is that of three waves, each as strong as the source is in it:
//!
//! ```text
//! -(phi_1 phi_1'^H + phi_2 phi_2'^H) / 4k - phi_3 phi_3'^H / 2k
//! phi_1 = (n (1 - x) - i e_z x) w,   phi_2 = (n x + i e_z (1 + x)) w,   phi_3 = t w,   x = k z,   w = exp(i k n.r - k z)
//! ```
//!
//! and `w` and `x w` are biharmonic, so that an envelope of width `s` acts on them exactly as `1 + (s^2/2) lap`: `x` becomes
//! `k z - k^2 s^2`. At one place, over all directions and wavenumbers, polynomials in `k` times `exp(-2 k z)` are left.

use domain::{Tensor, Vector};
use std::f64::consts::TAU;

/// The mobility of a sphere's image for its loads `F` and `G`, by tensors of the normal `e_z`, with `A` either of x and y and
/// the viscosity 1:
///
/// ```text
/// u_z  = -axial F_z - pull g,                     g = G_zz - (G_xx + G_yy)/2
/// D_zz = pull F_z + stretch g,                    D_xx + D_yy = -D_zz
/// u_A  = -across F_A - shear[0] G_Az - shear[1] G_zA
/// D_Az = shear[0] F_A + slide[0][0] G_Az + slide[0][1] G_zA
/// D_zA = shear[1] F_A + slide[1][0] G_Az + slide[1][1] G_zA
/// D_xx - D_yy = planar (G_xx - G_yy),             D_xy + D_yx = planar (G_xy + G_yx)
/// D_xy - D_yx = spin (G_xy - G_yx)
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Image {
    pub axial: f64,
    pub pull: f64,
    pub stretch: f64,
    pub across: f64,
    pub shear: [f64; 2],
    pub slide: [[f64; 2]; 2],
    pub planar: f64,
    pub spin: f64,
}

impl Image {
    /// By the wavenumbers from `lowest` on, of a sphere at the distance `z` from the wall, whose envelopes of force and dipole
    /// have widths of these squares.
    pub fn from(lowest: f64, z: f64, [force, dipole]: [f64; 2]) -> Self {
        let moments = moments(lowest, z);
        // Integrals of k^n times nothing, times x, and times x of one envelope and x of another.
        let one = |n: usize| moments[n];
        let x = |n: usize, s: f64| z * moments[n + 1] - s * moments[n + 2];
        let square =
            |n: usize, s: f64, d: f64| z * z * moments[n + 2] - z * (s + d) * moments[n + 3] + s * d * moments[n + 4];
        let (of_force, of_both, of_dipole) =
            (2.0 * square(0, force, force), 2.0 * square(1, force, dipole), 2.0 * square(2, dipole, dipole));
        let (force, dipole) = ([x(0, force), x(1, force)], [x(1, dipole), x(2, dipole)]);
        let stretch = 0.25 * (one(2) - 2.0 * dipole[1] + of_dipole);
        let mixed = -0.125 * (one(2) + 2.0 * dipole[1] - of_dipole);
        Self {
            axial: 0.25 * (one(0) + 2.0 * force[0] + of_force),
            pull: 0.25 * (dipole[0] - force[1] + of_both),
            stretch,
            across: 0.125 * (3.0 * one(0) - 2.0 * force[0] + of_force),
            shear: [
                0.125 * (4.0 * one(1) - dipole[0] - 3.0 * force[1] + of_both),
                0.125 * (force[1] - dipole[0] + of_both),
            ],
            slide: [
                [0.125 * (7.0 * one(2) - 6.0 * dipole[1] + of_dipole), mixed],
                [mixed, 0.125 * (one(2) + 2.0 * dipole[1] + of_dipole)],
            ],
            planar: 0.25 * stretch + 0.125 * one(2),
            spin: 0.25 * one(2),
        }
    }

    /// The same at a wall on the other side: reflected.
    #[must_use]
    pub fn reflected(self) -> Self {
        Self { pull: -self.pull, shear: self.shear.map(|entry| -entry), ..self }
    }

    /// The largest part of the mobility of a sphere of this radius alone that it may be, about.
    pub fn share(&self, radius: f64) -> f64 {
        let of_force = self.axial.max(self.across) * 3.0 * TAU * radius;
        let of_dipole = self.stretch.max(self.slide[0][0]).max(self.slide[1][1]) * 4.0 * TAU * radius.powi(3);
        of_force.max(of_dipole)
    }

    /// The velocity and the gradient `D_ij = d_j u_i` by a force and a dipole.
    pub fn motion(&self, force: Vector, dipole: &Tensor) -> (Vector, Tensor) {
        let g = |i: usize, j: usize| dipole.col(j)[i];
        let axial = g(2, 2) - 0.5 * (g(0, 0) + g(1, 1));
        let along = |a: usize| -self.across * force[a] - self.shear[0] * g(a, 2) - self.shear[1] * g(2, a);
        let slide =
            |a: usize, of: usize| self.shear[of] * force[a] + self.slide[of][0] * g(a, 2) + self.slide[of][1] * g(2, a);
        let stretch = self.pull * force.z + self.stretch * axial;
        let (difference, sum) = (0.5 * self.planar * (g(0, 0) - g(1, 1)), 0.5 * self.planar * (g(0, 1) + g(1, 0)));
        let turn = 0.5 * self.spin * (g(0, 1) - g(1, 0));
        let gradient = Tensor::from_cols(
            Vector::new(difference - 0.5 * stretch, sum - turn, slide(0, 1)),
            Vector::new(sum + turn, -difference - 0.5 * stretch, slide(1, 1)),
            Vector::new(slide(0, 0), slide(1, 0), stretch),
        );
        (Vector::new(along(0), along(1), -self.axial * force.z - self.pull * axial), gradient)
    }
}

impl std::ops::Add for Image {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let both = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            axial: self.axial + other.axial,
            pull: self.pull + other.pull,
            stretch: self.stretch + other.stretch,
            across: self.across + other.across,
            shear: both(self.shear, other.shear),
            slide: [both(self.slide[0], other.slide[0]), both(self.slide[1], other.slide[1])],
            planar: self.planar + other.planar,
            spin: self.spin + other.spin,
        }
    }
}

/// Integrals of `k^n exp(-2 k z) dk / 2 pi` from a wavenumber on: incomplete gamma functions, each from the one before.
fn moments(lowest: f64, z: f64) -> [f64; 7] {
    let decay = 1.0 / (2.0 * z);
    let (mut end, mut last) = ((-2.0 * lowest * z).exp() / TAU, 0.0);
    std::array::from_fn(|n| {
        last = (end + n as f64 * last) * decay;
        end *= lowest;
        last
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envelope::Envelope;
    use num_complex::Complex;
    use std::f64::consts::PI;

    type Wave = [Complex<f64>; 3];

    fn squares() -> [f64; 2] {
        let Envelope { monopole, dipole } = Envelope::of_sphere(1.0);
        [monopole * monopole, dipole * dipole]
    }

    /// The waves of a wavevector at the height `z`, without envelopes.
    fn waves(k: f64, angle: f64, z: f64) -> [Wave; 3] {
        let (n, e, x) = ([angle.cos(), angle.sin()], (-k * z).exp(), k * z);
        let wave = |along: f64, across: f64, up: f64| {
            let plane = [n[0] * along - n[1] * across, n[1] * along + n[0] * across];
            [Complex::new(plane[0] * e, 0.0), Complex::new(plane[1] * e, 0.0), Complex::new(0.0, up * e)]
        };
        [wave(1.0 - x, 0.0, -x), wave(x, 0.0, 1.0 + x), wave(0.0, 1.0, 0.0)]
    }

    /// Velocity and gradient, by columns, of a wave with its envelopes: derivatives along z by differences.
    fn of_sphere(k: f64, angle: f64, z: f64, [s, d]: [f64; 2]) -> [[Complex<f64>; 12]; 3] {
        let h = 4e-3;
        let at = |step: i32| waves(k, angle, z + f64::from(step) * h);
        let values = [-3, -2, -1, 0, 1, 2, 3].map(at);
        std::array::from_fn(|wave| {
            let value = |c: usize, step: i32| values[(step + 3) as usize][wave][c];
            let sum = |c: usize, weights: [f64; 7]| -> Complex<f64> {
                (-3..=3).zip(weights).map(|(step, weight)| value(c, step) * weight).sum()
            };
            let first = |c: usize| sum(c, [-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0].map(|w| w / (60.0 * h)));
            let second = |c: usize| sum(c, [2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0].map(|w| w / (180.0 * h * h)));
            let third = |c: usize| sum(c, [1.0, -8.0, 13.0, 0.0, -13.0, 8.0, -1.0].map(|w| w / (8.0 * h * h * h)));
            let mut motion = [Complex::default(); 12];
            for c in 0..3 {
                let smooth = |width: f64| value(c, 0) + 0.5 * width * (second(c) - k * k * value(c, 0));
                motion[c] = smooth(s);
                for (j, part) in [angle.cos(), angle.sin()].into_iter().enumerate() {
                    motion[3 + 3 * j + c] = Complex::new(0.0, k * part) * smooth(d);
                }
                motion[9 + c] = first(c) + 0.5 * d * (third(c) - k * k * first(c));
            }
            motion
        })
    }

    /// The matrix from `(F, -G)` to `(u, D)`, both by columns.
    fn matrix(image: &Image) -> [[f64; 12]; 12] {
        let mut matrix = [[0.0; 12]; 12];
        for column in 0..12 {
            let (mut force, mut dipole) = ([0.0; 3], [0.0; 9]);
            if column < 3 {
                force[column] = 1.0;
            } else {
                dipole[column - 3] = -1.0;
            }
            let (u, gradient) = image.motion(Vector::from_array(force), &Tensor::from_cols_array(&dipole));
            let rows = u.to_array().into_iter().chain(gradient.to_cols_array());
            matrix.iter_mut().zip(rows).for_each(|(row, entry)| row[column] = entry);
        }
        matrix
    }

    /// By quadrature of the waves over directions and wavenumbers, with derivatives by differences of sixth order, of the third
    /// one of fourth: about 1e-7 of waves whose lengths are a hundred times that of a difference.
    #[test]
    fn it_is_the_integral_over_waves() {
        let (z, lowest) = (1.1, 1.7);
        let mut expected = [[0.0; 12]; 12];
        let (steps, width, angles) = (900, 0.02, 5);
        for step in 0..=steps {
            let k = lowest + width * f64::from(step);
            // Simpson's rule.
            let simpson = if step == 0 || step == steps { 1.0 } else { 2.0 + 2.0 * f64::from(step % 2) } / 3.0;
            for angle in 0..angles {
                let weight = simpson * width * k / (TAU * f64::from(angles));
                let of = of_sphere(k, TAU * f64::from(angle) / f64::from(angles), z, squares());
                for (wave, factor) in of.iter().zip([0.25 / k, 0.25 / k, 0.5 / k]) {
                    for (row, a) in expected.iter_mut().zip(wave) {
                        for (entry, b) in row.iter_mut().zip(wave) {
                            *entry -= weight * factor * (a * b.conj()).re;
                        }
                    }
                }
            }
        }
        let found = matrix(&Image::from(lowest, z, squares()));
        // The dipole has no trace: neither has the mean of what it drives.
        let traceless = |row: &[f64; 12]| {
            let mut row = *row;
            let mean = (row[3] + row[7] + row[11]) / 3.0;
            for entry in [3, 7, 11] {
                row[entry] -= mean;
            }
            row
        };
        let largest = expected.as_flattened().iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        for (row, (found, expected)) in found.iter().zip(&expected).enumerate() {
            for (column, (f, e)) in traceless(found).iter().zip(traceless(expected)).enumerate() {
                assert!((f - e).abs() < 1e-6 * largest, "{row} {column}: {f}, not {e}");
            }
        }
    }

    /// Stokes' drag near a wall to the order of the width: `1 - 9a/16z + ...` along it and `1 - 9a/8z + ...` across, and the
    /// drag of a torque, `1 - a^3/8z^3` about the normal and `1 - 5a^3/16z^3` across (Goldman, Cox & Brenner 1967).
    #[test]
    fn all_wavenumbers_make_the_image_of_a_point() {
        for z in [0.9, 2.0, 30.0] {
            let image = Image::from(0.0, z, [0.0; 2]);
            let turn = (image.slide[0][0] - 2.0 * image.slide[0][1] + image.slide[1][1]) / 4.0;
            let found = [image.across * 6.0 * PI, image.axial * 6.0 * PI, image.spin * 4.0 * PI, turn * 8.0 * PI];
            let expected = [9.0 / (16.0 * z), 9.0 / (8.0 * z), 1.0 / (8.0 * z.powi(3)), 5.0 / (16.0 * z.powi(3))];
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-14, "at {z}: {found}, not {expected}");
            }
        }
        let squares = squares();
        let (z, s) = (1.3_f64, squares[0]);
        let image = Image::from(0.0, z, squares);
        let expected = 9.0 / (8.0 * z) - 1.5 * PI * s / z.powi(3) / PI + 9.0 / 8.0 * s * s / z.powi(5);
        assert!((image.axial * 6.0 * PI - expected).abs() < 1e-14, "{} {expected}", image.axial * 6.0 * PI);
    }

    #[test]
    fn it_is_symmetric_and_takes_mobility_away() {
        for (lowest, z) in [(0.0, 0.85), (2.0, 0.9), (4.0, 2.5)] {
            let image = Image::from(lowest, z, squares());
            for image in [image, image.reflected(), image + image.reflected()] {
                let matrix = matrix(&image);
                let size = matrix[0][0].abs();
                for (i, j) in (0..12).flat_map(|i| (0..12).map(move |j| (i, j))) {
                    assert!((matrix[i][j] - matrix[j][i]).abs() < 1e-14 * size, "{i} {j}");
                }
                for load in 0..50 {
                    let value = |i: usize| ((load * 12 + i) as f64 * 1.7).sin() * (1.0 + (load * i) as f64).cos();
                    let load: [f64; 12] = std::array::from_fn(value);
                    let power: f64 = matrix
                        .iter()
                        .zip(load)
                        .map(|(row, a)| row.iter().zip(load).map(|(m, b)| m * a * b).sum::<f64>())
                        .sum();
                    assert!(power < 0.0, "{power}");
                }
            }
        }
    }
}
