//! Numbers of twice the precision of `f64` (about 31 digits), as an unevaluated sum of two.
//!
//! Error-free sums and products of Dekker (1971) and Knuth. All operations are inlined, so that they have the fused
//! instructions of [`simd::vectorised`] code.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// `high + low`, with `|low|` at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// Pi to 31 digits.
    pub fn pi() -> Self {
        Self { high: std::f64::consts::PI, low: 1.2246467991473532e-16 }
    }

    /// The nearest `f64`.
    #[inline(always)]
    pub fn value(self) -> f64 {
        self.high
    }

    /// Square root of a positive number, by one Newton step from that of `f64`.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        let root = Self::from(self.high.sqrt());
        root + (self - root * root) / (root + root)
    }

    /// Normalises a sum with `|high| >= |low|`.
    #[inline(always)]
    fn fast(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }
}

impl From<f64> for DoubleDouble {
    #[inline(always)]
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = self.high + other.high;
        let part = sum - self.high;
        let error = (self.high - (sum - part)) + (other.high - part);
        Self::fast(sum, error + (self.low + other.low))
    }
}

impl AddAssign for DoubleDouble {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = self.high.mul_add(other.high, -product);
        Self::fast(product, error + (self.high * other.low + self.low * other.high))
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        let product = self.high * other;
        let error = self.high.mul_add(other, -product);
        Self::fast(product, error + self.low * other)
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * first;
        let second = rest.high / other.high;
        let rest = rest - other * second;
        Self::fast(first, second) + Self::from(rest.high / other.high)
    }
}
