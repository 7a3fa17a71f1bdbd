//! The flow that a wall sends back from a sphere under loads, at points of the fluid at one distance from it.
//!
//! Loads that are known give the waves of each wavevector their amplitudes. Over all directions of it, at a distance `r` from the
//! sphere along the wall and in the direction `psi`, that is
//!
//! ```text
//! u = sum_k [ A_0 J_0(k r) + sum_m (A_m cos(m psi) + B_m sin(m psi)) J_m(k r) ],        m = 1, 2, 3
//! ```
//!
//! as forces and dipoles turn at most twice around the sphere, and velocities once more.

use super::{DIRECTIONS, IMAGINARY, LOCAL, Seen, Waves, load, waves};
use crate::bessel::{LANES, bessel};
use domain::{Tensor, Vector};
use solver::simd::vectorised;

/// One, and cosine and sine of the angle and its multiples.
const AROUND: usize = 7;

/// Along the wavevector, up, and across: the velocities among [`LOCAL`].
const VELOCITY: [usize; 3] = [0, 3, 5];

/// Of some wavenumbers and each function around the sphere the components of the velocity.
type Amplitudes = [[[f64; LANES]; 3]; AROUND];

/// What a sphere sends points of the fluid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Returned(Vec<Amplitudes>);

impl Waves {
    /// What a sphere under a force and a dipole sends points at a distance from the wall, by a wall below both, for the viscosity 1.
    pub fn returned(&self, distance: f64, from: Seen, (force, dipole): (Vector, &Tensor)) -> Returned {
        let mut amplitudes = vec![[[[0.0; LANES]; 3]; AROUND]; self.weights.len()];
        vectorised(
            #[inline(always)]
            || {
                let loads = load(-force, dipole);
                let mut of_directions = [[0.0; LOCAL]; DIRECTIONS];
                for (n, local) in self.directions.iter().zip(&mut of_directions) {
                    *local = in_frame(*n, &loads);
                }
                let point = Seen { distance, squares: [0.0; 2] };
                let heights = distance + from.distance;
                let (mut k, mut decay, ratio) =
                    (self.first, (-self.first * heights).exp(), (-self.step * heights).exp());
                for (weights, amplitudes) in self.weights.iter().zip(&mut amplitudes) {
                    for lane in 0..LANES {
                        let factor = 0.25 / DIRECTIONS as f64 * weights[lane] * decay;
                        let (to, from) = (waves(k, point), waves(k, from));
                        for (n, loads) in self.directions.iter().zip(&of_directions) {
                            let [even, odd] = velocities(*n, (&to, &from), loads);
                            add_direction(*n, factor, [even, odd], lane, amplitudes);
                        }
                        k += self.step;
                        decay *= ratio;
                    }
                }
            },
        );
        Returned(amplitudes)
    }

    /// The velocity at `x` from the sphere.
    #[inline(always)]
    pub fn velocity_at(&self, Returned(amplitudes): &Returned, x: Vector) -> Vector {
        let distance = (x.x * x.x + x.y * x.y).sqrt();
        let [c, s] = if distance > 0.0 { [x.x / distance, x.y / distance] } else { [1.0, 0.0] };
        let [double, twice] = [c * c - s * s, 2.0 * c * s];
        let around = [1.0, c, s, double, twice, c * double - s * twice, s * double + c * twice];
        let (mut k, mut sums) = (self.first, [[0.0; LANES]; 3]);
        for amplitudes in amplitudes {
            let bessel = bessel([k * distance, self.step * distance]);
            for (function, of_components) in amplitudes.iter().enumerate() {
                let of_order = &bessel[function.div_ceil(2)];
                for (sums, amplitudes) in sums.iter_mut().zip(of_components) {
                    for lane in 0..LANES {
                        sums[lane] = (around[function] * of_order[lane]).mul_add(amplitudes[lane], sums[lane]);
                    }
                }
            }
            k += LANES as f64 * self.step;
        }
        let [x, y, z] = sums.map(|lanes| lanes.iter().sum());
        Vector::new(x, y, z)
    }
}

/// Loads in the frame of a direction: the transpose of what turns motions out of it.
#[inline(always)]
fn in_frame([c, s]: [f64; 2], [fx, fy, fz, xx, xy, xz, yx, yy, yz, zx, zy, zz]: &[f64; 12]) -> [f64; LOCAL] {
    let (along_x, along_y) = (c * xx + s * yx, c * xy + s * yy);
    [
        c * fx + s * fy,
        c * xz + s * yz,
        c * zx + s * zy,
        *fz,
        c * along_x + s * along_y - zz,
        c * fy - s * fx,
        c * zy - s * zx,
        c * along_y - s * along_x,
    ]
}

/// What waves of a direction at a sphere under loads make of the velocity at a point, in space: by even Bessel functions, and by
/// odd ones.
#[inline(always)]
fn velocities(
    [c, s]: [f64; 2],
    (to, from): (&[[f64; LOCAL]; 3], &[[f64; LOCAL]; 3]),
    loads: &[f64; LOCAL],
) -> [[f64; 3]; 2] {
    let mut local = [[0.0; 3]; 2];
    for wave in 0..3 {
        let mut amplitudes = [0.0; 2];
        for j in 0..LOCAL {
            amplitudes[usize::from(IMAGINARY[j])] += from[wave][j] * loads[j];
        }
        let [real, imaginary] = amplitudes;
        for (component, row) in VELOCITY.into_iter().enumerate() {
            let [even, odd] = if IMAGINARY[row] { [imaginary, -real] } else { [real, imaginary] };
            local[0][component] += to[wave][row] * even;
            local[1][component] += to[wave][row] * odd;
        }
    }
    let mut in_space = [[0.0; 3]; 2];
    for ([n, up, t], in_space) in local.into_iter().zip(&mut in_space) {
        *in_space = [c * n - s * t, s * n + c * t, up];
    }
    in_space
}

/// Adds a direction's part to the amplitudes of a wavenumber.
#[inline(always)]
fn add_direction([c, s]: [f64; 2], factor: f64, [even, odd]: [[f64; 3]; 2], lane: usize, amplitudes: &mut Amplitudes) {
    let [double, twice] = [c * c - s * s, 2.0 * c * s];
    let [thrice_c, thrice_s] = [c * double - s * twice, s * double + c * twice];
    let of_even = [1.0, 0.0, 0.0, -2.0 * double, -2.0 * twice, 0.0, 0.0];
    let of_odd = [0.0, 2.0 * c, 2.0 * s, 0.0, 0.0, -2.0 * thrice_c, -2.0 * thrice_s];
    for function in 0..AROUND {
        for component in 0..3 {
            let part = of_even[function] * even[component] + of_odd[function] * odd[component];
            amplitudes[function][component][lane] += factor * part;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a block makes of the same loads.
    #[test]
    fn velocities_are_those_of_blocks() {
        let waves = Waves::with(0.9, 0.3, &[0.1, 0.2, 0.3, 0.25, 0.3, 0.1, 0.2, 0.1, 0.3, 0.2, 0.1]);
        let (point, from) = (Seen { distance: 0.4, squares: [0.0; 2] }, Seen { distance: 1.3, squares: [0.3, 0.2] });
        let force = Vector::new(0.3, -0.2, 0.9);
        let dipole = Tensor::from_cols_array(&[0.1, 0.4, -0.7, 1.1, 0.5, 0.2, 0.9, -1.3, -0.6]);
        for (force, dipole) in [(force, Tensor::ZERO), (Vector::ZERO, dipole), (force, dipole)] {
            let returned = waves.returned(point.distance, from, (force, &dipole));
            for x in [Vector::new(1.7, -2.3, 0.4), Vector::new(-0.3, 0.2, -0.9), Vector::ZERO] {
                let (expected, _) = waves.block(x, [point, from]).motion(force, &dipole);
                let found = waves.velocity_at(&returned, x);
                assert!((found - expected).length() < 1e-12 * expected.length(), "{found} at {x}, not {expected}");
            }
        }
    }
}
