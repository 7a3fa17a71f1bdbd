//! Stress, conduction and dissipation of nearly elastic spheres: the functions C1 to C6 and the
//! reduced coefficients B1 to B4.

use super::{RadialDistribution, jet::Jet};
use std::f64::consts::PI;

/// Properties of the grains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grains {
    /// Diameter `D`.
    pub diameter: f64,
    /// Density `rho` of their material.
    pub density: f64,
    /// Coefficient of restitution `e` between two grains.
    pub restitution: f64,
    /// Radial distribution at contact.
    pub radial: RadialDistribution,
}

/// Lun et al.'s functions at a solid fraction. With the granular temperature `T`: shear stress
/// `C1 sqrt(T) |u'|`, pressure `C2 T`, energy flux `-(C3 sqrt(T) T' + C4 T^(3/2) v')`, dissipation `C6 T^(3/2)`;
/// the work of the stress has `C5 = C1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Viscosity over `sqrt(T)`: density times length.
    pub c1: f64,
    /// Pressure over `T`: density.
    pub c2: f64,
    /// Conductivity over `sqrt(T)`: density times length.
    pub c3: f64,
    /// Energy flux along the gradient of solid fraction, over `T^(3/2)`: density times length. Negative for `e < 1`.
    pub c4: f64,
    /// Dissipation over `T^(3/2)`: density over length.
    pub c6: f64,
}

/// The coefficients of eqs (11) and (12), `u'' + B1 v' u' = 0` and `v'' + B2 v'^2 + B3 + B4 u'^2 = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedCoefficients {
    /// `(ln C1 C2^(-1/2))'`.
    pub b1: f64,
    /// `(ln K C2^(-3/2))'`.
    pub b2: f64,
    /// `C6 / K`: one over length squared.
    pub b3: f64,
    /// `-C1 C2 / (K P)`: one over velocity squared.
    pub b4: f64,
}

/// The functions in units of the grains' density and diameter, with their derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Functions {
    pub c1: Jet,
    pub c2: Jet,
    pub c3: Jet,
    pub c4: Jet,
    pub c6: Jet,
    /// `K = C3 C2'/C2 - C4`: the energy flux is `K T^(3/2) v'` at constant pressure. Value and slope only.
    pub conduction: Jet,
    /// `v g0`.
    pub contact: Jet,
}

impl Grains {
    /// C1 to C6 at a solid fraction in `(0, packed)`.
    pub fn coefficients(&self, solid_fraction: f64) -> Coefficients {
        let f = self.functions(solid_fraction);
        let by_length = self.density * self.diameter;
        Coefficients {
            c1: by_length * f.c1.value(),
            c2: self.density * f.c2.value(),
            c3: by_length * f.c3.value(),
            c4: by_length * f.c4.value(),
            c6: self.density / self.diameter * f.c6.value(),
        }
    }

    /// B1 to B4 at a solid fraction in `(0, packed)` under the given pressure.
    pub fn reduced(&self, solid_fraction: f64, pressure: f64) -> ReducedCoefficients {
        let f = self.functions(solid_fraction);
        let log_slope = |c: Jet| c.slope() / c.value();
        ReducedCoefficients {
            b1: log_slope(f.c1) - 0.5 * log_slope(f.c2),
            b2: log_slope(f.conduction) - 1.5 * log_slope(f.c2),
            b3: f.c6.value() / f.conduction.value() / self.diameter.powi(2),
            b4: -f.c1.value() * f.c2.value() / f.conduction.value() * self.density / pressure,
        }
    }

    /// Lun et al. 1984 in units of density and diameter, `eta = (1 + e)/2`:
    ///
    /// ```text
    /// C1 = mu/(eta(2-eta) g0) (1 + 8/5 eta v g0)(1 + 8/5 eta(3 eta-2) v g0) + 3/5 eta mu_b
    /// C2 = v (1 + 4 eta v g0)
    /// C3 = lam/g0 {(1 + 12/5 eta v g0)(1 + 12/5 eta^2(4 eta-3) v g0) + 64/(25 pi)(41 - 33 eta)(eta v g0)^2}
    /// C4 = lam/g0 (1 + 12/5 eta v g0) 12/5 eta(2 eta-1)(eta-1) (v^2 g0)'/v
    /// C6 = 48/sqrt(pi) eta(1-eta) v^2 g0
    /// mu = 5 sqrt(pi)/96,  mu_b = 256 mu v^2 g0/(5 pi),  lam = 75 sqrt(pi)/(48 eta(41 - 33 eta))
    /// ```
    pub fn functions(&self, solid_fraction: f64) -> Functions {
        let eta = 0.5 * (1.0 + self.restitution);
        let mu = 5.0 * PI.sqrt() / 96.0;
        let lambda = 75.0 * PI.sqrt() / (48.0 * eta * (41.0 - 33.0 * eta));
        let v = Jet::variable(solid_fraction);
        let g0 = self.radial.jet(v);
        let (x, vvg) = (v * g0, v * v * g0);
        let shear = (x * (1.6 * eta) + 1.0) * (x * (1.6 * eta * (3.0 * eta - 2.0)) + 1.0);
        let c1 = shear * (mu / (eta * (2.0 - eta))) / g0 + vvg * (0.6 * eta * 256.0 * mu / (5.0 * PI));
        let c2 = v + vvg * (4.0 * eta);
        let once = x * (2.4 * eta) + 1.0;
        let bulk = x * x * (64.0 / (25.0 * PI) * (41.0 - 33.0 * eta) * eta * eta);
        let c3 = (once * (x * (2.4 * eta * eta * (4.0 * eta - 3.0)) + 1.0) + bulk) * lambda / g0;
        let uneven = 2.4 * eta * (2.0 * eta - 1.0) * (eta - 1.0);
        let c4 = once * vvg.derivative() * (lambda * uneven) / (g0 * v);
        let c6 = vvg * (48.0 / PI.sqrt() * eta * (1.0 - eta));
        Functions { c1, c2, c3, c4, c6, conduction: c3 * c2.derivative() / c2 - c4, contact: x }
    }
}
