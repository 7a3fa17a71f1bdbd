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

use simd::vectorised;

use super::double_double::DoubleDouble;
use super::geometry::{Geometry, side};
use super::surface_velocity::{SurfaceFunction, SurfaceVelocity};
use super::tridiagonal::{self, BlockRow};

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
///
/// [`vectorised`] gives the double-double products fused instructions where everything is inlined, hence the loops in
/// place of closures.
pub fn solve(geometry: &Geometry, order: usize, drives: &[SurfaceVelocity]) -> Vec<[SphereMoments; 2]> {
    vectorised(
        #[inline(always)]
        || {
            let problem = BisphericalProblem::new(geometry, order);
            let mut given = Vec::with_capacity(drives.len());
            for drive in drives {
                given.push(problem.drive(drive));
            }
            let mut rows: Vec<BlockRow> = Vec::with_capacity(problem.decays.len());
            for n in order..problem.decays.len() - 2 {
                rows.push(problem.row(n, &given));
            }
            let y = tridiagonal::solve(&mut rows);
            let mut loads = Vec::with_capacity(given.len());
            for (d, drive) in given.iter().enumerate() {
                loads.push(problem.loads(drive, &y, d));
            }
            loads
        },
    )
}

/// Coefficients over `sqrt 2` of the velocity of one sphere.
struct Drive {
    sphere: usize,
    /// Of `v_z`, `(v_rho + v_phi)/2` and `(v_rho - v_phi)/2`, by degree.
    coefficients: Vec<[DoubleDouble; 3]>,
}

/// Degree through which unknowns and velocities act in the divergence at another one.
#[derive(Debug, Clone, Copy)]
enum Through {
    Below,
    Same,
    Above,
}

struct BisphericalProblem<'a> {
    geometry: &'a Geometry,
    order: usize,
    /// `exp(-(n+1/2) alpha_i)`
    decays: Vec<[DoubleDouble; 2]>,
    /// Weights of the values on spheres 1 and 2 in the amplitude of each family.
    amplitudes: Vec<[[DoubleDouble; 2]; 2]>,
    /// `side / sinh alpha_i`
    csch: [DoubleDouble; 2],
    /// `side coth alpha_i`
    coth: [DoubleDouble; 2],
    /// `exp(-alpha_i)`
    inverse: [DoubleDouble; 2],
}

impl BisphericalProblem<'_> {
    #[inline(always)]
    fn new(geometry: &Geometry, order: usize) -> BisphericalProblem<'_> {
        let decays = geometry.decays();
        let one = DoubleDouble::from(1.0);
        let mut amplitudes = Vec::with_capacity(decays.len());
        for decay in &decays {
            let across = decay[0] * decay[1];
            let own = one / (one - across * across);
            let other = -(across * own);
            amplitudes.push([[own, other], [other, own]]);
        }
        let csch = [0, 1].map(|sphere| DoubleDouble::from(side(sphere)) / geometry.sinh[sphere]);
        let coth = [0, 1].map(|sphere| csch[sphere] * geometry.cosh[sphere]);
        let inverse = geometry.exponential.map(|e| one / e);
        BisphericalProblem { geometry, order, decays, amplitudes, csch, coth, inverse }
    }

    #[inline(always)]
    fn drive(&self, &SurfaceVelocity { sphere, axial, raised, lowered }: &SurfaceVelocity) -> Drive {
        let mut coefficients = Vec::with_capacity(self.decays.len());
        for (n, decays) in self.decays.iter().enumerate() {
            let of = |shape: SurfaceFunction| shape.coefficient(n, decays[sphere], self.geometry, sphere);
            coefficients.push([of(axial), of(raised), of(lowered)]);
        }
        Drive { sphere, coefficients }
    }

    /// Two equations of degree `n`, one per family.
    #[inline(always)]
    fn row(&self, n: usize, drives: &[Drive]) -> BlockRow {
        let mut row = BlockRow::new(drives.len());
        let ratios = Ratios::new(n as f64, self.order as f64);
        for family in 0..2 {
            // Amplitudes of the degrees below, at and above `n`, referred to that of `n`.
            let mut below = [DoubleDouble::default(); 2];
            let same = self.amplitudes[n][family];
            let mut above = self.amplitudes[n + 1][family];
            for sphere in 0..2 {
                if n > 0 {
                    below[sphere] = self.amplitudes[n - 1][family][sphere] * self.geometry.exponential[family];
                }
                above[sphere] = above[sphere] * self.inverse[family];
                self.couple(&mut row, n, [family, sphere], [below[sphere], same[sphere], above[sphere]], &ratios);
            }
            for (d, drive) in drives.iter().enumerate() {
                let known = |through| self.known(n, through, family, drive);
                let mut sum = same[drive.sphere] * known(Through::Same) + above[drive.sphere] * known(Through::Above);
                if n > 0 {
                    sum += below[drive.sphere] * known(Through::Below);
                }
                row.right[family][d] = -sum;
            }
        }
        row
    }

    /// Adds the contribution of the unknowns of one sphere, of all four functions, to the divergence of one family at
    /// degree `n`, by the amplitudes of the degrees below, at and above it.
    #[inline(always)]
    fn couple(
        &self,
        row: &mut BlockRow,
        n: usize,
        [family, sphere]: [usize; 2],
        [below, same, above]: [DoubleDouble; 3],
        ratios: &Ratios,
    ) {
        let (x, m) = (n as f64, self.order as f64);
        let sign = DoubleDouble::from(side(family));
        let (csch, coth) = (self.csch[sphere], self.coth[sphere]);
        let per_sinh = same * csch;
        row.above[family][sphere] = above * ((coth + sign) * (0.5 * (x + m + 1.0))) - per_sinh * ratios.to_above;
        row.middle[family][sphere] =
            same * (coth * 2.5 - sign * (x + 0.5)) + csch * (below * ratios.from_below - above * ratios.from_above);
        row.below[family][sphere] = per_sinh * ratios.to_below + below * ((sign - coth) * (0.5 * (x - m)));
    }

    /// Contribution of the prescribed velocity, through degree `n` or one beside it, to the divergence at `n`.
    #[inline(always)]
    fn known(&self, n: usize, through: Through, family: usize, drive: &Drive) -> DoubleDouble {
        let (x, m) = (n as f64, self.order as f64);
        let (k, axial, raised, lowered) = match through {
            Through::Above => (n + 1, -0.5 * (x + m + 1.0), 0.5 * (x + m + 1.0) * (x + m + 2.0), -0.5),
            Through::Same => (n, x + 0.5, -(x + m + 1.0) * (x - m), 1.0),
            Through::Below => (n - 1, -0.5 * (x - m), 0.5 * (x - m) * (x - m - 1.0), -0.5),
        };
        let values = drive.coefficients[k];
        values[0] * (axial * side(family)) + values[1] * raised + values[2] * lowered
    }

    /// Loads from the far field of each family.
    #[inline(always)]
    fn loads(&self, drive: &Drive, y: &[Vec<[DoubleDouble; 2]>], d: usize) -> [SphereMoments; 2] {
        let m = self.order;
        let zero = [DoubleDouble::default(); 2];
        let mut sums = [[DoubleDouble::default(); 3]; 2];
        let (mut before, mut here) = (zero, y.first().map_or(zero, |values| values[d]));
        for n in m..m + y.len() {
            let after = y.get(n - m + 1).map_or(zero, |values| values[d]);
            let pressure = self.pressure(n, [before, here, after]);
            let mut axial = [-here[0], -here[1]];
            axial[drive.sphere] += drive.coefficients[n][0];
            for (family, sum) in sums.iter_mut().enumerate() {
                let amplitude = &self.amplitudes[n][family];
                let q = amplitude[0] * pressure[0] + amplitude[1] * pressure[1];
                let w = amplitude[0] * axial[0] + amplitude[1] * axial[1];
                let decay = self.decays[n][family];
                accumulate(sum, m, n as f64, [q * decay, w * decay]);
            }
            (before, here) = (here, after);
        }
        [self.about_centre(0, sums[0]), self.about_centre(1, sums[1])]
    }

    /// Coefficients of degree `n` of the pressure on both spheres, from those of `z Q/2` of the degrees below, at and
    /// above it.
    #[inline(always)]
    fn pressure(&self, n: usize, [below, same, above]: [[DoubleDouble; 2]; 3]) -> [DoubleDouble; 2] {
        let (x, m) = (n as f64, self.order as f64);
        let [from_below, from_above] = [ratio(x - m, 2.0 * x - 1.0), ratio(x + m + 1.0, 2.0 * x + 3.0)];
        let mut pressure = [DoubleDouble::default(); 2];
        for (sphere, value) in pressure.iter_mut().enumerate() {
            let stencil =
                self.geometry.cosh[sphere] * same[sphere] - below[sphere] * from_below - above[sphere] * from_above;
            *value = stencil * self.csch[sphere] * 2.0;
        }
        pressure
    }

    /// Loads about the sphere's centre from moments about the origin.
    fn about_centre(&self, family: usize, [first, second, third]: [DoubleDouble; 3]) -> SphereMoments {
        let pi = DoubleDouble::pi();
        let sign = side(family);
        let centre = self.coth[family];
        let third_pi = pi * ratio(4.0, 3.0);
        match self.order {
            0 => {
                let force = pi * first * (8.0 * sign);
                let stresslet = third_pi * second * 4.0 - force * centre * ratio(2.0, 3.0);
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

/// Rational weights of the unknowns of the neighbouring degrees over `sinh alpha`, in the divergence at one degree.
struct Ratios {
    /// Of the unknown above, by the amplitude of the degree itself.
    to_above: DoubleDouble,
    /// Of the unknown below, by the amplitude of the degree itself.
    to_below: DoubleDouble,
    /// Of the unknown of the degree, by the amplitude above.
    from_above: DoubleDouble,
    /// Of the unknown of the degree, by the amplitude below.
    from_below: DoubleDouble,
}

impl Ratios {
    /// Of degree `x` and order `m`.
    #[inline(always)]
    fn new(x: f64, m: f64) -> Self {
        Self {
            to_above: ratio((x + m + 1.0) * (x + 2.5), 2.0 * x + 3.0),
            to_below: ratio((x - m) * (x - 1.5), 2.0 * x - 1.0),
            from_above: ratio((x + 1.0) * (2.0 * x + 3.0), 2.0 * (2.0 * x + 1.0)),
            from_below: ratio(x * (2.0 * x - 1.0), 2.0 * (2.0 * x + 1.0)),
        }
    }
}

/// Adds degree `n` to the sums of force, stresslet and torque.
#[inline(always)]
fn accumulate(sum: &mut [DoubleDouble; 3], order: usize, n: f64, [q, w]: [DoubleDouble; 2]) {
    let pair = n * (n + 1.0);
    match order {
        0 => {
            sum[0] += q * (2.0 * n + 1.0);
            sum[1] += q * (pair + 0.5);
        }
        1 => {
            sum[0] += q * pair;
            sum[1] += q * (pair * (2.0 * n + 1.0));
            sum[2] += w * pair;
        }
        _ => sum[1] += q * (pair * ((n - 1.0) * (n + 2.0))),
    }
}

/// Quotient of two numbers that `f64` represents exactly.
#[inline(always)]
fn ratio(numerator: f64, denominator: f64) -> DoubleDouble {
    DoubleDouble::from(numerator) / DoubleDouble::from(denominator)
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
                let through = [(k - 1, Through::Above), (k, Through::Same), (k + 1, Through::Below)];
                let term = |(n, through)| {
                    let weight = problem.known(n, through, family, &drive) / problem.decays[k][1];
                    weight.value() * harmonic(family, n, m, [rho, z])
                };
                let expected: f64 = through.into_iter().map(term).sum();
                // Central differences: h^2 times a third derivative, of degree 4 below 1e3 times the value.
                assert!(
                    (found - expected).abs() < 1e-5 * found.abs().max(1.0),
                    "order {m}, {which}: {found} {expected}"
                );
            }
        }
    }
}
