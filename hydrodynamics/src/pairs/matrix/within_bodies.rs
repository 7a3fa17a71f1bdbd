//! Pairs within rigid bodies.

use crate::bodies::matrix::{BodyMatrix, SphereResistance, cross_matrix};
use crate::bodies::members::Members;
use crate::bodies::present::PresentBodies;
use crate::pairs::matrix::sparse::{LaneGroup, MatrixPart, PairMatrix, ROWS};
use domain::{Tensor, Vector};

/// Place of a pair in a block of the matrix: its row, its group and its lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct StoredPair {
    pub row: u32,
    pub group: u32,
    pub lane: u32,
}

/// A pair of a row and another sphere of the same body.
pub struct PairWithinBody<'a> {
    pub group: &'a LaneGroup<f64>,
    pub lane: usize,
}

impl PairWithinBody<'_> {
    /// Row of the other sphere, which may be a ghost.
    pub fn other(&self) -> usize {
        self.group.others[self.lane] as usize
    }

    /// Resistance of the sphere of the row to motions of the other.
    fn blocks(&self) -> SphereResistance {
        let (group, lane) = (self.group, self.lane);
        let z = Vector::from_array(group.axis.map(|component| component[lane]));
        let along = Tensor::from_cols(z * z.x, z * z.y, z * z.z);
        let axial = |across: f64, excess: f64| Tensor::from_diagonal(Vector::splat(across)) + along * excess;
        let crossed = cross_matrix(z);
        let [turning, moving] = [-group.yb[0][lane], group.yb[1][lane]].map(|factor| crossed * factor);
        SphereResistance {
            force: [axial(group.ya[lane], group.axial_excess[lane]), turning],
            torque: [moving, axial(group.yc[lane], group.spin_excess[lane])],
        }
    }
}

impl PairMatrix<f64> {
    /// Resistance of the sphere of a row to its own motion.
    fn own_blocks(&self, row: usize) -> SphereResistance {
        self.parts[row / ROWS].own[row % ROWS].blocks()
    }

    /// Pairs of a row within its body.
    fn within_body(&self, row: usize) -> impl Iterator<Item = PairWithinBody<'_>> {
        self.parts[row / ROWS].within_body((row % ROWS) as u32)
    }
}

impl MatrixPart<f64> {
    /// Pairs of a row of the block within its body.
    fn within_body(&self, row: u32) -> impl Iterator<Item = PairWithinBody<'_>> {
        let until = |row: u32| self.within_bodies.partition_point(|pair| pair.row < row);
        let marked = &self.within_bodies[until(row)..until(row + 1)];
        marked.iter().map(|pair| PairWithinBody { group: &self.groups[pair.group as usize], lane: pair.lane as usize })
    }
}

/// Stiff pairs, and the bodies of the spheres.
pub struct StiffOfBodies<'a> {
    pub stiff: &'a PairMatrix<f64>,
    pub present: &'a PresentBodies,
}

impl StiffOfBodies<'_> {
    /// Loads of stiff pairs on the sphere of a row, as loads on its body, in the motions of that body alone.
    pub fn of_member(&self, members: &Members, row: usize) -> BodyMatrix {
        let arm = members.arm(row);
        let mut sum = BodyMatrix::of_members([arm; 2], &self.stiff.own_blocks(row));
        for pair in self.stiff.within_body(row) {
            sum += BodyMatrix::of_members([arm, self.present.arm(pair.other())], &pair.blocks());
        }
        sum
    }
}
