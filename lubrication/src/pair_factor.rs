//! The factor `B` of one pair's lubrication resistance, `R = B B^T`.

use std::f64::consts::FRAC_1_SQRT_2;

use domain::{Tensor, Traceless, Vector};

use crate::pair_motion::{PairLoads, PairMotion};
use crate::root::Roots;

/// Velocity of a sphere's pole per radius and unit axial strain, `sqrt(2/3)`.
const LEVER: f64 = 0.816496580927726;

/// The factor `B` of one near pair: 22 modes, of which the first is the approach of the surfaces.
#[derive(Debug, Clone, Copy)]
pub struct PairFactor {
    /// Columns `x`, `y`, and the unit vector `z` from the smaller sphere to the larger one.
    frame: Tensor,
    /// Position in the pair of the smaller and the larger sphere.
    order: [usize; 2],
    /// Larger radius over the smaller one.
    ratio: f64,
    roots: Roots,
    /// Smaller radius.
    radius: f64,
}

/// Motions or loads in the frame of the pair, by block, as in `Blocks` but with gap coordinates `(w, c, e1, e2)`.
#[derive(Debug, Clone, Copy, Default)]
struct Components {
    axial: [f64; 4],
    spin: [f64; 2],
    transverse: [[f64; 6]; 2],
    planar: [[f64; 2]; 2],
}

impl PairFactor {
    /// Number of modes of a pair.
    pub const MODES: usize = 22;

    /// From roots for radii 1 and `ratio`, which carry `sqrt(viscosity * radius)`; `axis` points from the smaller sphere to the larger.
    pub(crate) fn new(roots: &Roots, axis: Vector, order: [usize; 2], [radius, ratio]: [f64; 2]) -> Self {
        Self { frame: frame(axis), order, ratio, roots: *roots, radius }
    }

    /// `B^T` times a motion.
    pub fn modes(&self, motion: &PairMotion) -> [f64; Self::MODES] {
        let parts = self.components(motion);
        let mut modes = [0.0; Self::MODES];
        adjoint(&self.roots.axial, &parts.axial, &mut modes[..4]);
        adjoint(&self.roots.spin, &parts.spin, &mut modes[4..6]);
        adjoint(&self.roots.transverse, &parts.transverse[0], &mut modes[6..12]);
        adjoint(&self.roots.transverse, &parts.transverse[1], &mut modes[12..18]);
        adjoint(&self.roots.planar, &parts.planar[0], &mut modes[18..20]);
        adjoint(&self.roots.planar, &parts.planar[1], &mut modes[20..]);
        modes
    }

    /// `B` times the amplitudes of the modes.
    pub fn loads(&self, modes: &[f64; Self::MODES]) -> PairLoads {
        self.assembled(&Components {
            axial: apply(&self.roots.axial, &modes[..4]),
            spin: apply(&self.roots.spin, &modes[4..6]),
            transverse: [apply(&self.roots.transverse, &modes[6..12]), apply(&self.roots.transverse, &modes[12..18])],
            planar: [apply(&self.roots.planar, &modes[18..20]), apply(&self.roots.planar, &modes[20..])],
        })
    }

    /// Motions along the unit tensors of the frame, lengths in units of the smaller radius.
    fn components(&self, motion: &PairMotion) -> Components {
        let mut parts = Components::default();
        let mut axial = [[0.0; 2]; 2];
        for (k, sphere) in self.order.into_iter().enumerate() {
            let u = self.frame.transpose() * motion.velocity[sphere];
            let omega = self.frame.transpose() * motion.angular_velocity[sphere] * self.radius;
            let e = self.frame.transpose() * motion.strain_rate[sphere].tensor() * self.frame;
            let e = e * self.radius;
            axial[k] = [u.z, 1.5_f64.sqrt() * e.z_axis.z];
            parts.spin[k] = omega.z;
            for (plane, values) in [[u.x, omega.y, e.z_axis.x], [u.y, -omega.x, e.z_axis.y]].into_iter().enumerate() {
                parts.transverse[plane][k] = values[0];
                parts.transverse[plane][2 + k] = values[1];
                parts.transverse[plane][4 + k] = 2.0_f64.sqrt() * values[2];
            }
            parts.planar[0][k] = FRAC_1_SQRT_2 * (e.x_axis.x - e.y_axis.y);
            parts.planar[1][k] = 2.0_f64.sqrt() * e.y_axis.x;
        }
        let [[first, first_strain], [second, second_strain]] = axial;
        let opening = second - first - LEVER * (first_strain + self.ratio * second_strain);
        let mean = (first + self.ratio * second) / (1.0 + self.ratio);
        parts.axial = [opening, mean, first_strain, second_strain];
        parts
    }

    /// The transpose of `components`.
    fn assembled(&self, parts: &Components) -> PairLoads {
        let mut loads = PairLoads::default();
        let [opening, mean, first_moment, second_moment] = parts.axial;
        let forces = [mean / (1.0 + self.ratio) - opening, mean * self.ratio / (1.0 + self.ratio) + opening];
        let moments = [first_moment - LEVER * opening, second_moment - LEVER * self.ratio * opening];
        for (k, sphere) in self.order.into_iter().enumerate() {
            let [across, aside] = parts.transverse;
            loads.force[sphere] = self.frame * Vector::new(across[k], aside[k], forces[k]);
            loads.torque[sphere] = self.frame * Vector::new(-aside[2 + k], across[2 + k], parts.spin[k]) * self.radius;
            let (along, normal) = (moments[k] * 1.5_f64.sqrt() / 3.0, parts.planar[0][k] * FRAC_1_SQRT_2);
            let (xz, yz, xy) =
                (across[4 + k] * FRAC_1_SQRT_2, aside[4 + k] * FRAC_1_SQRT_2, parts.planar[1][k] * FRAC_1_SQRT_2);
            let moment = Tensor::from_cols(
                Vector::new(normal - along, xy, xz),
                Vector::new(xy, -normal - along, yz),
                Vector::new(xz, yz, 2.0 * along),
            );
            loads.moment[sphere] = Traceless::part_of(&(self.frame * moment * self.frame.transpose() * self.radius));
        }
        loads
    }
}

/// Right-handed axes with the given third one, which turn smoothly with it away from one direction.
fn frame(z: Vector) -> Tensor {
    if z.z < -0.999 {
        let mirrored = frame(-z);
        return Tensor::from_cols(mirrored.y_axis, mirrored.x_axis, z);
    }
    let scale = 1.0 / (1.0 + z.z);
    let x = Vector::new(1.0 - z.x * z.x * scale, -z.x * z.y * scale, -z.x);
    let y = Vector::new(-z.x * z.y * scale, 1.0 - z.y * z.y * scale, -z.y);
    Tensor::from_cols(x, y, z)
}

fn apply<const N: usize>(root: &[[f64; N]; N], modes: &[f64]) -> [f64; N] {
    root.map(|row| row.iter().zip(modes).map(|(l, g)| l * g).sum())
}

fn adjoint<const N: usize>(root: &[[f64; N]; N], motion: &[f64; N], modes: &mut [f64]) {
    for (row, u) in root.iter().zip(motion) {
        modes.iter_mut().zip(row).for_each(|(mode, l)| *mode += l * u);
    }
}
