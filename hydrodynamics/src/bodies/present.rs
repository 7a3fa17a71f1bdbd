//! Bodies of a rank's spheres and of the ghosts in their reach.

use crate::bodies::RigidBodies;
use domain::parallel::of_rows;
use domain::{Halo, Vector};

/// Body numbers and arms of a rank's spheres and ghosts.
pub struct PresentBodies {
    /// Number of the body plus one; zero for a free sphere.
    numbers: Vec<u64>,
    arms: Vec<Vector>,
}

/// Overlap up to which spheres of a body touch, over the distance of their centres.
const TOUCHING: f64 = 1e-3;

impl PresentBodies {
    /// Adds those of the ghosts of a halo. Collective.
    pub fn new(bodies: &RigidBodies, halo: &Halo) -> Self {
        let members = bodies.members();
        let number = |row: usize| members.body(row).map_or(0, |number| u64::from(number) + 1);
        let mut numbers = of_rows(members.spheres(), number);
        let mut arms = of_rows(members.spheres(), |row| members.arm(row));
        halo.extend(&mut numbers);
        halo.extend(&mut arms);
        Self { numbers, arms }
    }

    /// Whether two spheres are parts of one body, and not of a body and its image: the separation from the first to
    /// the second is nearly the difference of their arms.
    pub fn are_of_one(&self, [first, second]: [usize; 2], separation: Vector) -> bool {
        let number = self.numbers[first];
        let difference = self.arms[second] - self.arms[first] - separation;
        number > 0 && number == self.numbers[second] && difference.length() < 0.5 * separation.length()
    }

    /// Whether lubrication acts between two spheres with a gap between their surfaces: not if they are parts of one body
    /// and overlap.
    pub fn are_lubricated(&self, rows: [usize; 2], separation: Vector, gap: f64) -> bool {
        gap >= -TOUCHING * separation.length() || !self.are_of_one(rows, separation)
    }

    /// Arm of a sphere or a ghost.
    pub fn arm(&self, row: usize) -> Vector {
        self.arms[row]
    }
}
