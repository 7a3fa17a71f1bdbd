//! Motions of bodies that are given.

use domain::Units;

/// Components of the motion of a body that are given, along the axes of the box, as of rollers and obstacles; the
/// others follow from the loads on the body. Motions are relative to the background flow at the centre of the body.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct GivenMotion {
    /// Given components of the velocity of the centre.
    pub velocity: [Option<f64>; 3],
    /// Given components of the angular velocity.
    pub angular_velocity: [Option<f64>; 3],
}

impl GivenMotion {
    /// The six components: velocity and angular velocity.
    pub(crate) fn components(&self) -> [Option<f64>; 6] {
        let [[a, b, c], [d, e, f]] = [self.velocity, self.angular_velocity];
        [a, b, c, d, e, f]
    }

    /// The motion in scaled units.
    pub(crate) fn in_units(self, units: &Units) -> Self {
        let times = |list: [Option<f64>; 3], unit: f64| list.map(|component| component.map(|value| value / unit));
        Self {
            velocity: times(self.velocity, units.velocity()),
            angular_velocity: times(self.angular_velocity, units.rate()),
        }
    }
}
