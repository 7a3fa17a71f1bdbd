//! Fields of moments by plain sums over wavevectors, without grid or splitting, in any lattice.

use domain::{PeriodicBox, Random, Tensor, Vector, random_packing};
use std::f64::consts::{PI, TAU};

/// The sum ends where `exp(-k^2 s^2)` of the smallest envelope is `exp(-34)`, 2e-15.
const EXPONENT: f64 = 34.0;

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
        fields
    }

    /// Energy `m . K m / 2`.
    pub fn energy(&self) -> f64 {
        let of_one = |k: Vector| {
            let (_, [re, im]) = self.mode(k);
            (re * re + im * im) / k.length_squared()
        };
        self.wavevectors().into_iter().map(of_one).sum::<f64>() / self.volume()
    }

    /// The same moments at positions and in a lattice deformed by `x -> x + e x`.
    #[must_use]
    pub fn deformed(&self, e: Tensor) -> Self {
        let positions = self.positions.iter().map(|&x| x + e * x).collect();
        Self { lattice: self.lattice.map(|a| a + e * a), positions, ..self.clone() }
    }
}

fn width(radius: f64) -> f64 {
    radius / (6.0 * PI.sqrt()).cbrt()
}
