//! Functions of one variable with their first two derivatives (forward differentiation), exact to round-off.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// `[f, f', f'']` at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet(pub [f64; 3]);

impl Jet {
    /// The variable itself.
    pub fn variable(x: f64) -> Self {
        Self([x, 1.0, 0.0])
    }

    /// A constant.
    pub fn constant(c: f64) -> Self {
        Self([c, 0.0, 0.0])
    }

    /// `f`.
    pub fn value(self) -> f64 {
        self.0[0]
    }

    /// `f'`.
    pub fn slope(self) -> f64 {
        self.0[1]
    }

    /// The derivative as a function. Its own second derivative is unknown and set to zero: only the value and the
    /// slope of the result may be used.
    #[must_use]
    pub fn derivative(self) -> Self {
        Self([self.0[1], self.0[2], 0.0])
    }

    /// `f^p` for positive `f`.
    #[must_use]
    pub fn power(self, p: f64) -> Self {
        let [f, d, dd] = self.0;
        let outer = [f.powf(p), p * f.powf(p - 1.0), p * (p - 1.0) * f.powf(p - 2.0)];
        Self([outer[0], outer[1] * d, outer[2] * d * d + outer[1] * dd])
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + o.0[i]))
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - o.0[i]))
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let ([f, d, dd], [g, e, ee]) = (self.0, o.0);
        Self([f * g, d * g + f * e, dd * g + 2.0 * d * e + f * ee])
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let [g, e, ee] = o.0;
        self * Self([1.0 / g, -e / (g * g), 2.0 * e * e / (g * g * g) - ee / (g * g)])
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    fn add(self, c: f64) -> Self {
        Self([self.0[0] + c, self.0[1], self.0[2]])
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, c: f64) -> Self {
        Self(self.0.map(|x| c * x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_closed_form() {
        // f = sqrt(x) (1 - x) / (2 + x^2) at x = 0.7.
        let x = 0.7_f64;
        let v = Jet::variable(x);
        let f = v.power(0.5) * (-v + 1.0) / (v * v + 2.0);
        let direct = |x: f64| x.sqrt() * (1.0 - x) / (2.0 + x * x);
        let h = 1e-4;
        let slope = (direct(x + h) - direct(x - h)) / (2.0 * h);
        let curvature = (direct(x + h) - 2.0 * direct(x) + direct(x - h)) / (h * h);
        assert!((f.value() - direct(x)).abs() < 1e-15);
        // Central differences: error h^2 f''' / 6 ~ 1e-8.
        assert!((f.slope() - slope).abs() < 1e-7);
        assert!((f.derivative().slope() - curvature).abs() < 1e-6);
    }
}
