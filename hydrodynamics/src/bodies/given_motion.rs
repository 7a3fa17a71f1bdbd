//! Motions of bodies that are given.

use domain::{Units, Vector};

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
    /// Whether no component is given.
    pub fn is_none(&self) -> bool {
        self.components().iter().all(Option::is_none)
    }

    /// The same motion relative to a flow with this velocity and angular velocity at the centre of the body.
    #[must_use]
    pub fn relative_to(self, velocity: Vector, angular_velocity: Vector) -> Self {
        let less = |given: [Option<f64>; 3], flow: Vector| {
            [0, 1, 2].map(|axis| given[axis].map(|component| component - flow[axis]))
        };
        Self {
            velocity: less(self.velocity, velocity),
            angular_velocity: less(self.angular_velocity, angular_velocity),
        }
    }

    /// The six components: velocity and angular velocity.
    pub(crate) fn components(&self) -> [Option<f64>; 6] {
        let [[a, b, c], [d, e, f]] = [self.velocity, self.angular_velocity];
        [a, b, c, d, e, f]
    }

    /// The motion with these six components: velocity and angular velocity.
    pub fn of_components([a, b, c, d, e, f]: [Option<f64>; 6]) -> Self {
        Self { velocity: [a, b, c], angular_velocity: [d, e, f] }
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
