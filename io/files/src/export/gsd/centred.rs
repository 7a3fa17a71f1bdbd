//! Positions in a box centred at the origin, along the axes of the box.

use domain::{Particles, PeriodicBox, Vector};

/// Positions from `-L/2` up to, but excluding, `L/2` in the lattice coordinates of each axis, also after rounding to
/// single precision, and the lattice steps to the unwrapped positions.
pub(super) struct Centred {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) images: Vec<[i32; 3]>,
}

impl Centred {
    pub(super) fn new(cell: &PeriodicBox, particles: &Particles) -> Self {
        let all = particles.positions.iter().zip(&particles.steps);
        let (positions, images) = all.map(|(&position, &steps)| centred(cell, position, steps)).unzip();
        Self { positions, images }
    }
}

fn centred(cell: &PeriodicBox, position: Vector, mut steps: [i32; 3]) -> ([f64; 3], [i32; 3]) {
    let edges = cell.edges();
    let mut coordinates = (cell.lattice_coordinates(position) - cell.origin() - 0.5 * edges).to_array();
    for axis in 0..3 {
        // Rounding to single precision can reach the far face.
        if coordinates[axis] as f32 >= (0.5 * edges[axis]) as f32 {
            coordinates[axis] -= edges[axis];
            steps[axis] += 1;
        }
    }
    let [x, y, z] = coordinates;
    let [xz, yz] = cell.tilts();
    ([x + cell.strain() * y + xz * z, y + yz * z, z], steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_from_the_middle_of_the_tilted_box() {
        let cell = PeriodicBox::sheared(Vector::new(8.0, 4.0, 2.0), 0.5).unwrap();
        let middle = 0.5 * (cell.lattice([1, 0, 0]) + cell.lattice([0, 1, 0]) + cell.lattice([0, 0, 1]));
        assert_eq!(centred(&cell, middle, [3, 0, 0]), ([0.0; 3], [3, 0, 0]));
        assert_eq!(centred(&cell, Vector::ZERO, [0; 3]), ([-5.0, -2.0, -1.0], [0; 3]));
        assert_eq!(centred(&cell, middle + Vector::Y, [0; 3]), ([0.0, 1.0, 0.0], [0; 3]));
    }

    #[test]
    fn a_box_that_begins_elsewhere_is_centred_too() {
        let cell = PeriodicBox::new(Vector::splat(8.0)).unwrap().with_boundaries(domain::Boundaries::Open).unwrap();
        let cell = cell.with_extent(Vector::new(-100.0, 4.0, 0.0), Vector::splat(16.0)).unwrap();
        assert_eq!(centred(&cell, Vector::new(-93.0, 5.0, 8.0), [0; 3]), ([-1.0, -7.0, 0.0], [0; 3]));
    }

    #[test]
    fn none_is_on_the_far_face_after_rounding() {
        let cell = PeriodicBox::new(Vector::splat(8.0)).unwrap();
        let below = 8.0 * (1.0 - f64::EPSILON);
        assert_eq!(
            centred(&cell, Vector::new(below, 1.0, below), [0; 3]),
            ([0.0, -3.0, 0.0].map(|x| if x == 0.0 { below - 12.0 } else { x }), [1, 0, 1])
        );
    }
}
