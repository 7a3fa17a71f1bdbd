//! Bending and twisting of a bond.
//!
//! A bond that resists bending is an Euler-Bernoulli beam that is clamped in both of its spheres. With the unit vector
//! `n` from the first centre to the second, and at each end `k` the axes `a, b, c` that are fixed in the sphere and are
//! alike at both ends of an unloaded bond, `a` along it, its energy is
//!
//! ```text
//! 2 EI/l [5 - 3 n.(a1 + a2) + a1.a2]  +  GJ/2l [1 + a1.a2 - b1.b2 - c1.c2]
//! ```
//!
//! The first part is `2 EI/l (f1.f1 + f1.f2 + f2.f2)` with `f = a - n`, the exact energy of a beam with small rotations
//! of its ends relative to the line of centres. The second is `GJ/2l (1 + cos s) (1 - cos t)` for the twist `t` and the
//! angle `s` between the two `a`. Both are polynomials in the axes, so that loads are smooth at any rotation.

use domain::{Quaternion, Vector};

/// Axes of a beam at one end: along it, and two across.
#[derive(Debug, Clone, Copy)]
pub struct BeamEnd {
    along: Vector,
    across: [Vector; 2],
}

impl BeamEnd {
    /// The axes z, x and y of an orientation.
    pub fn of(orientation: Quaternion) -> Self {
        let across = [Vector::X, Vector::Y].map(|axis| orientation.rotate(axis));
        Self { along: orientation.axis(), across }
    }
}

/// A beam between two spheres.
#[derive(Debug, Clone, Copy)]
pub struct BentBeam {
    /// Vector from the first centre to the second.
    pub separation: Vector,
    /// Axes at the first sphere and at the second.
    pub ends: [BeamEnd; 2],
    /// `EI/l` and `GJ/l`: torques over angles, with the length at rest.
    pub stiffness: BeamStiffness,
}

/// Stiffness of a beam of a length: torque over the angle between its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamStiffness {
    /// `EI/l`
    pub bending: f64,
    /// `GJ/l`
    pub twisting: f64,
}

/// Loads on one of two bonded spheres.
#[derive(Debug, Clone, Copy, Default)]
pub struct BondLoad {
    /// Force.
    pub force: Vector,
    /// Torque.
    pub torque: Vector,
}

/// Velocities of one bonded sphere relative to another, and angular velocities of both.
#[derive(Debug, Clone, Copy)]
pub struct BondMotion {
    /// Velocity of the other sphere minus that of the sphere.
    pub relative: Vector,
    /// Angular velocities of the sphere and of the other.
    pub angular_velocities: [Vector; 2],
}

impl BentBeam {
    /// Energies of bending and of twisting.
    pub fn energies(&self) -> [f64; 2] {
        let BeamStiffness { bending, twisting } = self.stiffness;
        let n = self.separation.normalize();
        let [first, second] = self.ends;
        // The differences of unit vectors keep the digits of small angles.
        let [f1, f2] = [first.along - n, second.along - n];
        let bent = 2.0 * bending * (f1.length_squared() + f1.dot(f2) + f2.length_squared());
        let turned: f64 = (0..2).map(|k| (first.across[k] - second.across[k]).length_squared()).sum();
        let apart = (first.along - second.along).length_squared();
        [bent, 0.25 * twisting * (turned - apart).max(0.0)]
    }

    /// Loads on the sphere at one end, 0 or 1: minus the derivatives of the energy by its displacement and rotation.
    pub fn load(&self, end: usize) -> BondLoad {
        let BeamStiffness { bending, twisting } = self.stiffness;
        let (distance, n) = (self.separation.length(), self.separation.normalize());
        let [own, other] = [self.ends[end], self.ends[1 - end]];
        let both = own.along + other.along;
        let shear = (both - both.dot(n) * n) * (6.0 * bending / distance);
        let bent = 2.0 * bending * own.along.cross(3.0 * n - other.along);
        let turned: Vector = (0..2).map(|k| own.across[k].cross(other.across[k])).sum();
        let twisted = 0.5 * twisting * (turned - own.along.cross(other.along));
        BondLoad { force: if end == 0 { -shear } else { shear }, torque: bent + twisted }
    }
}

impl BeamStiffness {
    /// Loads on a sphere by motions of both, for a stiffness that is a resistance, at a vector to the other sphere:
    /// those of a straight beam along it.
    pub fn resist(&self, separation: Vector, motion: &BondMotion) -> BondLoad {
        let (distance, n) = (separation.length(), separation.normalize());
        let turning = n.cross(motion.relative) / distance;
        let [own, other] = motion.angular_velocities;
        let [bent, bent_other] = [own, other].map(|spin| spin - spin.dot(n) * n - turning);
        let force = (bent + bent_other).cross(n) * (-6.0 * self.bending / distance);
        let torque = (2.0 * bent + bent_other) * (-2.0 * self.bending);
        BondLoad { force, torque: torque - n * (self.twisting * (own - other).dot(n)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Random, Tensor};

    /// A beam with ends rotated at random by angles up to about `size`.
    fn beam(random: &mut Random, size: f64) -> BentBeam {
        let n = Quaternion::random(random);
        let mut vector = || (random.point() - Vector::splat(0.5)) * 2.0 * size;
        let ends = [vector(), vector()].map(|turn| BeamEnd::of(Quaternion::exp(turn) * n));
        BentBeam { separation: 2.2 * n.axis(), ends, stiffness: BeamStiffness { bending: 3.0, twisting: 1.7 } }
    }

    fn turned(end: BeamEnd, by: Vector) -> BeamEnd {
        let turn = Quaternion::exp(by);
        BeamEnd { along: turn.rotate(end.along), across: end.across.map(|axis| turn.rotate(axis)) }
    }

    fn energy(beam: &BentBeam) -> f64 {
        beam.energies().iter().sum()
    }

    /// Loads are minus the derivatives of the energy at any rotations, and balance each other.
    #[test]
    fn loads_are_derivatives_of_the_energy() {
        let (mut random, step) = (Random::new(3, 1), 1e-5);
        for _ in 0..20 {
            let beam = beam(&mut random, 2.0);
            let loads = [0, 1].map(|end| beam.load(end));
            for axis in [Vector::X, Vector::Y, Vector::Z] {
                let moved = |by: f64| energy(&BentBeam { separation: beam.separation + axis * by, ..beam });
                let slope = (moved(step) - moved(-step)) / (2.0 * step);
                assert!((slope + loads[1].force.dot(axis)).abs() < 1e-7, "{slope}");
                for end in 0..2 {
                    let rotated = |by: f64| {
                        let mut other = beam;
                        other.ends[end] = turned(beam.ends[end], axis * by);
                        energy(&other)
                    };
                    let slope = (rotated(step) - rotated(-step)) / (2.0 * step);
                    assert!((slope + loads[end].torque.dot(axis)).abs() < 1e-7, "{end}: {slope}");
                }
            }
            assert_eq!(loads[0].force, -loads[1].force);
            let torque = loads[0].torque + loads[1].torque + beam.separation.cross(loads[1].force);
            assert!(torque.length() < 1e-13, "{torque}");
        }
    }

    /// A rotation of everything changes no energy and rotates the loads.
    #[test]
    fn the_frame_does_not_matter() {
        let mut random = Random::new(5, 1);
        let beam = beam(&mut random, 1.0);
        let turn = Vector::new(0.4, -2.0, 1.1);
        let about = Quaternion::exp(turn);
        let rotated = BentBeam {
            separation: about.rotate(beam.separation),
            ends: beam.ends.map(|end| turned(end, turn)),
            ..beam
        };
        assert!((energy(&beam) - energy(&rotated)).abs() < 1e-13);
        for end in 0..2 {
            let [before, after] = [beam.load(end), rotated.load(end)];
            assert!((about.rotate(before.force) - after.force).length() < 1e-13);
            assert!((about.rotate(before.torque) - after.torque).length() < 1e-13);
        }
    }

    /// For small rotations a beam in a plane has the stiffness `EI/l^3 [12, 6 l; 4 l^2, 2 l^2]` of an Euler-Bernoulli
    /// beam, and `GJ/l` in twist; the resistance of the implicit steps is the same matrix.
    #[test]
    fn small_loads_are_those_of_an_euler_bernoulli_beam() {
        let (length, small) = (2.2, 1e-6);
        let straight = BentBeam {
            separation: Vector::Z * length,
            ends: [BeamEnd::of(Quaternion::IDENTITY); 2],
            stiffness: BeamStiffness { bending: 3.0, twisting: 1.7 },
        };
        let [ei, gj] = [3.0 * length, 1.7 * length];
        let sideways = BentBeam { separation: Vector::new(small, 0.0, length), ..straight }.load(0);
        assert!((sideways.force.x / small - 12.0 * ei / length.powi(3)).abs() < 1e-5);
        assert!((sideways.torque.y / small - 6.0 * ei / length.powi(2)).abs() < 1e-5);
        let mut bent = straight;
        bent.ends[0] = turned(bent.ends[0], Vector::new(0.0, small, small));
        let [own, other] = [0, 1].map(|end| bent.load(end));
        assert!((own.torque.y / small + 4.0 * ei / length).abs() < 1e-5, "{own:?}");
        assert!((other.torque.y / small + 2.0 * ei / length).abs() < 1e-5, "{other:?}");
        assert!((own.torque.z / small + gj / length).abs() < 1e-5, "{own:?}");
        let motion = BondMotion {
            relative: Vector::new(small, 0.0, 0.0),
            angular_velocities: [Vector::new(0.0, small, small), Vector::ZERO],
        };
        let resisted = straight.stiffness.resist(straight.separation, &motion);
        assert!((resisted.force - sideways.force - own.force).length() < 1e-11 && resisted.force.x != 0.0);
        assert!((resisted.torque - sideways.torque - own.torque).length() < 1e-11);
    }

    /// The torques cancel the antisymmetric part of the first moment of the forces.
    #[test]
    fn the_first_moment_of_all_loads_is_symmetric() {
        let beam = beam(&mut Random::new(8, 1), 1.5);
        let loads = [0, 1].map(|end| beam.load(end));
        let cross = |t: Vector| Tensor::from_cols(t.cross(Vector::X), t.cross(Vector::Y), t.cross(Vector::Z));
        let (r, force) = (beam.separation, loads[0].force);
        let forces = Tensor::from_cols(r * force.x, r * force.y, r * force.z).transpose();
        let all = forces - cross(loads[0].torque + loads[1].torque) * 0.5;
        let difference = (all - all.transpose()).to_cols_array().into_iter().fold(0.0, |m: f64, e| m.max(e.abs()));
        assert!(difference < 1e-13, "{difference}");
    }
}
