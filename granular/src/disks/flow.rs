//! The flow of the liquid, which drags the disks and is not changed by them.

/// The liquid's velocity along x as a function of y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DiskFlow {
    /// At rest, in a periodic cell.
    Still,
    /// `rate (y - Ly/2)`, with Lees-Edwards images.
    Shear {
        /// Velocity gradient.
        rate: f64,
    },
    /// `4 peak (y / Ly) (1 - y / Ly)`, repeated with the period `Ly`: driven by a body force, without walls.
    Poiseuille {
        /// Velocity at mid-height.
        peak: f64,
    },
}

/// Velocity profile of a flow in a cell of given height: one quadratic.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct VelocityProfile {
    coefficients: [f64; 3],
    height: f64,
    /// The height, for a profile that is repeated there; otherwise 0.
    period: f64,
    /// Shear rate of the lattice of images.
    pub(super) lattice_rate: f64,
    /// Largest velocity gradient.
    pub(super) steepest: f64,
}

impl DiskFlow {
    pub(super) fn profile(&self, height: f64) -> VelocityProfile {
        let still = VelocityProfile { height, ..VelocityProfile::default() };
        match *self {
            Self::Still => still,
            Self::Shear { rate } => {
                let coefficients = [-0.5 * rate * height, rate, 0.0];
                VelocityProfile { coefficients, lattice_rate: rate, steepest: rate.abs(), ..still }
            }
            Self::Poiseuille { peak } => {
                let slope = 4.0 * peak / height;
                let coefficients = [0.0, slope, -slope / height];
                VelocityProfile { coefficients, period: height, steepest: slope.abs(), ..still }
            }
        }
    }

    /// Velocity along x at a height `y` less than one period outside a cell of this height.
    pub fn velocity(&self, y: f64, height: f64) -> f64 {
        self.profile(height).speed(y)
    }

    /// Shear rate that defines strain: the mean one, or that of the whole rise of a Poiseuille flow.
    pub fn rate(&self, height: f64) -> f64 {
        match *self {
            Self::Still => 0.0,
            Self::Shear { rate } => rate,
            Self::Poiseuille { peak } => 2.0 * peak / height,
        }
    }
}

impl VelocityProfile {
    /// Velocity along x at a height less than one period outside the cell.
    #[inline(always)]
    pub(super) fn speed(&self, y: f64) -> f64 {
        let (y, [a, b, c]) = (self.inside(y), self.coefficients);
        a + y * (b + y * c)
    }

    #[inline(always)]
    pub(super) fn slope(&self, y: f64) -> f64 {
        let [_, b, c] = self.coefficients;
        b + 2.0 * c * self.inside(y)
    }

    /// A height at which the liquid is at rest.
    pub(super) fn rest_height(&self) -> f64 {
        if self.period > 0.0 { 0.0 } else { 0.5 * self.height }
    }

    pub(super) fn curvature(&self) -> f64 {
        2.0 * self.coefficients[2]
    }

    #[inline(always)]
    fn inside(&self, y: f64) -> f64 {
        y + if y < 0.0 { self.period } else { 0.0 } - if y >= self.height { self.period } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_are_what_they_say() {
        let shear = DiskFlow::Shear { rate: 0.5 }.profile(10.0);
        assert_eq!((shear.speed(5.0), shear.speed(11.0), shear.slope(3.0)), (0.0, 3.0, 0.5));
        let shear = DiskFlow::Shear { rate: 0.5 };
        assert_eq!((shear.velocity(5.0, 10.0), shear.velocity(11.0, 10.0)), (0.0, 3.0));
        let pipe = DiskFlow::Poiseuille { peak: 2.0 }.profile(10.0);
        assert_eq!((pipe.speed(0.0), pipe.speed(5.0)), (0.0, 2.0));
        assert_eq!((pipe.speed(-2.0), pipe.speed(12.0)), (pipe.speed(8.0), pipe.speed(2.0)));
        assert_eq!((pipe.slope(0.0), pipe.slope(5.0), pipe.steepest), (0.8, 0.0, 0.8));
        assert!((pipe.curvature() + 0.16).abs() < 1e-16);
    }
}
