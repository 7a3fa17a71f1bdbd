//! Pairs within rigid bodies.

use crate::bodies::matrix::BodyMatrix;
use crate::bodies::members::Members;
use crate::bodies::present::PresentBodies;
use crate::pairs::matrix::sparse::{LaneGroup, MatrixPart, PairMatrix, ROWS};
use crate::six_vector::SixVector;
use domain::Vector;

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

    /// Load on the sphere of the row due to the motion of the other.
    pub fn load(&self, motion: SixVector) -> SixVector {
        let (group, lane) = (self.group, self.lane);
        let z = Vector::from_array(group.axis.map(|component| component[lane]));
        let (u, o) = (motion.linear(), motion.angular());
        let along = z * (z.dot(u) * group.axial_excess[lane]);
        let spin = z * (z.dot(o) * group.spin_excess[lane]);
        let [turning, moving] = [o.cross(z) * group.yb[0][lane], z.cross(u) * group.yb[1][lane]];
        SixVector::new(u * group.ya[lane] + along + turning, o * group.yc[lane] + spin + moving)
    }
}

impl PairMatrix<f64> {
    /// Loads on the sphere of a row due to its own motion, or zero.
    pub fn own_load(&self, row: usize, motion: SixVector) -> SixVector {
        let [ux, uy, uz, ox, oy, oz] = motion.0;
        let block = self.parts.get(row / ROWS).map(|part| &part.own[row % ROWS]);
        SixVector(block.map_or([0.0; 6], |block| block.times([[ux, uy, uz], [ox, oy, oz]])))
    }

    /// Pairs of a row within its body.
    pub fn within_body(&self, row: usize) -> impl Iterator<Item = PairWithinBody<'_>> {
        self.parts.get(row / ROWS).into_iter().flat_map(move |part| part.within_body((row % ROWS) as u32))
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

/// Stiff pairs, and the bodies of the spheres, if there are any.
pub struct StiffOfBodies<'a> {
    pub stiff: &'a PairMatrix<f64>,
    pub present: Option<&'a PresentBodies>,
}

impl StiffOfBodies<'_> {
    /// Loads of stiff pairs on the sphere of a row, as loads on its body, in the motions of that body alone.
    pub fn of_member(&self, members: &Members, row: usize) -> BodyMatrix {
        let arm = members.arm(row);
        let mut sum = BodyMatrix::of_members([arm; 2], |motion| self.stiff.own_load(row, motion));
        if let Some(present) = self.present {
            for pair in self.stiff.within_body(row) {
                sum += BodyMatrix::of_members([arm, present.arm(pair.other())], |motion| pair.load(motion));
            }
        }
        sum
    }
}
