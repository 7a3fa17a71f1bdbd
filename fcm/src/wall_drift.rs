//! The divergence of the mobility near walls: how the motion of a sphere by a force across them changes with its distance.
//!
//! What a force drives at another sphere has no divergence in the place of the force, walls or not: the fluid is incompressible, and
//! its mobility symmetric. What is left are the images of a sphere in itself, as both it and they move. With the flow
//! `sum_pq K_pq f_p(z) f_q(z')` of a wavevector `(k_x, k_y)` along the walls, and envelopes of widths `s` and `d` of forces and dipoles,
//!
//! ```text
//! div V   = 1/(mu A) sum_k sum_pq K_pq d/dz [f_p(z; s) f_q(z; s)]
//! div E_c = 1/(mu A) sum_k e_c sum_pq K_pq d/dz [f_p'(z; d) f_q(z; s)],    e_zz = 1,  e_xx = -k_x^2/k^2,  e_yy = -k_y^2/k^2
//! ```
//!
//! over the wavevectors of a box of area `A`. An envelope acts on the functions as `1 + (s^2/2) lap`, so that all are polynomials
//! in squares of widths: their coefficients are tabulated, and do for any radius.

use crate::bounded::NEAREST_WALL;
use crate::envelope::Envelope;
use crate::plan::Plan;
use domain::{Traceless, Vector};
use rayon::prelude::*;
use solver::across_walls;
use std::f64::consts::TAU;

/// Coefficients of `1, s^2, s^4` of the velocity, and of `1, s^2, d^2, s^2 d^2` of the rates of strain along x and y.
const OF_VELOCITY: usize = 3;
const OF_STRAIN: usize = 4;
type Values = [f64; OF_VELOCITY + 2 * OF_STRAIN];

/// From one distance of the table to the next, in its logarithm: cubics in that are within some 1e-5.
const STEP: f64 = 0.03;

/// Waves whose image is smaller by `exp(-DECAYED)` do not count, nor do distances from which the longest is.
const DECAYED: f64 = 34.0;

/// The width of what tells long waves from short ones, in wavenumbers over the shorter edge along the walls: what an integral leaves out
/// of a sum is `exp(-SMOOTH^2/4)`. That is told in so many widths before and behind.
const SMOOTH: f64 = 10.0;
const SHARP: f64 = 4.0;

/// What moves spheres of a plan's box near its walls.
pub(crate) struct WallDrift {
    /// The logarithm of the least distance from a wall.
    first: f64,
    /// The distance of a second wall.
    height: Option<f64>,
    inverse_viscosity: f64,
    values: Vec<Values>,
}

impl WallDrift {
    /// That of the spheres of a plan with walls.
    pub fn new(plan: &Plan) -> Self {
        let (walls, edges) = (plan.boundaries.walls(), plan.edges);
        let height = (walls == 2).then_some(edges.z);
        let first = NEAREST_WALL * plan.extremes().0;
        let longest = DECAYED * edges.x.max(edges.y) / (2.0 * TAU);
        let farthest = height.map_or(longest, |height| (0.5 * height).min(longest));
        // Cubics between two distances go through the next two as well.
        let count = 4 + ((farthest / first).ln() / STEP).max(0.0) as usize;
        let first = first.ln() - STEP;
        let at = |number: usize| values((walls, edges), (first + STEP * number as f64).exp());
        let values = (0..count).into_par_iter().map(at).collect();
        Self { first, height, inverse_viscosity: 1.0 / plan.viscosity, values }
    }

    /// The divergence of the mobility from forces to the velocity and the rate of strain of a sphere at this height.
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

    /// By cubics in the logarithm of the distance; nothing beyond the table.
    fn interpolated(&self, distance: f64) -> Values {
        let place = (distance.ln() - self.first) / STEP;
        let before = (place as usize).max(1);
        let x = place - before as f64;
        let weights = [
            -x * (x - 1.0) * (x - 2.0) / 6.0,
            (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0,
            (x + 1.0) * x * (x - 1.0) / 6.0,
        ];
        let mut sum = Values::default();
        for (number, weight) in (before - 1..).zip(weights) {
            let values = self.values.get(number).copied().unwrap_or_default();
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        }
        sum
    }
}

/// The coefficients at a distance from the lower wall, for the viscosity 1.
///
/// A sum over wavevectors is the integral over them where what is summed is smooth over several: the long waves are summed, and the
/// short ones, from which these are told apart smoothly, integrated.
fn values((walls, edges): (usize, Vector), z: f64) -> Values {
    // One wall alone knows of no height.
    let height = if walls == 2 { edges.z } else { 2.0 * z };
    let (width, shortest) = (SMOOTH / edges.x.min(edges.y), 0.5 * DECAYED / z);
    let middle = SHARP * width;
    let summed = |k: f64| 0.5 * libm::erfc((k - middle) / width);
    let mut sum = Values::default();
    // A wavenumber, with its weight and the parts of its square that are those of the components along x and y.
    let mut add = |k: f64, weight: f64, parts: [f64; 2]| {
        let (of_velocity, of_strain) = of_wave((walls, height), k, z);
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
            // As many of the four wavevectors with these lengths of components as differ.
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

/// The coefficients of one wavenumber.
fn of_wave((walls, height): (usize, f64), k: f64, z: f64) -> ([f64; OF_VELOCITY], [f64; OF_STRAIN]) {
    let kernel = across_walls(walls, height, k);
    let (below, above) = ((-k * z).exp(), (-k * (height - z)).exp());
    // The functions for points, less what the square of a width takes away, with their first and second derivatives.
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

    /// Far from its copies a sphere above a wall has `1/pi [-3/16 z^-1 + s^2/4 z^-3 - 3/16 s^4 z^-5]` besides the mobility of one
    /// alone, of which these are the derivatives.
    #[test]
    fn in_a_large_box_velocities_are_those_in_closed_form() {
        for z in [0.9, 1.3, 3.0, 8.0] {
            let found = values((1, Vector::new(2000.0, 3000.0, 10.0)), z);
            let exact = [3.0 / 16.0 * z.powi(-2), -0.75 * z.powi(-4), 15.0 / 16.0 * z.powi(-6)];
            for (found, exact) in found.iter().zip(exact.map(|value| value / std::f64::consts::PI)) {
                assert!((found / exact - 1.0).abs() < 1e-5, "{found} is not {exact} at {z}");
            }
            // What is stretched across the wall is not along it, alike on both axes.
            for k in OF_VELOCITY..OF_VELOCITY + OF_STRAIN {
                assert!((found[k] / found[k + OF_STRAIN] - 1.0).abs() < 1e-5);
            }
        }
    }

    /// Long waves and short ones are told apart wherever: in a box of any size the sum over wavevectors itself is the same.
    #[test]
    fn sums_and_integrals_are_one() {
        let (edges, z): (Vector, f64) = (Vector::new(30.0, 18.0, 9.0), 1.2);
        let found = values((2, edges), z);
        let (mut sum, [x, y]) = ([0.0; OF_VELOCITY], [TAU / edges.x, TAU / edges.y]);
        for (m, n) in (-80..=80).flat_map(|m| (-50..=50).map(move |n| (f64::from(m), f64::from(n)))) {
            let k = (m * x).hypot(n * y);
            if k > 0.0 {
                let (of_velocity, _) = of_wave((2, edges.z), k, z);
                sum.iter_mut().zip(of_velocity).for_each(|(sum, value)| *sum += value / (edges.x * edges.y));
            }
        }
        for (found, sum) in found.iter().zip(sum) {
            assert!((found / sum - 1.0).abs() < 1e-6, "{found} is not {sum}");
        }
    }
}
