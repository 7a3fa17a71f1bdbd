//! Particles that a user puts elsewhere.

use domain::{Particles, Quaternion, Vector};
use std::collections::HashMap;

/// New values of some particles, each with the particle's id: what a user has changed in a state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rearrangement {
    /// Places, inside the box or not.
    pub positions: Vec<(u64, Vector)>,
    /// Radii.
    pub radii: Vec<(u64, f64)>,
    /// Velocities, of particles with inertia.
    pub velocities: Vec<(u64, Vector)>,
    /// Angular velocities, of particles with inertia.
    pub angular_velocities: Vec<(u64, Vector)>,
    /// Orientations, of particles that have some.
    pub orientations: Vec<(u64, Quaternion)>,
}

impl Rearrangement {
    /// Puts values into a list that has one for each of `ids`, as far as they are among these.
    pub fn put<T: Copy>(values: &[(u64, T)], ids: &[u64], list: &mut [T]) {
        let rows: HashMap<u64, usize> = ids.iter().enumerate().map(|(row, &id)| (id, row)).collect();
        for (id, value) in values {
            if let Some(&row) = rows.get(id) {
                list[row] = *value;
            }
        }
    }

    /// Puts positions and velocities into particles with inertia.
    pub fn put_motions(&self, particles: &mut Particles) {
        let ids = particles.ids.clone();
        Self::put(&self.positions, &ids, &mut particles.positions);
        Self::put(&self.velocities, &ids, particles.vectors("velocity"));
        if !self.angular_velocities.is_empty() {
            Self::put(&self.angular_velocities, &ids, particles.vectors("angular_velocity"));
        }
    }

    /// Whether nothing changes.
    pub fn is_empty(&self) -> bool {
        let Self { positions, radii, velocities, angular_velocities, orientations } = self;
        positions.is_empty()
            && radii.is_empty()
            && velocities.is_empty()
            && angular_velocities.is_empty()
            && orientations.is_empty()
    }
}

/// The error of simulations of which a value can't be changed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RearrangementError {
    /// Velocities of particles without inertia.
    #[error(
        "spheres in Stokes flow have no velocities of their own: these follow from the positions; change positions"
    )]
    NoInertia,
    /// Radii that are those of the scene.
    #[error("radii of grains are those of the scene; change positions and velocities, or start another scene")]
    FixedRadii,
    /// Angular velocities of particles that do not turn.
    #[error("disks of this kind do not turn; change positions and velocities")]
    NoSpin,
    /// Disks that leave their plane.
    #[error("disk {0} would leave the plane z = 0; leave z of positions and velocities 0")]
    OffThePlane(u64),
    /// Orientations of particles without.
    #[error("particle {0} has no orientation; ask for them by species.orientation of the scene")]
    NoOrientation(u64),
    /// A quaternion that is no rotation.
    #[error("the orientation of particle {0} would be {1:?}; it needs a quaternion w, x, y, z other than 0")]
    NoRotation(u64, [f64; 4]),
    /// Spheres of rigid bodies.
    #[error("spheres of rigid bodies can't be put elsewhere one by one; start another scene with other bodies")]
    RigidBodies,
    /// A radius that is none.
    #[error("the radius of particle {0} would be {1}; it needs to be above 0")]
    Radius(u64, f64),
}
