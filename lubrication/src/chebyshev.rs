//! Chebyshev interpolation of several functions at once.

use std::f64::consts::PI;

use crate::arithmetic::Arithmetic;

/// Values at the nodes of an interval.
pub type Samples<const LANES: usize, const NODES: usize> = [[f64; LANES]; NODES];

/// `LANES` functions on one interval, as Chebyshev series.
#[derive(Debug, Clone)]
pub struct Chebyshev<const LANES: usize, const NODES: usize> {
    middle: f64,
    half: f64,
    coefficients: Box<Samples<LANES, NODES>>,
}

impl<const LANES: usize, const NODES: usize> Chebyshev<LANES, NODES> {
    /// Nodes at which `through` needs the functions.
    pub fn nodes(from: f64, to: f64) -> [f64; NODES] {
        std::array::from_fn(|j| 0.5 * (from + to) + 0.5 * (to - from) * angle(j, NODES).cos())
    }

    /// Interpolant through values at `nodes(from, to)`.
    pub fn through(from: f64, to: f64, values: &Samples<LANES, NODES>) -> Self {
        let coefficient = |k: usize| {
            let scale = if k == 0 { 1.0 } else { 2.0 } / NODES as f64;
            let mut sum = [0.0; LANES];
            for (j, value) in values.iter().enumerate() {
                let weight = scale * (k as f64 * angle(j, NODES)).cos();
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

    /// Derivatives of the functions, on the same interval.
    #[must_use]
    pub fn derivative(&self) -> Self {
        let mut coefficients = Box::new([[0.0; LANES]; NODES]);
        for k in (1..NODES).rev() {
            for lane in 0..LANES {
                let beyond = coefficients.get(k + 1).map_or(0.0, |line| line[lane]);
                coefficients[k - 1][lane] = beyond + 2.0 * k as f64 * self.coefficients[k][lane] / self.half;
            }
        }
        coefficients[0].iter_mut().for_each(|c| *c *= 0.5);
        Self { coefficients, ..*self }
    }

    /// Values at `x`, by Clenshaw's recurrence.
    pub fn at(&self, x: f64) -> [f64; LANES] {
        let x = (x - self.middle) / self.half;
        let (mut sum, mut next) = (&mut [0.0; LANES], &mut [0.0; LANES]);
        for line in self.coefficients[1..].iter().rev() {
            for ((next, sum), c) in next.iter_mut().zip(sum.iter()).zip(line) {
                *next = 2.0 * x * sum - *next + c;
            }
            std::mem::swap(&mut sum, &mut next);
        }
        std::array::from_fn(|i| x * sum[i] - next[i] + self.coefficients[0][i])
    }
}

fn angle(j: usize, nodes: usize) -> f64 {
    PI * (j as f64 + 0.5) / nodes as f64
}

/// The same functions as power series in the distance from the middle over half the interval, for few nodes: terms
/// may be `2.4^NODES` times larger than the sum. Evaluated with numbers of any width.
#[derive(Debug, Clone)]
pub struct Powers<const LANES: usize, const NODES: usize> {
    middle: f64,
    over_half: f64,
    coefficients: Box<Samples<LANES, NODES>>,
}

impl<const LANES: usize, const NODES: usize> Powers<LANES, NODES> {
    /// Writes the values at `x`, by Horner's rule for `TOGETHER` vectors of functions at once; the number of
    /// functions is a multiple of their total width.
    #[inline(always)]
    pub fn write<X: Arithmetic, const TOGETHER: usize>(&self, x: f64, values: &mut [f64; LANES]) {
        const { assert!(LANES.is_multiple_of(TOGETHER * X::WIDTH)) };
        let x = X::constant((x - self.middle) * self.over_half);
        let mut first = 0;
        while first < LANES {
            let mut sums = [X::constant(0.0); TOGETHER];
            for line in self.coefficients.iter().rev() {
                for k in 0..TOGETHER {
                    sums[k] = X::read(&line[first + k * X::WIDTH..]).plus(sums[k], x);
                }
            }
            for k in 0..TOGETHER {
                sums[k].write(&mut values[first + k * X::WIDTH..]);
            }
            first += TOGETHER * X::WIDTH;
        }
    }

    /// Coefficients of the powers of `x` itself, on an interval about 0.
    pub fn rows(&self) -> Samples<LANES, NODES> {
        debug_assert!(self.middle == 0.0, "the interval is about {}", self.middle);
        let power = |k: usize| self.over_half.powi(k as i32);
        std::array::from_fn(|k| self.coefficients[k].map(|coefficient| coefficient * power(k)))
    }
}

impl<const LANES: usize, const NODES: usize> From<&Chebyshev<LANES, NODES>> for Powers<LANES, NODES> {
    fn from(series: &Chebyshev<LANES, NODES>) -> Self {
        let mut coefficients = Box::new([[0.0; LANES]; NODES]);
        // Polynomials of two consecutive degrees, by powers: T_0, with T_-1 = T_1.
        let (mut last, mut now) = ([0.0; NODES], [0.0; NODES]);
        (last[1], now[0]) = (1.0, 1.0);
        for line in series.coefficients.iter() {
            for (sums, power) in coefficients.iter_mut().zip(now) {
                sums.iter_mut().zip(line).for_each(|(sum, c)| *sum += power * c);
            }
            let next = std::array::from_fn(|j| if j == 0 { 0.0 } else { 2.0 * now[j - 1] } - last[j]);
            (last, now) = (now, next);
        }
        Self { middle: series.middle, over_half: 1.0 / series.half, coefficients }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_polynomials_and_converges_for_an_exponential() {
        let functions = |x: f64| [x.powi(13) - x, (x + 1.0).exp()];
        let nodes = Chebyshev::<2, 14>::nodes(-2.0, 3.0);
        let fit = Chebyshev::through(-2.0, 3.0, &nodes.map(functions));
        for x in [-2.0, -0.3, 1.7, 3.0] {
            let (found, exact) = (fit.at(x), functions(x));
            // Round-off of 3^13 in the first; the first neglected term, 2.5^14/14!/2^13, in the second.
            assert!((found[0] - exact[0]).abs() < 1e-8);
            assert!((found[1] - exact[1]).abs() < 1e-8);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_functions() {
        let fit = Chebyshev::<2, 14>::through(
            -2.0,
            3.0,
            &Chebyshev::<2, 14>::nodes(-2.0, 3.0).map(|x| [x.powi(5) - x, x.exp()]),
        );
        for x in [-2.0, -0.3, 1.7, 3.0] {
            let (found, exact) = (fit.derivative().at(x), [5.0 * x.powi(4) - 1.0, x.exp()]);
            // Of the exponential, the derivative of the first neglected term, which is 14 times larger.
            assert!((found[0] - exact[0]).abs() < 1e-10 && (found[1] - exact[1]).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn powers_are_the_same_functions() {
        let functions = |x: f64| [x.powi(7) - x, (x + 1.0).exp(), 1.0, x.sin(), 0.0];
        let series = Chebyshev::<5, 8>::through(-2.0, 3.0, &Chebyshev::<5, 8>::nodes(-2.0, 3.0).map(functions));
        for x in [-2.0, -0.3, 1.7, 3.0] {
            let (mut found, expected) = ([0.0; 5], series.at(x));
            Powers::from(&series).write::<f64, 5>(x, &mut found);
            for k in 0..5 {
                assert!((found[k] - expected[k]).abs() <= 1e-14 * 3e3, "{k} at {x}: {} {}", found[k], expected[k]);
            }
        }
    }
}
