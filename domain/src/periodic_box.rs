//! The periodic, possibly sheared box.

use crate::{Number, Vector};

/// Why a box is refused.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum BoxError {
    /// An edge that is not a positive length.
    #[error("box edge {axis} is {}; an edge needs to be positive and finite", Number(*length))]
    Edge {
        /// x, y or z.
        axis: char,
        /// What was given.
        length: f64,
    },
    /// A strain that is not a number.
    #[error("the box's strain is {}; it needs to be a finite number", Number(*.0))]
    Strain(f64),
}

/// A periodic box, with Lees-Edwards boundary conditions if it is sheared. Its lattice vectors are `(Lx, 0, 0)`, `(s
/// Ly, Ly, 0)` and `(0, 0, Lz)`: flow along x, gradient along y, vorticity along z, strain `s`. The lattices of `s` and
/// of `s + Lx/Ly` are the same, and `s` is kept in `[-Lx/(2 Ly), Lx/(2 Ly))`.
///
/// Positions in the box are named by lattice coordinates `(xi, eta, zeta) = (x - s y, y, z)`, each in `[0, L)` of its
/// axis, which are periodic one by one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodicBox {
    edges: Vector,
    strain: f64,
}

impl PeriodicBox {
    /// A box that is not sheared.
    pub fn new(edges: Vector) -> Result<Self, BoxError> {
        Self::sheared(edges, 0.0)
    }

    /// A box at a Lees-Edwards strain, which is reduced to its range.
    pub fn sheared(edges: Vector, strain: f64) -> Result<Self, BoxError> {
        for (axis, length) in "xyz".chars().zip(edges.to_array()) {
            if !(length.is_finite() && length > 0.0) {
                return Err(BoxError::Edge { axis, length });
            }
        }
        if !strain.is_finite() {
            return Err(BoxError::Strain(strain));
        }
        let period = edges.x / edges.y;
        let turns = (strain / period + 0.5).floor();
        Ok(Self { edges, strain: strain - turns * period })
    }

    /// The same box in other units of length: all lengths times `factor`, a power of two, so that nothing is rounded.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { edges: self.edges * factor, strain: self.strain }
    }

    /// Edge lengths.
    pub fn edges(&self) -> Vector {
        self.edges
    }

    /// The strain `s` of the lattice.
    pub fn strain(&self) -> f64 {
        self.strain
    }

    /// The volume, which a shear does not change.
    pub fn volume(&self) -> f64 {
        self.edges.x * self.edges.y * self.edges.z
    }

    /// The lattice vector of a whole number of steps along each edge.
    pub fn lattice(&self, steps: [i32; 3]) -> Vector {
        let y = f64::from(steps[1]) * self.edges.y;
        let x = f64::from(steps[0]) * self.edges.x;
        Vector::new(x + self.strain * y, y, f64::from(steps[2]) * self.edges.z)
    }

    /// Lattice coordinates of a position as lengths along each axis, not wrapped.
    pub fn lattice_coordinates(&self, position: Vector) -> Vector {
        Vector::new(position.x - self.strain * position.y, position.y, position.z)
    }

    /// The position inside the box that is an image of the given one, and the lattice steps that were taken out of it:
    /// `position = wrapped + lattice(steps)`.
    pub fn wrap(&self, position: Vector) -> (Vector, [i32; 3]) {
        let coordinates = self.lattice_coordinates(position);
        let mut steps = (coordinates / self.edges).floor();
        let mut wrapped = position - self.lattice(whole(steps));
        // Round-off can leave an image on the far face, or just below the near one.
        let again = (self.lattice_coordinates(wrapped) / self.edges).floor();
        if again != Vector::ZERO {
            steps += again;
            wrapped = position - self.lattice(whole(steps));
            let inside = self.lattice_coordinates(wrapped).clamp(Vector::ZERO, self.edges * (1.0 - f64::EPSILON));
            wrapped = Vector::new(inside.x + self.strain * inside.y, inside.y, inside.z);
        }
        (wrapped, whole(steps))
    }

    /// The shortest of the images of a separation, in a box whose strain is in its range.
    pub fn nearest_image(&self, separation: Vector) -> Vector {
        let mut d = separation;
        d.z -= (d.z / self.edges.z).round() * self.edges.z;
        let steps = (d.y / self.edges.y).round();
        d.y -= steps * self.edges.y;
        d.x -= steps * self.strain * self.edges.y;
        d.x -= (d.x / self.edges.x).round() * self.edges.x;
        if self.strain == 0.0 {
            return d;
        }
        // The rounding above is exact for a straight box only: an image one row up or down may be nearer.
        let mut nearest = d;
        for row in [-1.0, 1.0] {
            let mut e = d;
            e.y += row * self.edges.y;
            e.x += row * self.strain * self.edges.y;
            e.x -= (e.x / self.edges.x).round() * self.edges.x;
            if e.length_squared() < nearest.length_squared() {
                nearest = e;
            }
        }
        nearest
    }
}

fn whole(steps: Vector) -> [i32; 3] {
    steps.to_array().map(|s| s as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute_force(cell: &PeriodicBox, separation: Vector) -> f64 {
        let mut best = f64::INFINITY;
        for i in -4..=4 {
            for j in -4..=4 {
                for k in -4..=4 {
                    best = best.min((separation + cell.lattice([i, j, k])).length());
                }
            }
        }
        best
    }

    proptest! {
        #[test]
        fn wrapped_positions_are_inside_and_images(
            x in -50.0..50.0, y in -50.0..50.0, z in -50.0..50.0, strain in -2.0..2.0,
        ) {
            let cell = PeriodicBox::sheared(Vector::new(3.0, 4.0, 5.0), strain).unwrap();
            let position = Vector::new(x, y, z);
            let (wrapped, steps) = cell.wrap(position);
            let c = cell.lattice_coordinates(wrapped);
            prop_assert!(c.cmpge(Vector::splat(-1e-15)).all() && c.cmplt(cell.edges()).all());
            prop_assert!((wrapped + cell.lattice(steps) - position).length() < 1e-12);
        }

        #[test]
        fn the_nearest_image_is_the_shortest_of_all(
            x in -4.0..4.0, y in -4.0..4.0, z in -4.0..4.0, strain in -2.0..2.0,
        ) {
            let cell = PeriodicBox::sheared(Vector::new(3.0, 3.0, 3.0), strain).unwrap();
            let separation = Vector::new(x, y, z);
            let nearest = cell.nearest_image(separation).length();
            prop_assert!((nearest - brute_force(&cell, separation)).abs() < 1e-12);
        }
    }

    #[test]
    fn strains_a_period_apart_are_one_lattice() {
        let edges = Vector::new(2.0, 3.0, 1.0);
        let (a, b) =
            (PeriodicBox::sheared(edges, 0.25).unwrap(), PeriodicBox::sheared(edges, 0.25 + 4.0 / 3.0).unwrap());
        assert!((a.strain() - b.strain()).abs() < 1e-15);
        assert!(PeriodicBox::sheared(edges, 1.0 / 3.0).unwrap().strain() < 0.0, "the upper end belongs to the lower");
    }

    #[test]
    fn a_box_without_volume_is_refused_by_axis() {
        let error = PeriodicBox::new(Vector::new(1.0, 0.0, 1.0)).unwrap_err();
        assert_eq!(error, BoxError::Edge { axis: 'y', length: 0.0 });
        assert!(PeriodicBox::new(Vector::new(1.0, 1.0, f64::NAN)).is_err());
    }
}
