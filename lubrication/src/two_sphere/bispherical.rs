//! Two moving spheres in bispherical coordinates: the exact solution, for any gap.
//!
//! Lengths in units of the focal distance `c`, `z = sinh(xi)/(cosh(xi) - cos(eta))`,
//! `rho = sin(eta)/(cosh(xi) - cos(eta))`; sphere 1 is `xi = -alpha_1`, sphere 2 `xi = alpha_2`. With `m` the
//! azimuthal order, the flow is `u = x Q/2 + v`, where the pressure `Q`, `v_z`, `v_rho + v_phi` and `v_rho - v_phi`
//! are harmonic of orders `m`, `m`, `m + 1` and `m - 1` (Jeffery 1922; Dean & O'Neill 1963; O'Neill & Majumdar 1970),
//! so each is
//!
//! ```text
//! sqrt(cosh xi - cos eta) sum_n [a_n exp((n+1/2)(xi - alpha_2)) + b_n exp(-(n+1/2)(xi + alpha_1))] P_n^m(cos eta),
//! ```
//!
//! with the sources of the family `a` inside sphere 2 and those of the family `b` inside sphere 1. On a sphere, the
//! boundary condition gives all four from one unknown series, `y_n` of `z Q/2`. Incompressibility is a recurrence for
//! each family that couples `y_{n-1}`, `y_n`, `y_{n+1}` of both spheres: a block tridiagonal system, solved directly.
//! Digits are lost like a power of `1/alpha`, hence the double-double numbers.

use super::double_double::DoubleDouble;
use super::geometry::{Geometry, side};
use super::normal_polynomial::NormalPolynomial;
use super::tridiagonal::{self, BlockRow, Matrix2};

/// Velocity on one sphere: coefficients of `v_z`, `(v_rho + v_phi)/2`, `(v_rho - v_phi)/2` in the basis above over
/// `sqrt 2`.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceVelocity {
    /// Sphere that moves, 0 or 1; the other one is at rest.
    pub sphere: usize,
    /// `v_z`, of order `m`.
    pub axial: SurfaceFunction,
    /// `(v_rho + v_phi)/2`, of order `m + 1`.
    pub raised: SurfaceFunction,
    /// `(v_rho - v_phi)/2`, of order `m - 1`.
    pub lowered: SurfaceFunction,
}

/// A function on a sphere.
#[derive(Debug, Clone, Copy)]
pub enum SurfaceFunction {
    /// 0
    Zero,
    /// 1, of order 0
    One,
    /// `z - z_i`, of order 0
    Height,
    /// A multiple of `rho`, of order 1
    Radius(f64),
    /// A polynomial of the normal
    Normal(NormalPolynomial),
}

impl SurfaceFunction {
    /// Coefficient of degree `n` over `sqrt 2`, given `exp(-(n+1/2) alpha)`.
    fn coefficient(self, n: usize, decay: DoubleDouble, geometry: &Geometry, sphere: usize) -> DoubleDouble {
        match self {
            Self::Zero => DoubleDouble::default(),
            Self::One => decay,
            Self::Height => {
                let side = decay * side(sphere);
                side * (2 * n + 1) as f64 - side * geometry.cosh[sphere] / geometry.sinh[sphere]
            }
            Self::Radius(factor) => decay * (2.0 * factor),
            Self::Normal(polynomial) => polynomial.coefficient(n, decay, geometry, sphere),
        }
    }
}

/// Moments of the traction of one sphere on the fluid about its centre, in units of viscosity and `c`.
#[derive(Debug, Clone, Copy, Default)]
pub struct SphereMoments {
    /// Along `z` for `m = 0`, along `x` for `m = 1`.
    pub force: DoubleDouble,
    /// About `y`, for `m = 1`.
    pub torque: DoubleDouble,
    /// `zz` for `m = 0`, `xz` for `m = 1`, `xx` for `m = 2`.
    pub stresslet: DoubleDouble,
}

/// Loads of both spheres for each drive of azimuthal order `order`.
pub fn solve(geometry: &Geometry, order: usize, drives: &[SurfaceVelocity]) -> Vec<[SphereMoments; 2]> {
    let problem = BisphericalProblem::new(geometry, order);
    let drives: Vec<Drive> = drives.iter().map(|drive| problem.drive(drive)).collect();
    let mut rows: Vec<BlockRow> = (order..problem.decays.len() - 2).map(|n| problem.row(n, &drives)).collect();
    let y = tridiagonal::solve(&mut rows);
    drives.iter().enumerate().map(|(d, drive)| problem.loads(drive, &y, d)).collect()
}

/// Coefficients over `sqrt 2` of the velocity of one sphere.
struct Drive {
    sphere: usize,
    /// Of `v_z`, `(v_rho + v_phi)/2` and `(v_rho - v_phi)/2`, by degree.
    coefficients: Vec<[DoubleDouble; 3]>,
}

/// Unknowns of one sphere in the divergence of one family.
struct Coupling {
    /// Degree of the divergence.
    degree: usize,
    /// Degree of the unknowns.
    through: usize,
    family: usize,
    sphere: usize,
}

struct BisphericalProblem<'a> {
    geometry: &'a Geometry,
    order: usize,
    /// `exp(-(n+1/2) alpha_i)`
    decays: Vec<[DoubleDouble; 2]>,
    /// Weights of the values on spheres 1 and 2 in the amplitude of each family.
    amplitudes: Vec<[[DoubleDouble; 2]; 2]>,
}

impl BisphericalProblem<'_> {
    fn new(geometry: &Geometry, order: usize) -> BisphericalProblem<'_> {
        let decays = geometry.decays();
        let one = DoubleDouble::from(1.0);
        let amplitudes = decays.iter().map(|decay| {
            let across = decay[0] * decay[1];
            let own = one / (one - across * across);
            let other = -(across * own);
            [[own, other], [other, own]]
        });
        BisphericalProblem { geometry, order, amplitudes: amplitudes.collect(), decays }
    }

    fn drive(&self, &SurfaceVelocity { sphere, axial, raised, lowered }: &SurfaceVelocity) -> Drive {
        let of_degree = |(n, decays): (usize, &[DoubleDouble; 2])| {
            [axial, raised, lowered].map(|shape| shape.coefficient(n, decays[sphere], self.geometry, sphere))
        };
        Drive { sphere, coefficients: self.decays.iter().enumerate().map(of_degree).collect() }
    }

    /// Two equations of degree `n`, one per family.
    fn row(&self, n: usize, drives: &[Drive]) -> BlockRow {
        let mut row = BlockRow::new(drives.len());
        for family in 0..2 {
            for (k, growth) in self.neighbours(n, family) {
                let amplitude = self.amplitudes[k][family].map(|a| a * growth);
                for (sphere, weight) in amplitude.into_iter().enumerate() {
                    self.couple(&mut row, &Coupling { degree: n, through: k, family, sphere }, weight);
                }
                for (d, drive) in drives.iter().enumerate() {
                    row.right[family][d] += -(amplitude[drive.sphere] * self.known(n, k, family, drive));
                }
            }
        }
        row
    }

    /// Degrees in the divergence at degree `n`, with the factor that refers their amplitudes to `n`.
    fn neighbours(&self, n: usize, family: usize) -> impl Iterator<Item = (usize, DoubleDouble)> {
        let e = self.geometry.exponential[family];
        let one = DoubleDouble::from(1.0);
        let below = (n > 0).then(|| (n.wrapping_sub(1), e));
        below.into_iter().chain([(n, one), (n + 1, one / e)])
    }

    /// Adds the contribution of the unknowns of one sphere, of all four functions, to the
    /// divergence.
    fn couple(&self, row: &mut BlockRow, coupling: &Coupling, amplitude: DoubleDouble) {
        let &Coupling { degree: n, through: k, family, sphere } = coupling;
        let (x, m) = (n as f64, self.order as f64);
        let sign = side(family);
        let per_sinh = amplitude / (self.geometry.sinh[sphere] * side(sphere));
        let coth = per_sinh * self.geometry.cosh[sphere];
        let add = |block: &mut Matrix2, value: DoubleDouble| block[family][sphere] += value;
        if k == n + 1 {
            let half = 0.5 * (x + m + 1.0);
            add(&mut row.above, coth * half + amplitude * (sign * half));
            add(&mut row.middle, -ratio(per_sinh, (x + 1.0) * (2.0 * x + 3.0), 2.0 * (2.0 * x + 1.0)));
        } else if k == n {
            add(&mut row.above, -ratio(per_sinh, (x + m + 1.0) * (x + 2.5), 2.0 * x + 3.0));
            add(&mut row.middle, coth * 2.5 - amplitude * (sign * (x + 0.5)));
            add(&mut row.below, ratio(per_sinh, (x - m) * (x - 1.5), 2.0 * x - 1.0));
        } else {
            let half = 0.5 * (x - m);
            add(&mut row.below, amplitude * (sign * half) - coth * half);
            add(&mut row.middle, ratio(per_sinh, x * (2.0 * x - 1.0), 2.0 * (2.0 * x + 1.0)));
        }
    }

    /// Contribution of the prescribed velocity, through degree `k`, to the divergence at `n`.
    fn known(&self, n: usize, k: usize, family: usize, drive: &Drive) -> DoubleDouble {
        let (x, m) = (n as f64, self.order as f64);
        let (axial, raised, lowered) = if k == n + 1 {
            (-0.5 * (x + m + 1.0), 0.5 * (x + m + 1.0) * (x + m + 2.0), -0.5)
        } else if k == n {
            (x + 0.5, -(x + m + 1.0) * (x - m), 1.0)
        } else {
            (-0.5 * (x - m), 0.5 * (x - m) * (x - m - 1.0), -0.5)
        };
        let values = drive.coefficients[k];
        values[0] * (axial * side(family)) + values[1] * raised + values[2] * lowered
    }

    /// Loads from the far field of each family.
    fn loads(&self, drive: &Drive, y: &[Vec<[DoubleDouble; 2]>], d: usize) -> [SphereMoments; 2] {
        let m = self.order;
        let at = |n: usize, sphere: usize| {
            n.checked_sub(m).and_then(|i| y.get(i)).map_or(DoubleDouble::default(), |values| values[d][sphere])
        };
        let mut sums = [[DoubleDouble::default(); 3]; 2];
        for n in m..m + y.len() {
            let pressure = [0, 1].map(|sphere| self.pressure(n, sphere, &at));
            let axial = [0, 1].map(|sphere| {
                let moving = if sphere == drive.sphere { drive.coefficients[n][0] } else { DoubleDouble::default() };
                moving - at(n, sphere)
            });
            for (family, sum) in sums.iter_mut().enumerate() {
                let weights = self.amplitudes[n][family].map(|w| w * self.decays[n][family]);
                let q = weights[0] * pressure[0] + weights[1] * pressure[1];
                let w = weights[0] * axial[0] + weights[1] * axial[1];
                accumulate(sum, m, n as f64, [q, w]);
            }
        }
        [0, 1].map(|family| self.about_centre(family, sums[family]))
    }

    /// Coefficient of the pressure on a sphere, from that of `z Q/2`.
    fn pressure(&self, n: usize, sphere: usize, y: &impl Fn(usize, usize) -> DoubleDouble) -> DoubleDouble {
        let (x, m) = (n as f64, self.order as f64);
        let below = if n == 0 { DoubleDouble::default() } else { ratio(y(n - 1, sphere), x - m, 2.0 * x - 1.0) };
        let stencil =
            self.geometry.cosh[sphere] * y(n, sphere) - below - ratio(y(n + 1, sphere), x + m + 1.0, 2.0 * x + 3.0);
        stencil * (2.0 * side(sphere)) / self.geometry.sinh[sphere]
    }

    /// Loads about the sphere's centre from moments about the origin.
    fn about_centre(&self, family: usize, [first, second, third]: [DoubleDouble; 3]) -> SphereMoments {
        let pi = DoubleDouble::pi();
        let sign = side(family);
        let centre = self.geometry.cosh[family] / self.geometry.sinh[family] * sign;
        let third_pi = ratio(pi, 4.0, 3.0);
        match self.order {
            0 => {
                let force = pi * first * (8.0 * sign);
                let stresslet = third_pi * second * 4.0 - ratio(force * centre, 2.0, 3.0);
                SphereMoments { force, stresslet, ..SphereMoments::default() }
            }
            1 => {
                let force = pi * first * 8.0;
                let torque = -(pi * third * 16.0) - force * centre;
                let stresslet = third_pi * second * sign - force * centre * 0.5;
                SphereMoments { force, torque, stresslet }
            }
            _ => SphereMoments { stresslet: third_pi * second, ..SphereMoments::default() },
        }
    }
}

/// Adds degree `n` to the sums of force, stresslet and torque.
fn accumulate(sum: &mut [DoubleDouble; 3], order: usize, n: f64, [q, w]: [DoubleDouble; 2]) {
    let pair = n * (n + 1.0);
    match order {
        0 => {
            sum[0] += q * (2.0 * n + 1.0);
            sum[1] += q * (pair + 0.5);
        }
        1 => {
            sum[0] += q * pair;
            sum[1] += q * pair * (2.0 * n + 1.0);
            sum[2] += w * pair;
        }
        _ => sum[1] += q * pair * ((n - 1.0) * (n + 2.0)),
    }
}

fn ratio(x: DoubleDouble, numerator: f64, denominator: f64) -> DoubleDouble {
    x * numerator / DoubleDouble::from(denominator)
}

/// Torques along the line of centres, `[rotating sphere][sphere with the torque]`, for unit angular velocity (Jeffery
/// 1915).
///
/// The velocity itself is harmonic, of order 1, so the two families follow from its values on the spheres.
pub fn spin(geometry: &Geometry) -> [[f64; 2]; 2] {
    let problem = BisphericalProblem::new(geometry, 1);
    let mut sums = [[DoubleDouble::default(); 2]; 2];
    for (n, decays) in problem.decays.iter().enumerate().skip(1) {
        for (spins, bears) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let amplitude = problem.amplitudes[n][bears][spins] * decays[bears] * decays[spins];
            sums[spins][bears] += amplitude * (n * (n + 1)) as f64;
        }
    }
    sums.map(|line| line.map(|sum| 32.0 * std::f64::consts::PI * sum.value()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Associated Legendre functions without the Condon-Shortley phase.
    fn legendre(n: usize, m: usize, x: f64) -> f64 {
        let sectoral = |l: usize| (0..l).map(|i| (2 * i + 1) as f64 * (1.0 - x * x).sqrt()).product::<f64>();
        if n < m {
            return 0.0;
        }
        let (mut below, mut value) = (0.0, sectoral(m));
        for l in m + 1..=n {
            let next = ((2 * l - 1) as f64 * x * value - (l + m - 1) as f64 * below) / (l - m) as f64;
            (below, value) = (value, next);
        }
        value
    }

    /// Harmonic function of a family, degree and order, with coefficient 1, at `(rho, z)`.
    fn harmonic(family: usize, n: usize, m: usize, [rho, z]: [f64; 2]) -> f64 {
        let square = rho * rho + z * z;
        let (xi, eta) = ((2.0 * z / (square + 1.0)).atanh(), (2.0 * rho).atan2(square - 1.0));
        let growth = ((n as f64 + 0.5) * xi * side(family)).exp();
        (xi.cosh() - eta.cos()).sqrt() * growth * legendre(n, m, eta.cos())
    }

    /// `d v_z/dz + d v_rho/drho + (v_rho + m v_phi) / rho` of one component by central differences, against the
    /// degrees of `known`.
    #[test]
    fn the_divergence_of_each_component_is_that_of_its_derivatives() {
        let (geometry, h) = (Geometry::new(1.5, 0.3), 1e-4);
        let component = |which: usize| {
            let shape = |k: usize| if k == which { SurfaceFunction::One } else { SurfaceFunction::Zero };
            SurfaceVelocity { sphere: 1, axial: shape(0), raised: shape(1), lowered: shape(2) }
        };
        let cases = [(0, 0, 0), (0, 1, 1), (1, 0, 1), (1, 1, 2), (1, 2, 0), (2, 0, 2), (2, 1, 3), (2, 2, 1)];
        for ((m, which, order), k, family) in
            cases.into_iter().flat_map(|case| [3, 4].map(|k| [0, 1].map(|f| (case, k, f)))).flatten()
        {
            let problem = BisphericalProblem::new(&geometry, m);
            let drive = problem.drive(&component(which));
            let value = |point| harmonic(family, k, order, point);
            for [rho, z] in [[0.7, 0.3], [0.4, -0.5], [1.3, 0.9]] {
                let [across, along] = [[h, 0.0], [0.0, h]]
                    .map(|[r, u]: [f64; 2]| (value([rho + r, z + u]) - value([rho - r, z - u])) / (2.0 * h));
                let found = match which {
                    0 => along,
                    1 => across + (1.0 + m as f64) * value([rho, z]) / rho,
                    _ => across + (1.0 - m as f64) * value([rho, z]) / rho,
                };
                let expected: f64 = (k - 1..=k + 1)
                    .map(|n| problem.known(n, k, family, &drive) / problem.decays[k][1])
                    .zip(k - 1..)
                    .map(|(weight, n)| weight.value() * harmonic(family, n, m, [rho, z]))
                    .sum();
                // Central differences: h^2 times a third derivative, of degree 4 below 1e3 times the value.
                assert!(
                    (found - expected).abs() < 1e-5 * found.abs().max(1.0),
                    "order {m}, {which}: {found} {expected}"
                );
            }
        }
    }
}
