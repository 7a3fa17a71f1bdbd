//! Boundary conditions of a box along its axes.

use crate::Vector;

/// Boundary conditions at the faces of a box. The special axis is z; code that accepts another one from a user
/// rotates vectors and tensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundaries {
    /// Periodic along all axes.
    #[default]
    Periodic,
    /// No-slip walls at `z = 0` and `z = Lz`; periodic along x and y.
    Walls,
    /// A no-slip wall at `z = 0` and unbounded fluid above it, where `Lz` is about the height of the particles;
    /// periodic along x and y.
    Wall,
    /// Unbounded fluid along z, where `Lz` is about the extent of the particles; periodic along x and y.
    OpenAlongZ,
    /// Unbounded fluid; the edges are about the extent of the particles.
    Open,
}

impl Boundaries {
    /// Whether the box is periodic along an axis: 0, 1 and 2 for x, y and z.
    #[inline]
    pub fn is_periodic(self, axis: usize) -> bool {
        match self {
            Self::Periodic => true,
            Self::Open => false,
            Self::Walls | Self::Wall | Self::OpenAlongZ => axis < 2,
        }
    }

    /// Number of walls: the first at `z = 0`, the second at `z = Lz`.
    pub fn walls(self) -> usize {
        match self {
            Self::Walls => 2,
            Self::Wall => 1,
            Self::Periodic | Self::OpenAlongZ | Self::Open => 0,
        }
    }

    /// 1 for each periodic axis, else 0.
    pub(crate) fn repeats(self) -> Vector {
        Vector::from_array(std::array::from_fn(|axis| f64::from(u8::from(self.is_periodic(axis)))))
    }
}
