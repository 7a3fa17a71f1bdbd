//! Chebyshev interpolation of several functions at once.

use std::f64::consts::PI;

/// Highest degree of an interpolant.
const DEGREE: usize = 13;

/// Values at the nodes of an interval.
pub type Samples<const LANES: usize> = [[f64; LANES]; DEGREE + 1];

/// `LANES` functions on one interval, as Chebyshev series.
#[derive(Debug, Clone)]
pub struct Chebyshev<const LANES: usize> {
    middle: f64,
    half: f64,
    coefficients: Box<Samples<LANES>>,
}

impl<const LANES: usize> Chebyshev<LANES> {
    /// Points where `through` needs the functions.
    pub fn nodes(from: f64, to: f64) -> [f64; DEGREE + 1] {
        std::array::from_fn(|j| 0.5 * (from + to) + 0.5 * (to - from) * angle(j).cos())
    }

    /// The interpolant through values at `nodes(from, to)`.
    pub fn through(from: f64, to: f64, values: &Samples<LANES>) -> Self {
        let coefficient = |k: usize| {
            let scale = if k == 0 { 1.0 } else { 2.0 } / (DEGREE + 1) as f64;
            let mut sum = [0.0; LANES];
            for (j, value) in values.iter().enumerate() {
                let weight = scale * (k as f64 * angle(j)).cos();
                sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
            }
            sum
        };
        Self {
            middle: 0.5 * (from + to),
            half: 0.5 * (to - from),
            coefficients: Box::new(std::array::from_fn(coefficient)),
        }
    }

    /// Values at `x`, by Clenshaw's recurrence. Inlined, to be compiled for the vectors of its caller.
    #[inline(always)]
    pub fn at(&self, x: f64) -> [f64; LANES] {
        let x = (x - self.middle) / self.half;
        let (mut sum, mut next) = ([0.0; LANES], [0.0; LANES]);
        for line in self.coefficients[1..].iter().rev() {
            for i in 0..LANES {
                (sum[i], next[i]) = (2.0 * x * sum[i] - next[i] + line[i], sum[i]);
            }
        }
        for i in 0..LANES {
            sum[i] = x * sum[i] - next[i] + self.coefficients[0][i];
        }
        sum
    }
}

fn angle(j: usize) -> f64 {
    PI * (j as f64 + 0.5) / (DEGREE + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_polynomials_and_converges_for_an_exponential() {
        let functions = |x: f64| [x.powi(13) - x, (x + 1.0).exp()];
        let nodes = Chebyshev::<2>::nodes(-2.0, 3.0);
        let fit = Chebyshev::through(-2.0, 3.0, &nodes.map(functions));
        for x in [-2.0, -0.3, 1.7, 3.0] {
            let (found, exact) = (fit.at(x), functions(x));
            // Round-off of 3^13 in the first; the first neglected term, 2.5^14/14!/2^13, in the second.
            assert!((found[0] - exact[0]).abs() < 1e-8);
            assert!((found[1] - exact[1]).abs() < 1e-8);
        }
    }
}
