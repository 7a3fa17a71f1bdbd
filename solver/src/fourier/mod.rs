//! Fourier transforms of many rows at once: a vector's lanes hold the same element of neighbouring rows.

mod any_length;
mod butterfly;
mod columns;
mod gathered;
mod rows;

pub(crate) use any_length::AnyLength;
pub(crate) use columns::StridedPointer;
pub(crate) use rows::RowPlan;

use crate::Real;
use num_complex::Complex;

/// Direction of a transform: the sign of the exponent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    /// `exp(-i k x)`, to coefficients.
    Forward,
    /// `exp(+i k x)`, to values.
    Backward,
}

/// `exp(-2 pi i numerator / denominator)`, accurate to a unit or two in the last place.
fn root_of_unity<T: Real>(numerator: usize, denominator: usize) -> Complex<T> {
    // The angle in eighths of a turn keeps sines and cosines accurate, and symmetries exact.
    let eighths = 8 * (numerator % denominator);
    let (octant, rest) = (eighths / denominator, eighths % denominator);
    let within = |part: usize| std::f64::consts::FRAC_PI_4 * part as f64 / denominator as f64;
    let (low, high) = (within(rest).sin_cos(), within(denominator - rest).sin_cos());
    let (sine, cosine) = match octant {
        0 => (low.0, low.1),
        1 => (high.1, high.0),
        2 => (low.1, -low.0),
        3 => (high.0, -high.1),
        4 => (-low.0, -low.1),
        5 => (-high.1, -high.0),
        6 => (-low.1, low.0),
        _ => (-high.0, high.1),
    };
    Complex::new(T::from_f64(cosine), T::from_f64(-sine))
}

/// Whether a number is a product of some of the given primes.
pub(crate) fn is_product_of(primes: &[usize], mut number: usize) -> bool {
    for prime in primes {
        while number > 0 && number.is_multiple_of(*prime) {
            number /= prime;
        }
    }
    number == 1
}

#[cfg(test)]
pub(crate) mod tests;
