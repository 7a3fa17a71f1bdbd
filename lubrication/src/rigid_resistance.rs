//! What resists the rigid motions of two near spheres, as a matrix.

use domain::Vector;

/// The blocks of `B B^T` by the two spheres of a pair. With the unit vector `z` from the smaller sphere to the larger,
/// a load on one by the motion of another is
///
/// ```text
/// F = (Z zz + T (1 - zz)) U + C Omega x z,        L = (S zz + R (1 - zz)) Omega + C' z x U
/// ```
///
/// with `C'` that of the block across the diagonal.
#[derive(Debug, Clone, Copy)]
pub struct RigidResistance {
    pub(crate) axis: Vector,
    /// `Z`, by the sphere that feels the load and the one that moves, as all that follows.
    pub(crate) along: [[f64; 2]; 2],
    /// `T`
    pub(crate) across: [[f64; 2]; 2],
    /// `S`
    pub(crate) spin: [[f64; 2]; 2],
    /// `R`
    pub(crate) roll: [[f64; 2]; 2],
    /// `C`
    pub(crate) coupling: [[f64; 2]; 2],
}

impl RigidResistance {
    /// The diagonal of a sphere's own block: forces by velocities, then torques by angular velocities.
    pub fn diagonal(&self, sphere: usize) -> [f64; 6] {
        let square = self.axis * self.axis;
        let mix = |along: f64, across: f64| along * square + across * (Vector::ONE - square);
        let force = mix(self.along[sphere][sphere], self.across[sphere][sphere]);
        let torque = mix(self.spin[sphere][sphere], self.roll[sphere][sphere]);
        [force.x, force.y, force.z, torque.x, torque.y, torque.z]
    }

    /// The matrix from velocity and angular velocity of one sphere to force and torque on one, by rows.
    pub fn block(&self, load: usize, motion: usize) -> [[f64; 6]; 6] {
        let z = self.axis.to_array();
        let mut rows = [[0.0; 6]; 6];
        let corners = [(0, &self.along, &self.across), (3, &self.spin, &self.roll)];
        for (corner, along, across) in corners.map(|(c, z, t)| (c, z[load][motion], t[load][motion])) {
            for i in 0..3 {
                for j in 0..3 {
                    rows[corner + i][corner + j] = (along - across) * z[i] * z[j];
                }
                rows[corner + i][corner + i] += across;
            }
        }
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            // Omega x z, and z x U.
            rows[i][3 + j] = self.coupling[load][motion] * z[k];
            rows[j][3 + i] = -self.coupling[load][motion] * z[k];
            rows[3 + i][j] = -self.coupling[motion][load] * z[k];
            rows[3 + j][i] = self.coupling[motion][load] * z[k];
        }
        rows
    }
}
