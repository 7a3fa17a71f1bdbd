//! Rates of strain of flows along walls.

use domain::{Traceless, Vector};
use std::ops::Add;

/// A rate of strain that is uniform, or grows with z as that of a flow which a pressure gradient drives between walls across z.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrainRate {
    /// At `z = 0`.
    pub at_zero: Traceless,
    /// By how much the components xz and yz grow with z.
    pub slope: [f64; 2],
}

impl StrainRate {
    /// The same everywhere.
    pub fn uniform(strain_rate: Traceless) -> Self {
        Self { at_zero: strain_rate, slope: [0.0; 2] }
    }

    /// Whether it is.
    pub fn is_uniform(&self) -> bool {
        self.slope.iter().all(|&slope| slope == 0.0)
    }

    /// At a height.
    pub fn at(&self, z: f64) -> Traceless {
        self.at_zero + self.beyond(z)
    }

    /// By how much it is more at a height than at zero.
    pub fn beyond(&self, z: f64) -> Traceless {
        let [xz, yz] = self.slope;
        Traceless([0.0, 0.0, xz * z, 0.0, yz * z])
    }

    /// By how much a flow along planes of equal z turns more after such a height.
    pub fn turning(&self, height: f64) -> Vector {
        let [along_x, along_y] = self.slope.map(|slope| slope * height);
        Vector::new(-along_y, along_x, 0.0)
    }

    /// Half of the second derivative along z of a flow along planes of equal z.
    pub fn half_curvature(&self) -> Vector {
        let [along_x, along_y] = self.slope;
        Vector::new(along_x, along_y, 0.0)
    }

    /// In other units, of which these are so many to one of a rate and one of a length.
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
