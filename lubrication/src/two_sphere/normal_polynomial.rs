//! Polynomials of the normal on a sphere, as series of bispherical harmonics.

use super::double_double::DoubleDouble;
use super::geometry::{Geometry, side};

/// `n_rho^order (p_0 + p_1 n_z + p_2 n_z^2 + p_3 n_z^3)` on a sphere, with `n` its outward normal.
#[derive(Debug, Clone, Copy)]
pub struct NormalPolynomial {
    /// Power of `n_rho`, which is the order of the harmonics.
    pub order: usize,
    /// Coefficients of the powers of `n_z`.
    pub powers: [f64; 4],
}

impl NormalPolynomial {
    /// Coefficient of degree `n` over `sqrt 2`, given `exp(-(n+1/2) alpha)`.
    ///
    /// On the sphere `xi = side alpha`, `n_z = side (w - cosh alpha)` and `n_rho = sinh alpha rho` with `w = sinh^2
    /// alpha / (cosh alpha - cos eta)`. From the series of `(cosh alpha - cos eta)^(-1/2)`, `k` derivatives by `cos
    /// eta` give that of `rho^k`, and derivatives by `alpha` multiply it by powers of `w`: with `y = (n+1/2) sinh
    /// alpha` and `c = cosh alpha`, the coefficients of `rho^k w^q` are those of `rho^k` times
    ///
    /// ```text
    /// 1,   y / (k+1/2),   y (y+c) / ((k+1/2)(k+3/2)),   y [(y+2c)(y+c) + 1] / ((k+1/2)(k+3/2)(k+5/2))
    /// ```
    pub fn coefficient(self, n: usize, decay: DoubleDouble, geometry: &Geometry, sphere: usize) -> DoubleDouble {
        let (cosh, sinh) = (geometry.cosh[sphere], geometry.sinh[sphere]);
        let (one, k, side) = (DoubleDouble::from(1.0), self.order as f64, side(sphere));
        let y = sinh * (n as f64 + 0.5);
        let first = y / DoubleDouble::from(k + 0.5);
        let second = first * (y + cosh) / DoubleDouble::from(k + 1.5);
        let third = first * ((y + cosh * 2.0) * (y + cosh) + one) / DoubleDouble::from((k + 1.5) * (k + 2.5));
        let square = cosh * cosh;
        let powers = [
            one,
            (first - cosh) * side,
            second - cosh * first * 2.0 + square,
            (third - cosh * second * 3.0 + square * first * 3.0 - square * cosh) * side,
        ];
        let sum = powers.into_iter().zip(self.powers).fold(DoubleDouble::default(), |sum, (x, p)| sum + x * p);
        let radius = (0..self.order).fold(decay, |product, l| product * sinh / DoubleDouble::from(l as f64 + 0.5));
        radius * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Associated Legendre functions without the Condon-Shortley phase, of degrees up to `last`.
    fn legendre(last: usize, m: usize, x: f64) -> Vec<f64> {
        let mut values = vec![0.0; last + 1];
        values[m] = (0..m).map(|i| (2 * i + 1) as f64 * (1.0 - x * x).sqrt()).product();
        for l in m + 1..=last {
            let below = if l > m + 1 { values[l - 2] } else { 0.0 };
            values[l] = ((2 * l - 1) as f64 * x * values[l - 1] - (l + m - 1) as f64 * below) / (l - m) as f64;
        }
        values
    }

    /// `sqrt 2 sqrt(cosh alpha - cos eta) sum_n c_n P_n^k(cos eta)` at points of both spheres, against the polynomial.
    #[test]
    fn series_sum_to_the_polynomial() {
        let geometry = Geometry::new(1.7, 0.4);
        for (order, powers) in [(0, [0.3, -1.2, 0.7, 0.9]), (1, [0.2, 0.8, -1.1, 0.4]), (2, [1.0, -0.6, 0.0, 0.0])] {
            let polynomial = NormalPolynomial { order, powers };
            let decays = geometry.decays();
            for (sphere, mu) in [0, 1].into_iter().flat_map(|sphere| [-0.8, 0.1, 0.6, 0.95].map(|mu| (sphere, mu))) {
                let (cosh, sinh) = (geometry.cosh[sphere].value(), geometry.sinh[sphere].value());
                let harmonics = legendre(decays.len(), order, mu);
                let term =
                    |n: usize| polynomial.coefficient(n, decays[n][sphere], &geometry, sphere).value() * harmonics[n];
                let found = (2.0 * (cosh - mu)).sqrt() * (order..decays.len()).map(term).sum::<f64>();
                let (height, across) = (side(sphere) * (sinh * sinh / (cosh - mu) - cosh), (1.0 - mu * mu).sqrt());
                let normal = across * sinh / (cosh - mu);
                let exact = normal.powi(order as i32)
                    * powers.iter().rev().fold(0.0, |sum, coefficient| sum * height + coefficient);
                assert!((found - exact).abs() < 1e-7, "{order} on {sphere} at {mu}: {found}, not {exact}");
                assert!((height * height + normal * normal - 1.0).abs() < 1e-13);
            }
        }
    }
}
