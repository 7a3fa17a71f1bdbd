//! Overlaps of spheres at given positions.

use domain::{PeriodicBox, Vector, fold_pairs};
use std::fmt::{Display, Formatter};

/// Overlapping spheres: number of pairs, and the deepest overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlaps {
    /// Number of overlapping pairs.
    pub pairs: u64,
    /// Indices, from 0, of the two spheres with the deepest overlap.
    pub deepest: [u32; 2],
    /// Depth of that overlap, over the smaller radius.
    pub depth: f64,
}

/// Tolerance of round-off for touching spheres, over the longest edge.
const ROUND_OFF: f64 = 1e-12;

impl Overlaps {
    /// Overlaps of all spheres in a box, at positions inside it; `None` if no spheres overlap. All spheres have to be
    /// on this rank. Pairs of rows that are joined do not count.
    pub fn find(
        cell: &PeriodicBox,
        positions: &[Vector],
        radii: &[f64],
        are_joined: impl Fn([u32; 2]) -> bool + Sync,
    ) -> Option<Self> {
        let cutoff = 2.0 * radii.iter().copied().fold(0.0, f64::max);
        if cutoff == 0.0 {
            return None;
        }
        let least = ROUND_OFF * cell.edges().max_element();
        let count = |found: &mut Option<Self>, rows: [u32; 2], separation: Vector| {
            let [a, b] = rows.map(|row| radii[row as usize]);
            let overlap = a + b - separation.length();
            if overlap > least && !are_joined(rows) {
                let one = Self { pairs: 1, deepest: rows, depth: overlap / a.min(b) };
                *found = Some(found.map_or(one, |others| others.and(one)));
            }
        };
        fold_pairs(cell, positions, cutoff, || None, count).into_iter().flatten().reduce(Self::and)
    }

    /// Union of two sets of overlaps; of equally deep ones, the pair with the lower indices is kept.
    fn and(self, other: Self) -> Self {
        let key = |o: &Self| (-o.depth, o.deepest);
        let deepest = if key(&self) <= key(&other) { self } else { other };
        Self { pairs: self.pairs + other.pairs, ..deepest }
    }
}

impl Display for Overlaps {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { pairs, deepest: [i, j], depth } = self;
        write!(f, "spheres {i} and {j}, counted from 0, overlap by {depth:.3} radii of the smaller")?;
        if *pairs > 1 { write!(f, ", the deepest of {pairs} pairs that overlap") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(positions: &[[f64; 3]], radii: &[f64]) -> Option<Overlaps> {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let positions: Vec<Vector> = positions.iter().map(|&p| Vector::from_array(p)).collect();
        Overlaps::find(&cell, &positions, radii, |_| false)
    }

    #[test]
    fn the_deepest_overlap_is_named_across_the_sides_of_the_box() {
        let positions = [[0.5, 5.0, 5.0], [5.0, 5.0, 5.0], [6.5, 5.0, 5.0], [9.5, 5.0, 5.0]];
        let overlaps = found(&positions, &[1.0, 1.0, 1.0, 0.5]).unwrap();
        assert_eq!((overlaps.pairs, overlaps.deepest), (2, [0, 3]));
        assert!((overlaps.depth - 1.0).abs() < 1e-12, "{overlaps}");
        assert!(overlaps.to_string().contains("spheres 0 and 3, counted from 0, overlap by 1.000 radii"));
    }

    #[test]
    fn spheres_at_one_point_overlap_wholly() {
        let overlaps = found(&[[1.0; 3], [1.0; 3]], &[1.0, 1.0]).unwrap();
        assert!((overlaps.depth - 2.0).abs() < 1e-12);
    }

    #[test]
    fn touching_spheres_do_not_overlap() {
        assert_eq!(found(&[[0.1, 0.0, 0.0], [2.1, 0.0, 0.0]], &[1.0, 1.0]), None);
        assert_eq!(found(&[], &[]), None);
    }
}
