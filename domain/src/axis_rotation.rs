//! Rotations that permute the axes.

use crate::{Tensor, Traceless, Vector};

/// Rotation to axes each of which is parallel or antiparallel to one of the old axes, so that a box whose special
/// axis is x or y has it along z. Right-handed systems remain right-handed, and the x axis is kept where possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisRotation {
    /// Old axis that becomes each new axis.
    axes: [usize; 3],
    /// Whether the new axis points against the old one.
    against: [bool; 3],
}

impl Default for AxisRotation {
    /// Identity.
    fn default() -> Self {
        Self { axes: [0, 1, 2], against: [false; 3] }
    }
}

impl AxisRotation {
    /// Rotation that makes an axis, 0, 1 or 2, the last: `(x, y, z)` becomes `(y, z, x)`, `(x, -z, y)` or
    /// `(x, y, z)`.
    pub fn to_last(axis: usize) -> Self {
        match axis {
            0 => Self { axes: [1, 2, 0], against: [false; 3] },
            1 => Self { axes: [0, 2, 1], against: [false, true, false] },
            _ => Self::default(),
        }
    }

    /// Whether it is the identity.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }

    /// Inverse rotation.
    #[must_use]
    pub fn inverse(self) -> Self {
        let mut inverse = Self::default();
        for (after, (&before, &against)) in self.axes.iter().zip(&self.against).enumerate() {
            (inverse.axes[before], inverse.against[before]) = (after, against);
        }
        inverse
    }

    /// List with one entry per axis, in the order of the new axes, without signs.
    pub fn list<T: Copy>(self, of_axes: [T; 3]) -> [T; 3] {
        self.axes.map(|before| of_axes[before])
    }

    /// Rotated vector or pseudovector.
    pub fn vector(self, vector: Vector) -> Vector {
        let turned = Vector::from_array(self.list(vector.to_array()));
        let signed = |axis: usize| if self.against[axis] { 0.0 - turned[axis] } else { turned[axis] };
        Vector::new(signed(0), signed(1), signed(2))
    }

    /// Rotated components of a vector, of which some may be missing.
    pub fn components(self, known: [Option<f64>; 3]) -> [Option<f64>; 3] {
        let turned = self.list(known);
        [0, 1, 2].map(|axis| turned[axis].map(|value| if self.against[axis] { 0.0 - value } else { value }))
    }

    /// Rotated position, in a box that has these edges afterwards: the box remains between 0 and the edge along each
    /// axis.
    pub fn place(self, place: Vector, edges: Vector) -> Vector {
        let turned = Vector::from_array(self.list(place.to_array()));
        let placed = |axis: usize| if self.against[axis] { edges[axis] - turned[axis] } else { turned[axis] };
        Vector::new(placed(0), placed(1), placed(2))
    }

    /// Rotated steps along the edges of a box.
    pub fn steps(self, steps: [i32; 3]) -> [i32; 3] {
        let turned = self.list(steps);
        [0, 1, 2].map(|axis| if self.against[axis] { turned[axis].wrapping_neg() } else { turned[axis] })
    }

    /// Rotated tensor.
    pub fn tensor(self, tensor: &Tensor) -> Tensor {
        let columns = [tensor.x_axis, tensor.y_axis, tensor.z_axis].map(|column| self.vector(column));
        let turned = self.list(columns);
        let signed = |axis: usize| if self.against[axis] { Vector::ZERO - turned[axis] } else { turned[axis] };
        Tensor::from_cols(signed(0), signed(1), signed(2))
    }

    /// Rotated symmetric traceless tensor.
    pub fn traceless(self, tensor: Traceless) -> Traceless {
        if self.is_none() { tensor } else { Traceless::part_of(&self.tensor(&tensor.tensor())) }
    }

    /// Whether each new axis points against the old one.
    pub fn against(self) -> [bool; 3] {
        self.against
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const V: Vector = Vector::new(1.0, 2.0, 3.0);
    const W: Vector = Vector::new(-0.5, 0.7, 0.2);

    #[test]
    fn a_turn_is_a_rotation_that_can_be_undone() {
        let tensor = Tensor::from_cols_array(&[1.0, 2.0, 3.0, 4.0, -3.0, 6.0, 7.0, 8.0, 2.0]);
        for axis in 0..3 {
            let turn = AxisRotation::to_last(axis);
            assert_eq!(turn.vector(V).z.to_bits(), V[axis].to_bits());
            assert_eq!(turn.inverse().vector(turn.vector(V)), V);
            assert_eq!(turn.inverse().inverse(), turn);
            assert_eq!(
                turn.vector(V.cross(W)),
                turn.vector(V).cross(turn.vector(W)),
                "right-handed, pseudovectors too"
            );
            assert!((turn.tensor(&tensor) * turn.vector(V) - turn.vector(tensor * V)).length() < 1e-14);
            assert_eq!(turn.inverse().tensor(&turn.tensor(&tensor)), tensor);
            let strain = Traceless([0.1, 0.5, -0.2, -0.3, 0.05]);
            let back = turn.inverse().traceless(turn.traceless(strain));
            assert!(back.0.iter().zip(strain.0).all(|(a, b)| (a - b).abs() < 1e-15));
            assert_eq!(turn.inverse().list(turn.list(['x', 'y', 'z'])), ['x', 'y', 'z']);
        }
        assert!(AxisRotation::to_last(2).is_none() && !AxisRotation::to_last(1).is_none());
    }

    #[test]
    fn what_is_along_x_stays_so_unless_x_is_the_axis() {
        assert_eq!(AxisRotation::to_last(1).vector(V), Vector::new(1.0, -3.0, 2.0));
        assert_eq!(AxisRotation::to_last(0).vector(V), Vector::new(2.0, 3.0, 1.0));
    }

    /// Positions in the box remain inside, with the same separations, and so do positions without periodicity.
    #[test]
    fn a_box_becomes_a_box() {
        let before = Vector::new(4.0, 5.0, 6.0);
        for axis in 0..3 {
            let turn = AxisRotation::to_last(axis);
            let after = Vector::from_array(turn.list(before.to_array()));
            let place = turn.place(V, after);
            assert!(place.cmpge(Vector::ZERO).all() && place.cmple(after).all());
            assert_eq!(turn.inverse().place(place, before), V);
            assert!((turn.place(V + W, after) - place - turn.vector(W)).length() < 1e-15);
            let steps = [1, -2, 3];
            let far = V + before * Vector::from_array(steps.map(f64::from));
            let whole = Vector::from_array(turn.steps(steps).map(f64::from));
            assert!((turn.place(far, after) - place - whole * after).length() < 1e-14);
        }
    }

    /// No zero becomes a negative zero.
    #[test]
    fn zero_stays_zero() {
        let turned = AxisRotation::to_last(1).vector(Vector::ZERO);
        assert!(turned.to_array().iter().all(|x| x.is_sign_positive()));
    }
}
