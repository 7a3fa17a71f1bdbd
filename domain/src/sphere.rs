//! A single sphere in unbounded fluid: its volume and its resistances.

use std::f64::consts::PI;

/// Volume `4/3 pi a^3`.
#[inline]
pub fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// Force over velocity, `6 pi mu a` (Stokes 1851).
#[inline]
pub fn drag(viscosity: f64, radius: f64) -> f64 {
    6.0 * PI * viscosity * radius
}

/// Torque over angular velocity, `8 pi mu a^3`.
#[inline]
pub fn rotational_drag(viscosity: f64, radius: f64) -> f64 {
    8.0 * PI * viscosity * radius.powi(3)
}

/// Stresslet over strain rate, `20/3 pi mu a^3` (Batchelor & Green, J. Fluid Mech. 56, 401, 1972).
#[inline]
pub fn strain_resistance(viscosity: f64, radius: f64) -> f64 {
    20.0 / 3.0 * PI * viscosity * radius.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Per volume: five times the viscosity, twice Einstein's `5/2`, for a strain; six times for a rotation; and the
    /// drag is `9/2` times over the square of the radius.
    #[test]
    fn resistances_are_those_of_the_literature() {
        let (viscosity, radius) = (0.7, 1.3);
        assert!((strain_resistance(viscosity, radius) / volume(radius) - 5.0 * viscosity).abs() < 1e-14);
        assert!((rotational_drag(viscosity, radius) / volume(radius) - 6.0 * viscosity).abs() < 1e-14);
        assert!((drag(viscosity, radius) * radius * radius / volume(radius) - 4.5 * viscosity).abs() < 1e-14);
    }
}
