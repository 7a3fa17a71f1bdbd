//! Lubrication resistance of a sphere at a wall in the laboratory frame.

use domain::{Tensor, Traceless, Vector};

use crate::pair_factor::{LEVER, frame};
use crate::sphere_motion::{SphereLoads, SphereMotion};
use crate::wall_coefficients::{WallCoefficients, axial};
use crate::wall_table::WallFactors;

/// Lubrication resistance of a sphere at a wall. The resistance to its motion is `B B^T`, with 6 modes, the first of
/// which is the approach of the surfaces; the coupling of motions and rates of strain is stored separately.
#[derive(Debug, Clone, Copy)]
pub struct WallFactor {
    /// Columns `x`, `y`, and the unit vector `z` from the centre to the wall.
    frame: Tensor,
    factors: WallFactors,
    radius: f64,
}

impl WallFactor {
    /// Number of modes of a sphere at a wall.
    pub const MODES: usize = 6;

    /// From factors that include `sqrt(viscosity * radius)`; `axis` points to the wall.
    pub(crate) fn new(factors: &WallFactors, axis: Vector, radius: f64) -> Self {
        Self { frame: frame(axis), factors: *factors, radius }
    }

    /// Unit vector from the centre to the wall.
    pub fn axis(&self) -> Vector {
        self.frame.z_axis
    }

    /// The resistance as coefficients of tensors of the axis.
    pub fn coefficients(&self) -> WallCoefficients {
        WallCoefficients::of(&self.factors, self.radius)
    }

    /// `B^T` times a motion.
    pub fn modes(&self, motion: &SphereMotion) -> [f64; Self::MODES] {
        let to_frame = self.frame.transpose();
        let (u, o) = (to_frame * motion.velocity, to_frame * motion.angular_velocity * self.radius);
        let stretch = self.axis().dot(motion.strain_rate.tensor() * self.axis()) * self.radius;
        let parting = -u.z - LEVER * 1.5_f64.sqrt() * stretch;
        let factor = &self.factors.transverse.factor;
        let along = |mode: usize, u: f64, o: f64| factor[0][mode] * u + factor[1][mode] * o;
        [
            self.factors.axial.factor[0][0] * parting,
            self.factors.spin * o.z,
            along(0, u.x, o.y),
            along(1, u.x, o.y),
            along(0, u.y, -o.x),
            along(1, u.y, -o.x),
        ]
    }

    /// `B` times the amplitudes of the modes.
    pub fn loads(&self, modes: &[f64; Self::MODES]) -> SphereLoads {
        let factor = &self.factors.transverse.factor;
        let of = |row: usize, first: usize| factor[row][0] * modes[first] + factor[row][1] * modes[first + 1];
        let pull = self.factors.axial.factor[0][0] * modes[0];
        let force = Vector::new(of(0, 2), of(0, 4), -pull);
        let torque = Vector::new(-of(1, 4), of(1, 2), self.factors.spin * modes[1]) * self.radius;
        let moment = axial(self.axis()) * (-LEVER * pull * 1.5_f64.sqrt() / 3.0 * self.radius);
        SphereLoads { force: self.frame * force, torque: self.frame * torque, moment: Traceless::part_of(&moment) }
    }

    /// All loads by a motion, `R_lub` times it.
    pub fn resistance(&self, motion: &SphereMotion) -> SphereLoads {
        let coefficients = self.coefficients();
        let by_motion = coefficients.by_motion(self.axis(), [motion.velocity, motion.angular_velocity]);
        by_motion + coefficients.by_strain(self.axis(), motion.strain_rate)
    }
}
