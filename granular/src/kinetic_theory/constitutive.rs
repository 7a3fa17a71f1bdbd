//! Stress, conduction and dissipation of nearly elastic spheres: the functions C1 to C6.

use super::{RadialDistribution, jet::Jet};
use std::f64::consts::PI;

/// Properties of the grains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrainProperties {
    /// Diameter `D`.
    pub diameter: f64,
    /// Density `rho` of their material.
    pub density: f64,
    /// Coefficient of restitution `e` between two grains.
    pub restitution: f64,
    /// Radial distribution at contact.
    pub radial: RadialDistribution,
}

/// Lun et al.'s functions of the solid fraction with their derivatives, in units of the grains' density and diameter.
/// With the granular temperature `T`: shear stress `C1 sqrt(T) |u'|`, pressure `C2 T`, energy flux
/// `-(C3 sqrt(T) T' + C4 T^(3/2) v')`, dissipation `C6 T^(3/2)`; the work of the stress has `C5 = C1`.
#[derive(Debug, Clone, Copy)]
pub struct StressFunctions {
    /// Viscosity over `sqrt(T)`.
    pub c1: Jet,
    /// Pressure over `T`.
    pub c2: Jet,
    /// Conductivity over `sqrt(T)`.
    pub c3: Jet,
    /// Energy flux along the gradient of solid fraction, over `T^(3/2)`. Negative for `e < 1`.
    pub c4: Jet,
    /// Dissipation over `T^(3/2)`.
    pub c6: Jet,
    /// `K = C3 C2'/C2 - C4`: the energy flux is `K T^(3/2) v'` at constant pressure. Value and slope only.
    pub conduction: Jet,
    /// `v g0`.
    pub contact: Jet,
}

impl GrainProperties {
    /// Lun et al. 1984 at a solid fraction in `(0, packed)`, with `eta = (1 + e)/2`:
    ///
    /// ```text
    /// C1 = mu/(eta(2-eta) g0) (1 + 8/5 eta v g0)(1 + 8/5 eta(3 eta-2) v g0) + 3/5 eta mu_b
    /// C2 = v (1 + 4 eta v g0)
    /// C3 = lam/g0 {(1 + 12/5 eta v g0)(1 + 12/5 eta^2(4 eta-3) v g0) + 64/(25 pi)(41 - 33 eta)(eta v g0)^2}
    /// C4 = lam/g0 (1 + 12/5 eta v g0) 12/5 eta(2 eta-1)(eta-1) (v^2 g0)'/v
    /// C6 = 48/sqrt(pi) eta(1-eta) v^2 g0
    /// mu = 5 sqrt(pi)/96,  mu_b = 256 mu v^2 g0/(5 pi),  lam = 75 sqrt(pi)/(48 eta(41 - 33 eta))
    /// ```
    pub fn functions(&self, solid_fraction: f64) -> StressFunctions {
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
        StressFunctions { c1, c2, c3, c4, c6, conduction: c3 * c2.derivative() / c2 - c4, contact: x }
    }
}
