//! Motion of bonds in a substep.

use super::bond::{Bond, Tied};
use crate::rotation;
use domain::parallel::copied;
use domain::{Comm, Particles, Vector};

/// Bonds of a rank's particles, with `N` velocities of each: the present one and past ones.
pub struct MovingBonds<const N: usize>(Vec<MovingBond<N>>);

/// A bond whose other end has velocities relative to its particle.
struct MovingBond<const N: usize> {
    separation: Vector,
    length: f64,
    velocities: [Vector; N],
    /// Angular velocities of the particle; zero if the bond does not resist bending.
    angular_velocities: [Vector; N],
}

impl<const N: usize> MovingBonds<N> {
    /// No bonds.
    pub const NONE: Self = Self(Vec::new());

    /// The bonds of particles with velocities in the named columns. Collective.
    pub fn of(tied: &Tied, particles: &mut Particles, columns: [&str; N]) -> Self {
        let velocities = columns.map(|name| tied.present.extended(particles.vectors(name)).into_owned());
        let angular =
            rotation::angular(particles, columns).map(|names| names.map(|name| copied(particles.vectors(name))));
        let of_bond = |bond: &Bond| {
            let [own, other] = bond.rows;
            let velocities = velocities.each_ref().map(|list| list[other] - list[own]);
            let turning = angular.as_ref().filter(|_| bond.beam.is_some());
            let angular_velocities = turning.map_or([Vector::ZERO; N], |all| all.each_ref().map(|list| list[own]));
            MovingBond { separation: bond.separation, length: bond.length, velocities, angular_velocities }
        };
        Self(tied.list.iter().map(of_bond).collect())
    }

    /// Largest change of a bond's length, over that at rest, by displacements that are sums of `weights[k]` times
    /// velocity `k`; infinite if one is NaN. Collective.
    pub fn stretch(&self, weights: [f64; N], comm: &Comm) -> f64 {
        self.largest(comm, |bond| {
            let moved = bond.separation + sum(&bond.velocities, weights);
            (moved.length() - bond.separation.length()).abs() / bond.length
        })
    }

    /// Largest displacement of one end of a bond relative to the other, over the length at rest, plus the rotation of
    /// an end if it resists bending. Collective.
    pub fn displacement(&self, weights: [f64; N], comm: &Comm) -> f64 {
        self.largest(comm, |bond| {
            let [moved, turned] = [&bond.velocities, &bond.angular_velocities].map(|list| sum(list, weights).length());
            moved / bond.length + turned
        })
    }

    fn largest(&self, comm: &Comm, change: impl Fn(&MovingBond<N>) -> f64) -> f64 {
        // The maximum of floating-point numbers ignores NaN.
        let of_bond =
            |bond: &MovingBond<N>| Some(change(bond)).filter(|change| !change.is_nan()).unwrap_or(f64::INFINITY);
        let mut largest = [self.0.iter().map(of_bond).fold(0.0, f64::max)];
        comm.max(&mut largest);
        largest[0]
    }
}

/// Sum of `weights[k]` times vector `k`.
fn sum<const N: usize>(vectors: &[Vector; N], weights: [f64; N]) -> Vector {
    vectors.iter().zip(weights).fold(Vector::ZERO, |sum, (&vector, weight)| sum + vector * weight)
}
