//! Fields of moments by plain sums over wavevectors and over near pairs, without grid or splitting, in any lattice.
//!
//! Spheres have Gaussian envelopes in the sum over wavevectors. Pairs are points, for which the difference is added.

use domain::{PeriodicBox, Random, Tensor, Vector, random_packing};
use std::f64::consts::{PI, TAU};

/// The sum ends where `exp(-k^2 s^2)` of the smallest envelope is `exp(-34)`, 2e-15.
const EXPONENT: f64 = 34.0;

/// Periodic images of near pairs in each direction.
const IMAGES: i32 = 3;

/// Spheres with moments in a lattice.
#[derive(Debug, Clone)]
pub struct MagnetisedSpheres {
    pub lattice: [Vector; 3],
    pub positions: Vec<Vector>,
    pub radii: Vec<f64>,
    pub moments: Vec<Vector>,
}

impl MagnetisedSpheres {
    /// `count` spheres of radii 1 and `ratio` alternately, at random positions with random moments of the size `a^3`.
    pub fn random(count: usize, ratio: f64, cell: &PeriodicBox, seed: u64) -> Self {
        let radii: Vec<f64> = (0..count).map(|i| if i.is_multiple_of(2) { 1.0 } else { ratio }).collect();
        let positions = random_packing(cell, &radii, 0.0, seed).unwrap();
        let mut random = Random::new(seed, 0xD1);
        let moments = radii.iter().map(|a| (random.point() - Vector::splat(0.5)) * (2.0 * a.powi(3))).collect();
        Self { lattice: cell.lattice_vectors(), positions, radii, moments }
    }

    fn volume(&self) -> f64 {
        let [a, b, c] = self.lattice;
        a.dot(b.cross(c)).abs()
    }

    /// One of each pair of opposite wavevectors, up to where the envelopes vanish.
    fn wavevectors(&self) -> Vec<Vector> {
        let smallest = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = EXPONENT.sqrt() / width(smallest);
        let [a, b, c] = self.lattice;
        let reciprocal = [b.cross(c), c.cross(a), a.cross(b)].map(|normal| normal * (TAU / a.dot(b.cross(c))));
        let [x, y, z] = self.lattice.map(|vector| (largest * vector.length() / TAU) as i32);
        let half = (0..=x).flat_map(|i| (-y..=y).flat_map(move |j| (-z..=z).map(move |k| [i, j, k])));
        let all = half.filter(|&[i, j, k]| i > 0 || j > 0 || (j == 0 && k > 0));
        let vector = |[i, j, k]: [i32; 3]| {
            reciprocal[0] * f64::from(i) + reciprocal[1] * f64::from(j) + reciprocal[2] * f64::from(k)
        };
        all.map(vector).filter(|k| k.length_squared() <= largest * largest).collect()
    }

    /// Real and imaginary parts of `exp(-i k.x - k^2 s^2 / 2)` of each sphere, and those of the sum of `k.m` times it.
    fn mode(&self, k: Vector) -> (Vec<[f64; 2]>, [f64; 2]) {
        let mut sum = [0.0; 2];
        let of_one = |row: usize| {
            let (sin, cos) = k.dot(self.positions[row]).sin_cos();
            let envelope = (-0.5 * k.length_squared() * width(self.radii[row]).powi(2)).exp();
            [cos * envelope, -sin * envelope]
        };
        let factors: Vec<[f64; 2]> = (0..self.radii.len()).map(of_one).collect();
        for (factor, moment) in factors.iter().zip(&self.moments) {
            let along = k.dot(*moment);
            sum = [sum[0] + along * factor[0], sum[1] + along * factor[1]];
        }
        (factors, sum)
    }

    /// Fields `-K m` at the spheres, and their gradients.
    pub fn fields(&self) -> Vec<(Vector, Tensor)> {
        let mut fields = vec![(Vector::ZERO, Tensor::ZERO); self.radii.len()];
        for k in self.wavevectors() {
            let (factors, [re, im]) = self.mode(k);
            let scale = -2.0 / (self.volume() * k.length_squared());
            for ([c, s], (field, gradient)) in factors.iter().zip(&mut fields) {
                // Of q exp(+i k.x) = (re + i im) (c - i s), and of i k times it.
                *field += k * (scale * (re * c + im * s));
                let slope = k * (-scale * (im * c - re * s));
                *gradient += Tensor::from_cols(slope * k.x, slope * k.y, slope * k.z);
            }
        }
        self.add_pairs(&mut fields);
        fields
    }

    /// Energy `m . K m / 2`.
    pub fn energy(&self) -> f64 {
        let of_one = |k: Vector| {
            let (_, [re, im]) = self.mode(k);
            (re * re + im * im) / k.length_squared()
        };
        let mut of_pairs = vec![(Vector::ZERO, Tensor::ZERO); self.radii.len()];
        self.add_pairs(&mut of_pairs);
        let of_pairs: f64 = self.moments.iter().zip(&of_pairs).map(|(moment, pairs)| moment.dot(pairs.0)).sum();
        self.wavevectors().into_iter().map(of_one).sum::<f64>() / self.volume() - 0.5 * of_pairs
    }

    /// Adds the fields of points minus those of Gaussians, from other spheres and from periodic images.
    fn add_pairs(&self, fields: &mut [(Vector, Tensor)]) {
        let [a, b, c] = self.lattice;
        let steps = || (-IMAGES..=IMAGES).map(f64::from);
        let images =
            || steps().flat_map(move |i| steps().flat_map(move |j| steps().map(move |k| a * i + b * j + c * k)));
        for (row, (field, gradient)) in fields.iter_mut().enumerate() {
            for (other, image) in (0..self.radii.len()).flat_map(|other| images().map(move |image| (other, image))) {
                let x = self.positions[row] - self.positions[other] - image;
                let width = width(self.radii[row]).hypot(width(self.radii[other]));
                if x.length() > 0.0 && x.length() < (2.0 * EXPONENT).sqrt() * width {
                    let (more, slope) = of_pair(x, width, self.moments[other]);
                    *field += more;
                    *gradient += slope;
                }
            }
        }
    }

    /// The same moments at positions and in a lattice deformed by `x -> x + e x`.
    #[must_use]
    pub fn deformed(&self, e: Tensor) -> Self {
        let positions = self.positions.iter().map(|&x| x + e * x).collect();
        Self { lattice: self.lattice.map(|a| a + e * a), positions, ..self.clone() }
    }
}

/// Field and gradient of a moment at a distance, for a potential of `erfc(r / (2^(1/2) s)) / (4 pi r)`.
fn of_pair(x: Vector, s: f64, moment: Vector) -> (Vector, Tensor) {
    let (r, square) = (x.length(), s * s);
    let gaussian = (2.0 / PI).sqrt() / s * (-0.5 * (r / s).powi(2)).exp();
    let both = gaussian * r + libm::erfc(r / (2.0_f64.sqrt() * s));
    let first = -both / (4.0 * PI * r.powi(3));
    let second = (gaussian / (square * r * r) + 3.0 * both / r.powi(5)) / (4.0 * PI);
    let third = -(gaussian / (square * square * r) + 5.0 * gaussian / (square * r.powi(3)) + 15.0 * both / r.powi(6))
        / (4.0 * PI * r);
    let along = x.dot(moment);
    let column = |c: usize| {
        let delta = Vector::AXES[c] * along;
        (moment * x[c] + x * moment[c] + delta) * second + x * (third * x[c] * along)
    };
    (moment * first + x * (second * along), Tensor::from_cols(column(0), column(1), column(2)))
}

fn width(radius: f64) -> f64 {
    radius / (6.0 * PI.sqrt()).cbrt()
}
