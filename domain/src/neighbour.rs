//! Entries of neighbour lists.

use crate::PeriodicBox;

/// A neighbour of a particle: its row among local particles and ghosts, and the lattice steps to its nearest image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Neighbour {
    /// Row of the neighbour.
    pub row: u32,
    /// Lattice steps added to the neighbour's position.
    pub steps: [i8; 3],
}

/// Enumeration of the images that neighbours can be, so that an entry of a list is the number of an image above the
/// bits of a row: half the memory of a [`Neighbour`].
#[derive(Debug, Clone, Default)]
pub(crate) struct Images {
    /// Largest number of steps along each axis.
    most: [i32; 3],
    /// Number of bits of the row.
    bits: u32,
    /// Lattice steps of each image, in the order of their numbers.
    steps: Vec<[i8; 3]>,
}

impl Images {
    /// Images within a distance of a box, for two positions inside of it.
    pub fn new(cell: &PeriodicBox, distance: f64) -> Self {
        let most = most_steps(cell, distance);
        let along = |axis: usize| -most[axis]..=most[axis];
        let steps: Vec<[i8; 3]> = along(0)
            .flat_map(|x| along(1).flat_map(move |y| along(2).map(move |z| [x, y, z].map(|step| step as i8))))
            .collect();
        let bits = steps.len().next_power_of_two().trailing_zeros();
        Self { most, bits: (u32::BITS - bits).min(u32::BITS - 1), steps }
    }

    /// Whether all images within a distance of a box are included.
    pub fn reach(&self, cell: &PeriodicBox, distance: f64) -> bool {
        most_steps(cell, distance).iter().zip(self.most).all(|(&needed, most)| needed <= most)
    }

    /// # Panics
    ///
    /// If the rows do not fit beside the number of images: 134 million fit in a box that is longer than the lists'
    /// reach.
    pub fn check_rows(&self, rows: usize) {
        let most = 1_u64 << self.bits;
        assert!(rows as u64 <= most, "a rank has {rows} particles and ghosts, and room for {most}: take more ranks");
    }

    /// Value that lattice steps add to an entry.
    #[inline(always)]
    pub fn shift(&self, steps: [i32; 3]) -> u32 {
        let [_, y, z] = self.most.map(|most| 2 * most + 1);
        let number = steps[0].wrapping_mul(y).wrapping_add(steps[1]).wrapping_mul(z).wrapping_add(steps[2]);
        (number as u32) << self.bits
    }

    /// Entry of a particle in the box itself.
    #[inline(always)]
    pub fn entry(&self, row: u32) -> u32 {
        self.shift(self.most) | row
    }

    /// The row of an entry.
    #[inline(always)]
    pub fn row(&self, entry: u32) -> u32 {
        entry & ((1 << self.bits) - 1)
    }

    /// Entry with its image shifted and another row.
    #[inline(always)]
    pub fn moved(&self, entry: u32, row: u32, shift: u32) -> u32 {
        (entry - self.row(entry)).wrapping_add(shift) | row
    }

    /// Number of an entry's image.
    #[inline(always)]
    pub fn number(&self, entry: u32) -> usize {
        (entry >> self.bits) as usize
    }

    /// Neighbour that an entry represents.
    #[inline(always)]
    pub fn neighbour(&self, entry: u32) -> Neighbour {
        Neighbour { row: self.row(entry), steps: self.steps[self.number(entry)] }
    }

    /// Lattice steps of all images, in the order of their numbers.
    pub fn steps(&self) -> impl Iterator<Item = [i32; 3]> + '_ {
        self.steps.iter().map(|steps| steps.map(i32::from))
    }
}

/// Largest number of lattice steps along each axis between images within a distance.
fn most_steps(cell: &PeriodicBox, distance: f64) -> [i32; 3] {
    let edges = (cell.coordinate_stretch() * distance / cell.edges()).ceil();
    std::array::from_fn(|axis| if cell.is_periodic(axis) { edges[axis] as i32 } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Boundaries, Vector};

    #[test]
    fn entries_are_what_they_stand_for() {
        let flat = PeriodicBox::new(Vector::new(10.0, 3.0, 0.9)).unwrap();
        let layer = flat.with_boundaries(Boundaries::OpenAlongZ).unwrap();
        for (cell, most) in [(flat, [1, 1, 3]), (layer, [1, 1, 0])] {
            let images = Images::new(&cell, 2.0);
            assert_eq!(images.most, most);
            images.check_rows(1 << 26);
            for (number, steps) in images.steps().enumerate() {
                let entry = images.moved(images.entry(77), 1 << 20, images.shift(steps));
                let found = images.neighbour(entry);
                assert_eq!((found.row, found.steps.map(i32::from), images.number(entry)), (1 << 20, steps, number));
                let back = steps.map(|step| -step);
                assert_eq!(images.moved(entry, 5, images.shift(back)), images.entry(5));
            }
            assert!(images.reach(&cell, 2.0) && !images.reach(&cell, 12.0));
        }
    }

    #[test]
    #[should_panic(expected = "take more ranks")]
    fn rows_beyond_the_bits_are_refused() {
        Images::new(&PeriodicBox::new(Vector::splat(10.0)).unwrap(), 2.0).check_rows((1 << 27) + 1);
    }
}
