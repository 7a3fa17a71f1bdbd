//! Piecewise polynomial approximation of a window.

use crate::grid::window::KaiserBessel;
use crate::grid::window::kaiser_bessel::DERIVATIVES;
use simd::SimdVector as Lanes;
use solver::{AlignedMemory, Real};
use std::f64::consts::PI;

/// Values and derivatives of a window at the points of a stencil: for each point a polynomial in the particle's
/// offset between two grid points, which is the same for all points, so that a vector of points is evaluated at once.
#[derive(Debug, Clone)]
pub(crate) struct Pieces<T> {
    points: usize,
    /// Points padded to whole vectors; the padding is zero.
    lanes: usize,
    /// Polynomials by order of derivative.
    series: [WindowSeries<T>; DERIVATIVES],
}

/// Polynomials of one degree: coefficients from the highest on, each a row of lanes.
#[derive(Debug, Clone)]
struct WindowSeries<T> {
    rows: usize,
    coefficients: AlignedMemory<T>,
}

impl<T: Real> Pieces<T> {
    /// Polynomials as accurate as the window itself.
    pub fn new(window: KaiserBessel) -> Self {
        let points = window.points();
        let lanes = if points <= T::LANES / 2 { T::LANES / 2 } else { points.next_multiple_of(T::LANES) };
        let pieces: Vec<_> = (0..points).map(|point| polynomials(window, point)).collect();
        let enough = (0.01 * window.end()).max(0.1 * T::EPSILON);
        let series = |n: usize| {
            let degree = pieces.iter().map(|piece| degree(&piece[n], enough)).max().unwrap_or(0);
            let mut coefficients = AlignedMemory::zero((degree + 1) * lanes);
            for (point, piece) in pieces.iter().enumerate() {
                for power in 0..=degree {
                    coefficients.values_mut()[(degree - power) * lanes + point] = T::from_f64(piece[n][power]);
                }
            }
            WindowSeries { rows: degree + 1, coefficients }
        };
        Self { points, lanes, series: std::array::from_fn(series) }
    }

    /// Polynomials of each derivative without padding: coefficients from the highest power on, each a row of points.
    pub fn series(&self) -> [Vec<f64>; DERIVATIVES] {
        let rows = |series: &WindowSeries<T>| {
            let rows = series.coefficients.values()[..series.rows * self.lanes].chunks(self.lanes);
            rows.flat_map(|row| row[..self.points].iter().map(|value| value.to_f64())).collect()
        };
        std::array::from_fn(|derivative| rows(&self.series[derivative]))
    }

    /// Points padded to whole vectors.
    pub fn lanes(&self) -> usize {
        self.lanes
    }

    /// Writes the derivatives of `orders` orders, the value included, at the points of stencils along three axes,
    /// whose first points are at `offsets` spacings from the particle; each order is a row of lanes.
    ///
    /// # Safety
    /// The lanes are `WIDTH` vectors, and there is room.
    #[inline(always)]
    pub unsafe fn write<V: Lanes<T>, const WIDTH: usize>(&self, offsets: [f64; 3], orders: usize, to: [*mut T; 3]) {
        let lanes = WIDTH * V::LANES;
        let mut t = [V::splat(T::default()); 3];
        for d in 0..3 {
            t[d] = V::splat(T::from_f64(2.0 * offsets[d] + self.points as f64 - 1.0));
        }
        for n in 0..orders {
            let series = &self.series[n];
            let coefficients = series.coefficients.values().as_ptr();
            for part in 0..WIDTH {
                let part = part * V::LANES;
                unsafe {
                    let mut sums = [V::load(coefficients.add(part)); 3];
                    for row in 1..series.rows {
                        let coefficient = V::load(coefficients.add(row * lanes + part));
                        for d in 0..3 {
                            sums[d] = sums[d].mul_add(t[d], coefficient);
                        }
                    }
                    for d in 0..3 {
                        sums[d].store(to[d].add(n * lanes + part));
                    }
                }
            }
        }
    }
}

/// Number of Chebyshev nodes at which a window is sampled between two grid points.
const NODES: usize = 32;

/// Polynomials in `t` of the window and its derivatives at a point of the stencil: `t` runs from -1, where the first
/// point is half the window away from the particle, to 1, where it is one spacing nearer. Coefficients begin with the
/// constant.
fn polynomials(window: KaiserBessel, point: usize) -> [Vec<f64>; DERIVATIVES] {
    let half = 0.5 * window.points() as f64;
    let angle = |i: usize| PI * (i as f64 + 0.5) / NODES as f64;
    let sample = |i: usize| window.derivatives(point as f64 - half + 0.5 * (angle(i).cos() + 1.0));
    let samples: Vec<_> = (0..NODES).map(sample).collect();
    let chebyshev = |derivative: usize, n: usize| {
        let sum: f64 = samples.iter().enumerate().map(|(i, s)| s[derivative] * (n as f64 * angle(i)).cos()).sum();
        sum * if n == 0 { 1.0 } else { 2.0 } / NODES as f64
    };
    std::array::from_fn(|derivative| monomials(&(0..NODES).map(|n| chebyshev(derivative, n)).collect::<Vec<_>>()))
}

/// Chebyshev series as a polynomial in powers, without terms at round-off.
fn monomials(series: &[f64]) -> Vec<f64> {
    let scale = series.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let last = series.iter().rposition(|c| c.abs() > 1e-15 * scale).unwrap_or(0);
    let (mut polynomial, mut before, mut now) = (vec![0.0; NODES], vec![0.0; NODES], vec![0.0; NODES]);
    (before[1], now[0]) = (1.0, 1.0);
    for c in &series[..=last] {
        for (sum, coefficient) in polynomial.iter_mut().zip(&now) {
            *sum += c * coefficient;
        }
        // T_(n+1) = 2 t T_n - T_(n-1), with T_(-1) = T_1.
        let shifted = std::iter::once(&0.0).chain(&now);
        let next = shifted.zip(&before).map(|(now, before)| 2.0 * now - before).collect();
        before = std::mem::replace(&mut now, next);
    }
    polynomial
}

/// Degree beyond which a polynomial's terms add less than `enough`.
fn degree(polynomial: &[f64], enough: f64) -> usize {
    let mut rest = 0.0;
    for (power, coefficient) in polynomial.iter().enumerate().rev() {
        rest += coefficient.abs();
        if rest > enough {
            return power;
        }
    }
    0
}
