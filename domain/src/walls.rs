//! Walls of a box as seen from its spheres.

use crate::{PeriodicBox, Vector};

/// A wall as seen from a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToWall {
    /// 0 for the wall at `z = 0`, 1 for the one at `z = Lz`.
    pub wall: usize,
    /// Unit vector to the wall, along z.
    pub axis: Vector,
    /// Distance of the wall along that vector; negative beyond the wall.
    pub distance: f64,
}

impl PeriodicBox {
    /// Axis of the gradient of a shear flow `u_x`: z between walls, else y.
    pub fn gradient_axis(&self) -> usize {
        if self.boundaries().walls() > 0 { 2 } else { 1 }
    }

    /// Position of the box mapped linearly to the heights at which a sphere of a given radius fits between the walls,
    /// so that a uniform distribution stays uniform.
    pub(crate) fn off_walls(&self, place: Vector, radius: f64) -> Vector {
        if self.boundaries().walls() == 0 {
            return place;
        }
        let height = self.edges().z;
        Vector { z: radius + place.z * (1.0 - 2.0 * radius / height), ..place }
    }

    /// Walls of the box as seen from a position.
    pub fn to_walls(&self, place: Vector) -> impl Iterator<Item = ToWall> {
        let below = ToWall { wall: 0, axis: -Vector::Z, distance: place.z };
        let above = ToWall { wall: 1, axis: Vector::Z, distance: self.edges().z - place.z };
        [below, above].into_iter().take(self.boundaries().walls())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Boundaries;

    #[test]
    fn walls_are_seen_from_inside_and_from_beyond() {
        let cell = PeriodicBox::new(Vector::new(4.0, 5.0, 6.0)).unwrap();
        let seen = |boundaries: Boundaries, z: f64| {
            let cell = cell.with_boundaries(boundaries).unwrap();
            cell.to_walls(Vector::new(1.0, 2.0, z)).map(|to| (to.wall, to.axis.z, to.distance)).collect::<Vec<_>>()
        };
        assert_eq!(seen(Boundaries::Walls, 1.5), [(0, -1.0, 1.5), (1, 1.0, 4.5)]);
        assert_eq!(seen(Boundaries::Walls, 6.5), [(0, -1.0, 6.5), (1, 1.0, -0.5)]);
        assert_eq!(seen(Boundaries::Wall, 9.0), [(0, -1.0, 9.0)]);
        assert_eq!(seen(Boundaries::Periodic, 1.5), []);
    }
}
