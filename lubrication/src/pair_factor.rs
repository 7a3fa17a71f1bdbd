//! Lubrication resistance of one pair in the laboratory frame.

use std::f64::consts::FRAC_1_SQRT_2;

use domain::{Tensor, Traceless, Vector};

use crate::block_factor::{BlockFactor, PairFactors};
use crate::pair_motion::{PairLoads, PairMotion};

/// Velocity of a sphere's pole per radius and unit axial strain, `sqrt(2/3)`.
pub(crate) const LEVER: f64 = 0.816496580927726;

/// Lubrication resistance of one near pair. The resistance to the spheres' motions is `B B^T`, with 12 modes, the
/// first of which is the approach of the surfaces; the coupling of motions and rates of strain is stored separately.
#[derive(Debug, Clone, Copy)]
pub struct PairFactor {
    /// Columns `x`, `y`, and the unit vector `z` from the smaller sphere to the larger one.
    frame: Tensor,
    /// Index in the pair of the smaller and the larger sphere.
    order: [usize; 2],
    /// Larger radius over the smaller one.
    ratio: f64,
    factors: PairFactors,
    /// Smaller radius.
    radius: f64,
}

/// Velocities and rates of strain of one block of the resistance, or the conjugate loads.
#[derive(Debug, Clone, Copy)]
struct BlockComponents<const N: usize> {
    u: [f64; N],
    e: [f64; 2],
}

/// Motions or loads in the frame of the pair, by block, as in [`PairFactors`].
#[derive(Debug, Clone, Copy, Default)]
struct PairComponents {
    axial: BlockComponents<2>,
    spin: [f64; 2],
    transverse: [BlockComponents<4>; 2],
    planar: [[f64; 2]; 2],
}

impl PairFactor {
    /// Number of modes of a pair.
    pub const MODES: usize = 12;

    /// From factors for radii 1 and `ratio`, which include `sqrt(viscosity * radius)`; `axis` points from the smaller
    /// sphere to the larger.
    pub(crate) fn new(factors: &PairFactors, axis: Vector, order: [usize; 2], [radius, ratio]: [f64; 2]) -> Self {
        Self { frame: frame(axis), order, ratio, factors: *factors, radius }
    }

    /// `B^T` times a motion.
    pub fn modes(&self, motion: &PairMotion) -> [f64; Self::MODES] {
        self.modes_of(&self.components(motion))
    }

    /// `B` times the amplitudes of the modes.
    pub fn loads(&self, modes: &[f64; Self::MODES]) -> PairLoads {
        self.assembled(&self.components_of(modes))
    }

    /// Loads in addition to those of the modes: by the rates of strain, and first moments by the velocities.
    pub fn strain_loads(&self, motion: &PairMotion) -> PairLoads {
        let parts = self.components(motion);
        self.assembled(&PairComponents {
            axial: self.factors.axial.coupled(&parts.axial),
            spin: [0.0; 2],
            transverse: parts.transverse.map(|block| self.factors.transverse.coupled(&block)),
            planar: parts.planar.map(|e| apply(&self.factors.planar, &e)),
        })
    }

    /// All loads by a motion, `R_lub` times it.
    pub fn resistance(&self, motion: &PairMotion) -> PairLoads {
        self.loads(&self.modes(motion)) + self.strain_loads(motion)
    }

    fn modes_of(&self, parts: &PairComponents) -> [f64; Self::MODES] {
        let mut modes = [0.0; Self::MODES];
        adjoint(&self.factors.axial.factor, &parts.axial.u, &mut modes[..2]);
        adjoint(&self.factors.spin, &parts.spin, &mut modes[2..4]);
        adjoint(&self.factors.transverse.factor, &parts.transverse[0].u, &mut modes[4..8]);
        adjoint(&self.factors.transverse.factor, &parts.transverse[1].u, &mut modes[8..]);
        modes
    }

    fn components_of(&self, modes: &[f64; Self::MODES]) -> PairComponents {
        let transverse =
            |modes: &[f64]| BlockComponents { u: apply(&self.factors.transverse.factor, modes), e: [0.0; 2] };
        PairComponents {
            axial: BlockComponents { u: apply(&self.factors.axial.factor, &modes[..2]), e: [0.0; 2] },
            spin: apply(&self.factors.spin, &modes[2..4]),
            transverse: [transverse(&modes[4..8]), transverse(&modes[8..])],
            planar: [[0.0; 2]; 2],
        }
    }

    /// Motions along the unit tensors of the frame, with lengths in units of the smaller radius.
    fn components(&self, motion: &PairMotion) -> PairComponents {
        let mut parts = self.rigid_components(motion.velocity, motion.angular_velocity);
        for (k, sphere) in self.order.into_iter().enumerate() {
            let e = self.frame.transpose() * motion.strain_rate[sphere].tensor() * self.frame;
            let e = e * self.radius;
            parts.axial.e[k] = 1.5_f64.sqrt() * e.z_axis.z;
            parts.transverse[0].e[k] = 2.0_f64.sqrt() * e.z_axis.x;
            parts.transverse[1].e[k] = 2.0_f64.sqrt() * e.z_axis.y;
            parts.planar[0][k] = FRAC_1_SQRT_2 * (e.x_axis.x - e.y_axis.y);
            parts.planar[1][k] = 2.0_f64.sqrt() * e.y_axis.x;
        }
        parts.axial.u[0] -= LEVER * (parts.axial.e[0] + self.ratio * parts.axial.e[1]);
        parts
    }

    /// The same for spheres without strain.
    fn rigid_components(&self, velocity: [Vector; 2], angular_velocity: [Vector; 2]) -> PairComponents {
        let (mut parts, to_frame) = (PairComponents::default(), self.frame.transpose());
        let mut along = [0.0; 2];
        for (k, sphere) in self.order.into_iter().enumerate() {
            let u = to_frame * velocity[sphere];
            let omega = to_frame * angular_velocity[sphere] * self.radius;
            along[k] = u.z;
            parts.spin[k] = omega.z;
            for (plane, (u, omega)) in [(u.x, omega.y), (u.y, -omega.x)].into_iter().enumerate() {
                parts.transverse[plane].u[k] = u;
                parts.transverse[plane].u[2 + k] = omega;
            }
        }
        let [first, second] = along;
        parts.axial.u = [second - first, (first + self.ratio * second) / (1.0 + self.ratio)];
        parts
    }

    /// Transpose of `components`.
    fn assembled(&self, parts: &PairComponents) -> PairLoads {
        let [force, torque] = self.forces(parts);
        PairLoads { force, torque, moment: self.moments(parts) }
    }

    /// Transpose of `rigid_components`: forces and torques.
    fn forces(&self, parts: &PairComponents) -> [[Vector; 2]; 2] {
        let mut loads = [[Vector::ZERO; 2]; 2];
        let [opening, mean] = parts.axial.u;
        let forces = [mean / (1.0 + self.ratio) - opening, mean * self.ratio / (1.0 + self.ratio) + opening];
        let [across, aside] = parts.transverse;
        for (k, sphere) in self.order.into_iter().enumerate() {
            loads[0][sphere] = self.frame * Vector::new(across.u[k], aside.u[k], forces[k]);
            let torque = Vector::new(-aside.u[2 + k], across.u[2 + k], parts.spin[k]);
            loads[1][sphere] = self.frame * torque * self.radius;
        }
        loads
    }

    fn moments(&self, parts: &PairComponents) -> [Traceless; 2] {
        let mut found = [Traceless::ZERO; 2];
        let BlockComponents { u: [opening, _], e } = parts.axial;
        let axial = [e[0] - LEVER * opening, e[1] - LEVER * self.ratio * opening];
        let [across, aside] = parts.transverse;
        for (k, sphere) in self.order.into_iter().enumerate() {
            let (along, normal) = (axial[k] * 1.5_f64.sqrt() / 3.0, parts.planar[0][k] * FRAC_1_SQRT_2);
            let [xz, yz, xy] = [across.e[k], aside.e[k], parts.planar[1][k]].map(|moment| moment * FRAC_1_SQRT_2);
            let moment = Tensor::from_cols(
                Vector::new(normal - along, xy, xz),
                Vector::new(xy, -normal - along, yz),
                Vector::new(xz, yz, 2.0 * along),
            );
            found[sphere] = Traceless::part_of(&(self.frame * moment * self.frame.transpose() * self.radius));
        }
        found
    }
}

impl<const N: usize> BlockFactor<N> {
    /// Coupled loads `C e` and `C^T u + M e`.
    fn coupled(&self, motion: &BlockComponents<N>) -> BlockComponents<N> {
        let mut moments = apply(&self.strain, &motion.e);
        adjoint(&self.coupling, &motion.u, &mut moments);
        BlockComponents { u: apply(&self.coupling, &motion.e), e: moments }
    }
}

impl<const N: usize> Default for BlockComponents<N> {
    fn default() -> Self {
        Self { u: [0.0; N], e: [0.0; 2] }
    }
}

/// Right-handed frame with the given third axis; it varies smoothly with that axis except near one direction.
pub(crate) fn frame(z: Vector) -> Tensor {
    if z.z < -0.999 {
        let mirrored = frame(-z);
        return Tensor::from_cols(mirrored.y_axis, mirrored.x_axis, z);
    }
    let scale = 1.0 / (1.0 + z.z);
    let x = Vector::new(1.0 - z.x * z.x * scale, -z.x * z.y * scale, -z.x);
    let y = Vector::new(-z.x * z.y * scale, 1.0 - z.y * z.y * scale, -z.y);
    Tensor::from_cols(x, y, z)
}

fn apply<const N: usize, const M: usize>(matrix: &[[f64; M]; N], x: &[f64]) -> [f64; N] {
    matrix.map(|row| row.iter().zip(x).map(|(l, x)| l * x).sum())
}

fn adjoint<const N: usize, const M: usize>(matrix: &[[f64; M]; N], x: &[f64; N], sums: &mut [f64]) {
    for (row, x) in matrix.iter().zip(x) {
        sums.iter_mut().zip(row).for_each(|(sum, l)| *sum += l * x);
    }
}
