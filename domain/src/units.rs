//! Units in which numbers are about 1.

/// Largest power of two that is at most `|value|`; 1 for zero and numbers that are not normal. Multiplication and
/// division by it are exact.
#[must_use]
pub fn power_of_two(value: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    if value.is_normal() { f64::from_bits(value.to_bits() & EXPONENT) } else { 1.0 }
}

/// Internal units of length, viscosity and force for a problem of viscous flow given in any units, so that values in
/// `f32`, and high powers of lengths, stay within range. All are powers of two: conversions are exact, and a problem
/// whose numbers are about 1 is unchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// Unit of length, `l`.
    pub length: f64,
    /// Unit of viscosity, `mu`.
    pub viscosity: f64,
    /// Unit of force, `F`.
    pub force: f64,
}

impl Units {
    /// Units of the input.
    pub const ONE: Self = Self { length: 1.0, viscosity: 1.0, force: 1.0 };

    /// Units for a fluid and a range of radii: the unit of length is near their geometric mean. The unit of force
    /// is 1.
    #[must_use]
    pub fn of(viscosity: f64, [smallest, largest]: [f64; 2]) -> Self {
        let length = power_of_two(power_of_two(smallest).sqrt() * power_of_two(largest).sqrt());
        Self { length, viscosity: power_of_two(viscosity), ..Self::ONE }
    }

    /// The same with the unit of force near a given force.
    #[must_use]
    pub fn with_force(self, force: f64) -> Self {
        Self { force: power_of_two(force), ..self }
    }

    /// Unit of torques and stresslets, `F l`.
    #[must_use]
    pub fn torque(&self) -> f64 {
        self.force * self.length
    }

    /// Unit of velocities, `F / (mu l)`.
    #[must_use]
    pub fn velocity(&self) -> f64 {
        self.force / (self.viscosity * self.length)
    }

    /// Unit of angular velocities and rates of strain, `F / (mu l^2)`.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.velocity() / self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_the_largest_below() {
        let expected = [(1.0, 1.0), (1.99, 1.0), (-5.0, 4.0), (0.3, 0.25), (0.0, 1.0), (f64::INFINITY, 1.0)];
        for (value, power) in expected {
            assert!(power_of_two(value).to_bits() == f64::to_bits(power), "of {value}");
        }
        assert!(power_of_two(f64::NAN).to_bits() == 1.0_f64.to_bits());
        for exponent in -300..300 {
            let value = 10_f64.powi(exponent);
            let ratio = value / power_of_two(value);
            assert!((1.0..2.0).contains(&ratio), "{value:e} over its power is {ratio}");
        }
    }

    #[test]
    fn units_go_with_the_numbers() {
        let units = Units::of(1.0, [1.0, 1.9]);
        assert_eq!(units, Units::ONE);
        // 1e30 and the like have units whose products are normal numbers.
        for exponents in [[30, 30, -30], [-30, -30, 30], [30, -30, -30], [-30, 30, 30]] {
            let [length, viscosity, force] = exponents.map(|e| 10_f64.powi(e));
            let units = Units::of(viscosity, [length, 3.0 * length]).with_force(force);
            let velocity = force / (viscosity * length);
            for (unit, value) in [
                (units.torque(), force * length),
                (units.velocity(), velocity),
                (units.rate(), velocity / length),
                (units.length, length),
            ] {
                assert!(unit.is_normal() && (0.1..10.0).contains(&(value / unit)), "{value:e} in units of {unit:e}");
            }
        }
    }
}
