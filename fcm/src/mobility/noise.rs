//! Random motions whose covariance is the mobility.

use crate::mobility::loads::{Motion, angular_velocity};
use domain::parallel::FusedLoops;
use domain::{Random, RandomLanes, Tensor, Traceless, Vector};
use solver::{Complexes, Draw, MODES};

/// Source of the random numbers of one draw: the same numbers for the same modes and particles, on any number of
/// ranks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stream {
    /// Seed of the draw.
    seed: u64,
}

/// Random motions to draw, for the particles with these ids.
pub(crate) struct NoiseRequest<'a> {
    pub ids: &'a [u64],
    /// Relative error allowed in square roots that are found by iteration.
    pub tolerance: f64,
    pub stream: Stream,
}

/// Kinds of random numbers: of the grid's modes, and of particles.
const OF_FIELD: u64 = 1;
const OF_NEAR: u64 = 2;

impl Stream {
    /// Numbers of a draw, such as a step, by a seed.
    pub fn new(seed: u64, draw: u64) -> Self {
        Self { seed: Random::new(seed, draw).bits() }
    }

    /// Generator for a kind of numbers and the name of a mode or particle.
    pub fn of(self, kind: u64, name: u64) -> Random {
        Random::new(self.seed_of(kind), name)
    }

    /// Seed of the numbers of a kind.
    pub fn seed_of(self, kind: u64) -> u64 {
        self.seed ^ kind.wrapping_mul(0xa076_1d64_78bd_642f)
    }

    /// Seed of the numbers of the grid's modes.
    pub(crate) fn seed_of_field(self) -> u64 {
        self.seed_of(OF_FIELD)
    }

    /// Seed of the numbers of particles.
    pub(crate) fn seed_of_particles(self) -> u64 {
        self.seed_of(OF_NEAR)
    }

    /// Eleven normal numbers of a particle.
    pub(crate) fn of_particle(self, id: u64) -> ParticleComponents {
        let mut random = self.of(OF_NEAR, id);
        let mut numbers = ParticleComponents::default();
        for pair in numbers.chunks_mut(2) {
            let normal = random.normal();
            pair.copy_from_slice(&normal[..pair.len()]);
        }
        numbers
    }
}

/// Many modes add little each to any velocity, so uniform numbers do.
impl Draw for Stream {
    #[inline(always)]
    fn draw(&self, modes: &[[i64; 3]; MODES]) -> Complexes {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let names = modes.map(|mode| {
            let [x, y, z] = mode.map(|m| (m + (1 << 20)) as u64);
            x << 42 | y << 21 | z
        });
        let mut random = RandomLanes::new(self.seed_of(OF_FIELD), &names);
        std::array::from_fn(|_| std::array::from_fn(|_| random.uniform_unit_variance().map(|number| half * number)))
    }
}

/// Components of a particle's motion or loads: three of the velocity, three of the angular velocity, and five of the
/// rate of strain in an orthonormal basis.
pub(crate) type ParticleComponents = [f64; COMPONENTS];

/// Number of components of a motion with dipoles.
pub(crate) const COMPONENTS: usize = 11;

/// Square root of 1.5.
const AXIAL: f64 = 1.224_744_871_391_589;

/// Components of a traceless tensor in the orthonormal basis.
pub(crate) fn orthonormal(tensor: Traceless) -> [f64; 5] {
    let [xx, xy, xz, yy, yz] = tensor.0;
    let root = std::f64::consts::SQRT_2;
    [-AXIAL * (xx + yy), (xx - yy) / root, root * xy, root * xz, root * yz]
}

/// Traceless tensor from its components in the orthonormal basis.
pub(crate) fn tensor([axial, planar, xy, xz, yz]: [f64; 5]) -> Traceless {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mean = -0.5 * axial / AXIAL;
    Traceless([mean + half * planar, half * xy, half * xz, mean - half * planar, half * yz])
}

/// Velocity, angular velocity and rate of strain as components, from a velocity and its gradient.
pub(crate) fn components(motion: &(Vector, Tensor)) -> ParticleComponents {
    let (velocity, gradient) = motion;
    let (rotation, strain) = (angular_velocity(gradient), orthonormal(Traceless::part_of(gradient)));
    let mut components = [0.0; COMPONENTS];
    components[..3].copy_from_slice(&velocity.to_array());
    components[3..6].copy_from_slice(&rotation.to_array());
    components[6..].copy_from_slice(&strain);
    components
}

/// Motion of particles from their components.
pub(crate) fn motion(components: &[ParticleComponents]) -> Motion {
    let (mut motion, mut loops) = (Motion::default(), FusedLoops::default());
    loops.mapped(&mut motion.velocities, components, |of_one| Vector::from_slice(of_one));
    loops.mapped(&mut motion.angular_velocities, components, |of_one| Vector::from_slice(&of_one[3..]));
    loops.mapped(&mut motion.strain_rates, components, |&[_, _, _, _, _, _, strain @ ..]| tensor(strain));
    loops.run();
    motion
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_is_orthonormal() {
        for k in 0..5 {
            let mut unit = [0.0; 5];
            unit[k] = 1.0;
            let there = tensor(unit);
            assert!((there.contract(there) - 1.0).abs() < 1e-14);
            let back = orthonormal(there);
            assert!((0..5).all(|l| (back[l] - unit[l]).abs() < 1e-14), "{back:?}");
        }
    }
}
