//! Axes in another order.

use crate::{Tensor, Traceless, Vector};

/// The axes of space named in another cyclic order, so that a box whose special axis is x or y has it along z: a rotation,
/// after which right-handed systems are still right-handed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Turn {
    /// The axis that becomes the first.
    first: usize,
}

impl Turn {
    /// The turn after which an axis, 0, 1 or 2, is the last.
    pub fn to_last(axis: usize) -> Self {
        Self { first: (axis + 1) % 3 }
    }

    /// The turn that undoes this one.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { first: (3 - self.first) % 3 }
    }

    /// A list of an entry for each axis after the turn.
    pub fn list<T: Copy>(self, of_axes: [T; 3]) -> [T; 3] {
        std::array::from_fn(|axis| of_axes[(axis + self.first) % 3])
    }

    /// A vector after the turn.
    pub fn vector(self, vector: Vector) -> Vector {
        Vector::from_array(self.list(vector.to_array()))
    }

    /// A tensor after the turn.
    pub fn tensor(self, tensor: &Tensor) -> Tensor {
        let columns = [tensor.x_axis, tensor.y_axis, tensor.z_axis].map(|column| self.vector(column));
        let [x, y, z] = self.list(columns);
        Tensor::from_cols(x, y, z)
    }

    /// A symmetric tensor without trace after the turn.
    pub fn traceless(self, tensor: Traceless) -> Traceless {
        if self.first == 0 { tensor } else { Traceless::part_of(&self.tensor(&tensor.tensor())) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_a_rotation_that_can_be_undone() {
        let (v, w) = (Vector::new(1.0, 2.0, 3.0), Vector::new(-0.5, 0.7, 0.2));
        let tensor = Tensor::from_cols_array(&[1.0, 2.0, 3.0, 4.0, -3.0, 6.0, 7.0, 8.0, 2.0]);
        for axis in 0..3 {
            let turn = Turn::to_last(axis);
            assert_eq!(turn.vector(v).z.to_bits(), v[axis].to_bits());
            assert_eq!(turn.inverse().vector(turn.vector(v)), v);
            assert_eq!(turn.vector(v.cross(w)), turn.vector(v).cross(turn.vector(w)));
            assert!((turn.tensor(&tensor) * turn.vector(v) - turn.vector(tensor * v)).length() < 1e-14);
            let strain = Traceless([0.1, 0.5, -0.2, -0.3, 0.05]);
            let back = turn.inverse().traceless(turn.traceless(strain));
            assert!(back.0.iter().zip(strain.0).all(|(a, b)| (a - b).abs() < 1e-15));
        }
        assert_eq!(Turn::to_last(2), Turn::default());
    }
}
