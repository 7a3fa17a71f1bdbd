//! Bodies of a rank's spheres and of the ghosts in their reach.

use crate::bodies::RigidBodies;
use domain::parallel::of_rows;
use domain::{Halo, Vector};

/// Bodies and arms of a rank's spheres and ghosts.
///
/// The spheres of a body screen each other: each has a part of the drag that it has alone, by Kirkwood's estimate
/// `1 / c` with `c = 1 + sum a_k / r_k` over the others. The lubrication of two of them is the correction that they
/// need if they move alone, and in the body it is less by as much as the others carry the fluid at the pair along.
pub struct PresentBodies {
    /// Number of the body plus one; zero for a free sphere.
    numbers: Vec<u64>,
    arms: Vec<Vector>,
    /// `c` of the body of each sphere, with the root mean square of its distances.
    screening: Vec<f64>,
}

/// Overlap up to which spheres of a body touch, over the distance of their centres.
const TOUCHING: f64 = 1e-3;

impl PresentBodies {
    /// Adds those of the ghosts of a halo to spheres with these radii. Collective.
    pub fn new(bodies: &RigidBodies, radii: &[f64], halo: &Halo) -> Self {
        let members = bodies.members();
        let sums = bodies.sums_of(|row| {
            let (radius, arm) = (radii[row], members.arm(row));
            [radius, radius * radius, radius * arm.x, radius * arm.y, radius * arm.z, radius * arm.length_squared()]
        });
        let of_row = |row: usize| members.place(row).map_or(1.0, |place| screening(&sums.0[place].0));
        let number = |row: usize| members.body(row).map_or(0, |number| u64::from(number) + 1);
        let mut screening = of_rows(members.spheres(), of_row);
        let mut numbers = of_rows(members.spheres(), number);
        let mut arms = of_rows(members.spheres(), |row| members.arm(row));
        halo.extend(&mut screening);
        halo.extend(&mut numbers);
        halo.extend(&mut arms);
        Self { numbers, arms, screening }
    }

    /// Part of their lubrication that acts between two spheres of one body: 1 if they are the whole body, less if
    /// there are others, and 0 if they overlap. `None` if they are not of one body, as a sphere and the image of
    /// another: there the separation is not the difference of the arms.
    pub fn share(&self, [first, second]: [usize; 2], separation: Vector, radii: [f64; 2]) -> Option<f64> {
        let (number, distance) = (self.numbers[first], separation.length());
        let difference = self.arms[second] - self.arms[first] - separation;
        if number == 0 || number != self.numbers[second] || difference.length() >= 0.5 * distance {
            return None;
        }
        let [a, b] = radii;
        let alone = 1.0 + 2.0 * a * b / ((a + b) * distance);
        let are_apart = distance - a - b >= -TOUCHING * distance;
        Some(if are_apart { (alone / self.screening[first]).min(1.0) } else { 0.0 })
    }

    /// Arm of a sphere or a ghost.
    pub fn arm(&self, row: usize) -> Vector {
        self.arms[row]
    }
}

/// `1 + H / r`, with `H` the sum of the radii of the others, as a mean over the spheres of a body weighted by their
/// radii, and `r` the root mean square of the distances, from the sums of the powers `a` and `a^2` of the radii, of
/// `a s` and of `a s^2`.
fn screening(&[sum, squares, x, y, z, second]: &[f64; 6]) -> f64 {
    let (pairs, first) = (sum * sum - squares, Vector::new(x, y, z));
    let spread = 2.0 * (sum * second - first.length_squared());
    if pairs > 0.0 && spread > 0.0 { 1.0 + pairs / sum / (spread / pairs).sqrt() } else { 1.0 }
}
