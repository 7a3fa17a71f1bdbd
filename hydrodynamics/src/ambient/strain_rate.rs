//! Strain rates of flows along walls.

use domain::{Traceless, Vector};
use std::ops::Add;

/// A strain rate that is uniform, or varies linearly with z as in pressure-driven flow between walls across z.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrainRate {
    /// Strain rate at `z = 0`.
    pub at_zero: Traceless,
    /// Derivatives of the components xz and yz with respect to z.
    pub slope: [f64; 2],
}

impl StrainRate {
    /// Uniform strain rate.
    pub fn uniform(strain_rate: Traceless) -> Self {
        Self { at_zero: strain_rate, slope: [0.0; 2] }
    }

    /// Whether the strain rate is uniform.
    pub fn is_uniform(&self) -> bool {
        self.slope.iter().all(|&slope| slope == 0.0)
    }

    /// Strain rate at a height.
    pub fn at(&self, z: f64) -> Traceless {
        self.at_zero + self.beyond(z)
    }

    /// Difference of the strain rate at a height from that at zero.
    pub fn beyond(&self, z: f64) -> Traceless {
        let [xz, yz] = self.slope;
        Traceless([0.0, 0.0, xz * z, 0.0, yz * z])
    }

    /// Change of the angular velocity of the flow over a height.
    pub fn turning(&self, height: f64) -> Vector {
        let [along_x, along_y] = self.slope.map(|slope| slope * height);
        Vector::new(-along_y, along_x, 0.0)
    }

    /// Half of the second derivative of the flow with respect to z.
    pub fn half_curvature(&self) -> Vector {
        let [along_x, along_y] = self.slope;
        Vector::new(along_x, along_y, 0.0)
    }

    /// The strain rate in other units of rate and length.
    #[must_use]
    pub fn in_units(&self, rate: f64, length: f64) -> Self {
        Self { at_zero: self.at_zero * (1.0 / rate), slope: self.slope.map(|slope| slope * length / rate) }
    }
}

impl Add for StrainRate {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let slope = [0, 1].map(|k| self.slope[k] + other.slope[k]);
        Self { at_zero: self.at_zero + other.at_zero, slope }
    }
}
