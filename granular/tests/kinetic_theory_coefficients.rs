//! The coefficients of the paper's equations (11) and (12) and of its wall laws, from the functions of the theory.

use granular::kinetic_theory::{GrainProperties, Jet, Wall};

/// C1 to C6 with their units.
pub struct Coefficients {
    /// Viscosity over `sqrt(T)`: density times length.
    pub c1: f64,
    /// Pressure over `T`: density.
    pub c2: f64,
    /// Conductivity over `sqrt(T)`: density times length.
    pub c3: f64,
    /// Energy flux along the gradient of solid fraction, over `T^(3/2)`: density times length.
    pub c4: f64,
    /// Dissipation over `T^(3/2)`: density over length.
    pub c6: f64,
}

/// The coefficients of eqs (11) and (12), `u'' + B1 v' u' = 0` and `v'' + B2 v'^2 + B3 + B4 u'^2 = 0`.
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

/// Coefficients of the wall laws, with `n` into the flow: `|u'| = R5 B5 u_slip` and
/// `dv/dn = R7 B7 u_slip^2 + R8 B8 u_slip |u'| - R6 B6`.
pub struct WallCoefficients {
    /// One over length.
    pub b5: f64,
    /// One over length.
    pub b6: f64,
    /// Length over velocity squared over length squared.
    pub b7: f64,
    /// One over velocity squared.
    pub b8: f64,
}

pub fn coefficients(grains: &GrainProperties, solid_fraction: f64) -> Coefficients {
    let f = grains.functions(solid_fraction);
    let by_length = grains.density * grains.diameter;
    Coefficients {
        c1: by_length * f.c1.value(),
        c2: grains.density * f.c2.value(),
        c3: by_length * f.c3.value(),
        c4: by_length * f.c4.value(),
        c6: grains.density / grains.diameter * f.c6.value(),
    }
}

pub fn reduced(grains: &GrainProperties, solid_fraction: f64, pressure: f64) -> ReducedCoefficients {
    let f = grains.functions(solid_fraction);
    let log_slope = |c: Jet| c.slope() / c.value();
    ReducedCoefficients {
        b1: log_slope(f.c1) - 0.5 * log_slope(f.c2),
        b2: log_slope(f.conduction) - 1.5 * log_slope(f.c2),
        b3: f.c6.value() / f.conduction.value() / grains.diameter.powi(2),
        b4: -f.c1.value() * f.c2.value() / f.conduction.value() * grains.density / pressure,
    }
}

pub fn wall_coefficients(
    wall: &Wall,
    grains: &GrainProperties,
    solid_fraction: f64,
    pressure: f64,
) -> WallCoefficients {
    let f = grains.functions(solid_fraction);
    let bumps = wall.bump_integrals(grains, f.contact);
    let (c1, c2, k, gradient) = (f.c1.value(), f.c2.value(), f.conduction.value(), bumps.gradient.value());
    let energy = c2 * c2 / k * grains.density / pressure;
    WallCoefficients {
        b5: c2 * bumps.slip / (c1 - c2 * gradient) / grains.diameter,
        b6: bumps.loss * c2 / k / grains.diameter,
        b7: energy * bumps.slip / grains.diameter,
        b8: energy * gradient,
    }
}
