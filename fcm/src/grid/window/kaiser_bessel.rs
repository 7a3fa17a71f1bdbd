//! The Kaiser-Bessel window.

use std::f64::consts::PI;

/// Largest number of derivatives of a window that are needed, its value included.
pub(crate) const DERIVATIVES: usize = 4;

/// `I_0(beta sqrt(1 - (2x/P)^2)) / I_0(beta)` for `|x| <= P/2`, in units of the grid's spacing, and zero beyond
/// (Kaiser & Schafer 1980; as a gridding window Jackson et al. 1991). Within its support it is an entire function of
/// `x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct KaiserBessel {
    points: usize,
    /// `beta`
    shape: f64,
    /// `I_0(beta)`
    peak: f64,
}

impl KaiserBessel {
    /// Smallest and largest number of points of a window.
    pub const POINTS: [usize; 2] = [2, 16];

    /// Window of `points` points that suits a Gaussian of width `Sigma`, `resolution` grid spacings, best.
    ///
    /// The transform of the window is compact up to `2 beta / P`. Wavenumbers from `2 pi - k` on alias onto `k`,
    /// which matters where `exp(-k^2 Sigma^2 / 2)` does: up to some `k Sigma` that is the larger, the smaller the
    /// error that the number of points permits. The shape is a fit, whose errors
    /// `cargo run --release -p fcm --example errors` prints for 4 to 16 points.
    pub fn new(points: usize, resolution: f64) -> Self {
        let highest = (0.86 + (0.4 * points as f64 - 1.38) / resolution) / resolution;
        let shape = 0.5 * points as f64 * (2.0 * PI - highest);
        // Keeps the transform free of zeros up to the highest wavenumber, pi.
        let shape = shape.max(1.7 * points as f64);
        Self { points, shape, peak: bessel_i0(shape) }
    }

    /// Number of points `P`.
    pub fn points(self) -> usize {
        self.points
    }

    /// Value and first three derivatives at a distance `x` of at most `P/2`.
    ///
    /// `I_0(z) = h_0(z^2/4)` with `h_m' = h_(m+1)`, and `z^2/4` is a parabola of `x`.
    pub fn derivatives(self, x: f64) -> [f64; DERIVATIVES] {
        let half = 0.5 * self.points as f64;
        let argument = 0.25 * self.shape * self.shape;
        let bend = -2.0 * argument / (half * half);
        let [f, f1, f2, f3] = hypergeometric(argument * (1.0 - (x / half).powi(2)).max(0.0));
        let slope = bend * x;
        let second = slope * slope * f2 + bend * f1;
        let third = slope * (slope * slope * f3 + 3.0 * bend * f2);
        [f, slope * f1, second, third].map(|value| value / self.peak)
    }

    /// Fourier transform, `P sinh(v) / (v I_0(beta))`, `v^2 = beta^2 - (k P / 2)^2`, at the wavenumber `k` in units
    /// of the inverse spacing.
    pub fn transform(self, k: f64) -> f64 {
        let half = 0.5 * self.points as f64;
        let square = self.shape * self.shape - k * k * half * half;
        let root = square.abs().sqrt();
        let quotient = if root < 1e-6 {
            1.0
        } else if square > 0.0 {
            root.sinh() / root
        } else {
            root.sin() / root
        };
        2.0 * half * quotient / self.peak
    }

    /// Transform at the imaginary wavenumber `i k`, and `k` times its logarithmic derivative by `k`.
    pub fn growth(self, k: f64) -> [f64; 2] {
        let half = 0.5 * self.points as f64;
        let root = (self.shape * self.shape + k * k * half * half).sqrt();
        let level = k * k * half * half * (1.0 / root.tanh() - 1.0 / root) / root;
        [2.0 * half * root.sinh() / (root * self.peak), level]
    }

    /// Mean of `x^2` over the window.
    pub fn second_moment(self) -> f64 {
        let half = 0.5 * self.points as f64;
        half * half * (1.0 / self.shape.tanh() - 1.0 / self.shape) / self.shape
    }

    /// `beta`: the larger, the more compact the transform, and the smaller the errors.
    pub fn shape(self) -> f64 {
        self.shape
    }

    /// Value of the window at its ends: about the least error that it can have.
    pub fn end(self) -> f64 {
        1.0 / self.peak
    }
}

/// Modified Bessel function `I_0` of the first kind.
fn bessel_i0(x: f64) -> f64 {
    hypergeometric(0.25 * x * x)[0]
}

/// `h_m(s) = sum_j s^j / (j! (j+m)!)`, whose terms are all positive; `h_m(z^2/4)` is `I_m(z) / (z/2)^m`.
fn hypergeometric(s: f64) -> [f64; DERIVATIVES] {
    let mut sums = [0.0; DERIVATIVES];
    let mut factorial = 1.0;
    for (m, sum) in sums.iter_mut().enumerate() {
        factorial *= m.max(1) as f64;
        let (mut term, mut j) = (1.0 / factorial, 1.0);
        while term > 1e-18 * *sum {
            *sum += term;
            term *= s / (j * (j + m as f64));
            j += 1.0;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bessel_function_is_that_of_the_tables() {
        for (x, value) in [(0.0, 1.0), (1.0, 1.266_065_877_752_008_4), (10.0, 2_815.716_628_466_254)] {
            assert!((bessel_i0(x) / value - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn derivatives_are_those_of_the_window() {
        let (window, step) = (KaiserBessel::new(7, 1.2), 1e-4);
        for x in [-3.4, -1.0, 0.0, 2.3, 3.1] {
            let [before, here, after] = [x - step, x, x + step].map(|x| window.derivatives(x));
            for n in 0..DERIVATIVES - 1 {
                let slope = (after[n] - before[n]) / (2.0 * step);
                assert!((slope - here[n + 1]).abs() < 1e-6, "derivative {} at {x}", n + 1);
            }
        }
    }

    #[test]
    fn the_transform_is_that_of_the_window() {
        for points in [4, 7, 12] {
            let window = KaiserBessel::new(points, 1.3);
            let half = 0.5 * points as f64;
            for k in [0.0, 0.7, 2.0, PI, 5.0] {
                // Simpson's rule.
                let count = 4000;
                let step = 2.0 * half / f64::from(count);
                let term = |i: i32| {
                    let x = f64::from(i) * step - half;
                    let weight = if i == 0 || i == count { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                    weight * window.derivatives(x)[0] * (k * x).cos()
                };
                let integral: f64 = (0..=count).map(term).sum::<f64>() * step / 3.0;
                assert!((window.transform(k) - integral).abs() < 1e-10, "{points} points at {k}");
            }
        }
    }

    #[test]
    fn moments_are_those_of_the_window() {
        let (window, k) = (KaiserBessel::new(7, 1.3), 1.7);
        let integral = |weight: &dyn Fn(f64) -> f64| {
            let (count, half) = (20_000, 3.5);
            let step = 2.0 * half / f64::from(count);
            let x = |i: i32| (f64::from(i) + 0.5) * step - half;
            (0..count).map(|i| weight(x(i)) * window.derivatives(x(i))[0]).sum::<f64>() * step
        };
        let [transform, level] = window.growth(k);
        // The midpoint rule has an error by the jumps of the window's slope at its ends.
        assert!((transform / integral(&|x| (k * x).exp()) - 1.0).abs() < 1e-7);
        assert!((level * transform / integral(&|x| k * x * (k * x).exp()) - 1.0).abs() < 1e-7);
        assert!((window.second_moment() * integral(&|_| 1.0) / integral(&|x| x * x) - 1.0).abs() < 1e-7);
        assert!((window.growth(0.0)[0] / window.transform(0.0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_transform_has_no_zero_on_the_grid() {
        for points in KaiserBessel::POINTS[0]..=KaiserBessel::POINTS[1] {
            for resolution in [0.5, 0.8, 1.0, 1.5, 3.0] {
                assert!(KaiserBessel::new(points, resolution).transform(PI) > 0.0);
            }
        }
    }
}
