//! Divergence of the mobility near walls: the change of a sphere's motion under a force with its distance from the
//! walls.
//!
//! The flow of a force on one sphere at the position of another has no divergence with respect to the position of the
//! force, walls or not: the fluid is incompressible and its mobility symmetric. There remain the images of a sphere
//! in itself, where source and target move together. With the flow `sum_pq K_pq f_p(z) f_q(z')` of a wavevector
//! `(k_x, k_y)` along the walls, and envelopes of widths `s` and `d` of forces and dipoles,
//!
//! ```text
//! div V   = 1/(mu A) sum_k sum_pq K_pq d/dz [f_p(z; s) f_q(z; s)]
//! div E_c = 1/(mu A) sum_k e_c sum_pq K_pq d/dz [f_p'(z; d) f_q(z; s)]
//! e_zz = 1,  e_xx = -k_x^2/k^2,  e_yy = -k_y^2/k^2
//! ```
//!
//! over the wavevectors of a box of area `A`. An envelope acts on the functions as `1 + (s^2/2) lap`, so all are
//! polynomials in squared widths: their coefficients are tabulated, and hold for any radius.

use crate::envelope::Envelope;
use crate::plan::Plan;
use crate::plan::bounded::NEAREST_WALL;
use domain::parallel::MeasuredLoop;
use domain::{Traceless, Vector};
use rayon::prelude::*;
use solver::across_walls;
use std::f64::consts::TAU;

/// Number of coefficients: of `1, s^2, s^4` for the velocity, and of `1, s^2, d^2, s^2 d^2` for the rates of strain
/// along x and y.
const OF_VELOCITY: usize = 3;
const OF_STRAIN: usize = 4;
type DriftValues = [f64; OF_VELOCITY + 2 * OF_STRAIN];

/// Step of the table in the logarithm of the distance: cubic interpolation is accurate to about 1e-5.
const STEP: f64 = 0.03;

/// Exponent from which on an image is negligible, `exp(-DECAYED)`; bounds the wavenumbers, and the distances by the
/// longest wave.
const DECAYED: f64 = 34.0;

/// Width of the transition between long waves, which are summed, and short waves, which are integrated, in units of
/// the inverse of the shorter edge along the walls: the integral differs from the sum by `exp(-SMOOTH^2/4)`. The
/// transition spans `SHARP` widths on either side.
const SMOOTH: f64 = 10.0;
const SHARP: f64 = 4.0;

/// Divergence of the mobility for the spheres of a plan's box.
pub(crate) struct WallDrift {
    /// Logarithm of the least distance from a wall.
    first: f64,
    /// Distance between two walls; none with one wall.
    height: Option<f64>,
    inverse_viscosity: f64,
    values: Vec<DriftValues>,
}

impl WallDrift {
    /// For the spheres of a plan with walls.
    pub fn new(plan: &Plan) -> Self {
        let (walls, edges) = (plan.boundaries.walls(), plan.edges);
        let height = (walls == 2).then_some(edges.z);
        let first = NEAREST_WALL * plan.extremes().0;
        let longest = DECAYED * edges.x.max(edges.y) / (2.0 * TAU);
        let farthest = height.map_or(longest, |height| (0.5 * height).min(longest));
        // A cubic between two distances also passes through the next two.
        let count = 4 + ((farthest / first).ln() / STEP).max(0.0) as usize;
        let first = first.ln() - STEP;
        let at = |number: usize| values(walls, edges, (first + STEP * number as f64).exp());
        let values = (0..count).into_par_iter().map(at).measured().collect();
        Self { first, height, inverse_viscosity: 1.0 / plan.viscosity, values }
    }

    /// Divergence of the mobility from forces to the velocity and the rate of strain of a sphere at height `z`.
    pub fn at(&self, z: f64, radius: f64) -> (Vector, Traceless) {
        let is_above = |height: f64| z > 0.5 * height;
        let (distance, sign) = match self.height {
            Some(height) if is_above(height) => (height - z, -1.0),
            _ => (z, 1.0),
        };
        let Envelope { monopole, dipole } = Envelope::of_sphere(radius);
        let [s, d] = [monopole * monopole, dipole * dipole];
        let values = self.interpolated(distance.max(NEAREST_WALL * radius));
        let (of_velocity, of_strain) = values.split_at(OF_VELOCITY);
        let velocity = of_velocity[0] + s * (of_velocity[1] + s * of_velocity[2]);
        let strain = |of: &[f64]| of[0] + s * of[1] + d * (of[2] + s * of[3]);
        let [xx, yy] = [strain(&of_strain[..OF_STRAIN]), strain(&of_strain[OF_STRAIN..])];
        let strain_rate = Traceless([xx, 0.0, 0.0, yy, 0.0]);
        (Vector::Z * (sign * velocity * self.inverse_viscosity), strain_rate * self.inverse_viscosity)
    }

    /// Cubic interpolation in the logarithm of the distance; zero beyond the table.
    fn interpolated(&self, distance: f64) -> DriftValues {
        let place = (distance.ln() - self.first) / STEP;
        let before = (place as usize).max(1);
        let x = place - before as f64;
        let weights = [
            -x * (x - 1.0) * (x - 2.0) / 6.0,
            (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0,
            (x + 1.0) * x * (x - 1.0) / 6.0,
        ];
        let mut sum = DriftValues::default();
        for (number, weight) in (before - 1..).zip(weights) {
            let values = self.values.get(number).copied().unwrap_or_default();
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }
}

/// Coefficients at a distance from the lower wall, for viscosity 1.
///
/// A sum over wavevectors equals the integral over them if the summand is smooth over several of them: the long waves
/// are summed, and the short ones, separated by a smooth transition, integrated.
fn values(walls: usize, edges: Vector, z: f64) -> DriftValues {
    // For one wall the height does not matter.
    let height = if walls == 2 { edges.z } else { 2.0 * z };
    let (width, shortest) = (SMOOTH / edges.x.min(edges.y), 0.5 * DECAYED / z);
    let middle = SHARP * width;
    let summed = |k: f64| 0.5 * libm::erfc((k - middle) / width);
    let mut sum = DriftValues::default();
    // Adds a wavenumber with its weight, and the fractions of its square in the components along x and y.
    let mut add = |k: f64, weight: f64, parts: [f64; 2]| {
        let (of_velocity, of_strain) = of_wave(walls, height, k, z);
        let (velocity, strains) = sum.split_at_mut(OF_VELOCITY);
        velocity.iter_mut().zip(of_velocity).for_each(|(sum, value)| *sum += weight * value);
        for (strain, part) in strains.chunks_exact_mut(OF_STRAIN).zip(parts) {
            strain.iter_mut().zip(of_strain).for_each(|(sum, value)| *sum -= part * weight * value);
        }
    };
    let [x, y] = [TAU / edges.x, TAU / edges.y];
    let longest = shortest.min(middle + SHARP * width);
    for m in 0..=(longest / x) as usize {
        for n in usize::from(m == 0)..=(longest / y) as usize {
            let components = [x * m as f64, y * n as f64];
            let k = components[0].hypot(components[1]);
            // Number of distinct wavevectors among the four with these lengths of components.
            let count = [m, n].map(|number| if number == 0 { 1.0 } else { 2.0 });
            let weight = summed(k) * count[0] * count[1] / (edges.x * edges.y);
            add(k, weight, components.map(|component| (component / k).powi(2)));
        }
    }
    let step = 0.25 * width;
    for number in 0..(shortest / step) as usize {
        let k = step * (number as f64 + 0.5);
        add(k, (1.0 - summed(k)) * k * step / TAU, [0.5; 2]);
    }
    sum
}

/// Coefficients of one wavenumber.
fn of_wave(walls: usize, height: f64, k: f64, z: f64) -> ([f64; OF_VELOCITY], [f64; OF_STRAIN]) {
    let kernel = across_walls(walls, height, k);
    let (below, above) = ((-k * z).exp(), (-k * (height - z)).exp());
    // Functions for points, minus the part proportional to a squared width, with their first and second derivatives.
    let [b, t] = [k * z, k * (height - z)];
    let of_point = [
        [below, b * below, above, t * above],
        [-below, (1.0 - b) * below, above, (t - 1.0) * above],
        [below, (b - 2.0) * below, above, (t - 2.0) * above],
    ];
    let square = k * k;
    let of_square = [
        [0.0, square * below, 0.0, square * above],
        [0.0, -square * below, 0.0, square * above],
        [0.0, square * below, 0.0, square * above],
    ];
    let by_kernel = |f: &[f64; 4], g: &[f64; 4]| -> f64 {
        (0..4).flat_map(|p| (0..4).map(move |q| (p, q))).map(|(p, q)| kernel[p][q] * f[p] * g[q]).sum()
    };
    let ([f, f1, f2], [g, g1, g2]) = (&of_point, &of_square);
    let once = |f: &[f64; 4], g: &[f64; 4]| 2.0 * k * by_kernel(f, g);
    let of_velocity = [once(f1, f), -(once(f1, g) + once(g1, f)), once(g1, g)];
    let twice = |second: &[f64; 4], first: &[f64; 4], other: &[f64; 4], other_first: &[f64; 4]| {
        square * (by_kernel(second, other) + by_kernel(first, other_first))
    };
    let of_strain = [twice(f2, f1, f, f1), -twice(f2, f1, g, g1), -twice(g2, g1, f, f1), twice(g2, g1, g, g1)];
    (of_velocity, of_strain)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far from its periodic copies a sphere above a wall has the mobility
    /// `1/pi [-3/16 z^-1 + s^2/4 z^-3 - 3/16 s^4 z^-5]` in addition to that of an isolated one; these are its
    /// derivatives.
    #[test]
    fn in_a_large_box_velocities_are_those_in_closed_form() {
        for z in [0.9, 1.3, 3.0, 8.0] {
            let found = values(1, Vector::new(2000.0, 3000.0, 10.0), z);
            let exact = [3.0 / 16.0 * z.powi(-2), -0.75 * z.powi(-4), 15.0 / 16.0 * z.powi(-6)];
            for (found, exact) in found.iter().zip(exact.map(|value| value / std::f64::consts::PI)) {
                assert!((found / exact - 1.0).abs() < 1e-5, "{found} is not {exact} at {z}");
            }
            // Incompressibility: the strain across the wall is balanced equally along both axes in its plane.
            for k in OF_VELOCITY..OF_VELOCITY + OF_STRAIN {
                assert!((found[k] / found[k + OF_STRAIN] - 1.0).abs() < 1e-5);
            }
        }
    }

    /// In a box of any size the result is the plain sum over wavevectors, wherever the transition lies.
    #[test]
    fn sums_and_integrals_are_one() {
        let (edges, z): (Vector, f64) = (Vector::new(30.0, 18.0, 9.0), 1.2);
        let found = values(2, edges, z);
        let (mut sum, [x, y]) = ([0.0; OF_VELOCITY], [TAU / edges.x, TAU / edges.y]);
        for (m, n) in (-80..=80).flat_map(|m| (-50..=50).map(move |n| (f64::from(m), f64::from(n)))) {
            let k = (m * x).hypot(n * y);
            if k > 0.0 {
                let (of_velocity, _) = of_wave(2, edges.z, k, z);
                sum.iter_mut().zip(of_velocity).for_each(|(sum, value)| *sum += value / (edges.x * edges.y));
            }
        }
        for (found, sum) in found.iter().zip(sum) {
            assert!((found / sum - 1.0).abs() < 1e-6, "{found} is not {sum}");
        }
    }
}
