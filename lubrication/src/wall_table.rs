//! Table of the lubrication at a plane wall.

use std::sync::{Arc, OnceLock};

use crate::block_factor::{BlockFactor, difference, part, symmetric_root};
use crate::chebyshev::Chebyshev;
use crate::factor_table::{CLOSEST, GROWTH, NODES};
use crate::two_sphere::blocks::{change, from_pole_coordinates};
use crate::two_sphere::slip::SLIP_FUNCTIONS;
use crate::two_sphere::{SphereWall, SphereWallSlip};
use crate::wall_blocks::{ISOLATED, WallBlocks, slip_of_fcm};

/// Largest tabulated gap over the radius.
pub const FARTHEST: f64 = 1.5;
/// Numbers per gap.
const LANES: usize = 11;

/// Factors of `R_exact - R_FCM` of a sphere at a wall, for radius and viscosity 1, interpolated in the logarithm of
/// the gap: the resistance to motions is positive semi-definite, as between spheres.
#[derive(Debug)]
pub struct WallTable(GapPieces<LANES>);

/// Blocks of a sphere's resistance at a wall; `w` of the axial one is the separation velocity of the surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFactors {
    /// `w` and `e` along the normal.
    pub axial: BlockFactor<1, 1>,
    /// `L` for `Omega` along the normal.
    pub spin: f64,
    /// `(U, Omega)` and `e` along the wall.
    pub transverse: BlockFactor<2, 1>,
    /// `M` for `e` in the plane of the wall.
    pub planar: f64,
}

impl WallTable {
    /// Table, computed at the first call, then shared. Must not be called from a rayon task.
    pub fn get() -> Arc<Self> {
        static TABLE: OnceLock<Arc<WallTable>> = OnceLock::new();
        Arc::clone(TABLE.get_or_init(|| Arc::new(Self::compute(&SphereWall::get()))))
    }

    /// Factors at a gap from the closest to the farthest, for a resistance larger by `factor` squared.
    pub fn at(&self, gap: f64, factor: f64) -> WallFactors {
        wall_factors(self.0.at(gap), factor)
    }

    fn compute(exact: &SphereWall) -> Self {
        Self(GapPieces::through(|gap| lanes(exact, gap)))
    }
}

/// Loads by slip of a sphere held at a wall, the exact ones minus those of the force-coupling method, for radius and
/// viscosity 1, in the order of [`SlipFunction::ALL`](crate::two_sphere::SlipFunction::ALL).
#[derive(Debug)]
pub struct WallSlipTable(GapPieces<SLIP_FUNCTIONS>);

impl WallSlipTable {
    /// Table, computed at the first call, then shared. Must not be called from a rayon task.
    pub fn get() -> Arc<Self> {
        static TABLE: OnceLock<Arc<WallSlipTable>> = OnceLock::new();
        Arc::clone(TABLE.get_or_init(|| Arc::new(Self::compute(&SphereWallSlip::get()))))
    }

    /// Values at a gap from the closest to the farthest.
    pub fn at(&self, gap: f64) -> [f64; SLIP_FUNCTIONS] {
        self.0.at(gap)
    }

    fn compute(exact: &SphereWallSlip) -> Self {
        let difference = |gap: f64| {
            let (all, known) = (exact.at(gap), slip_of_fcm(1.0 + gap));
            std::array::from_fn(|k| all[k] - known[k])
        };
        Self(GapPieces::through(difference))
    }
}

/// Functions of the gap, in pieces of its logarithm.
#[derive(Debug)]
struct GapPieces<const N: usize>(Vec<Chebyshev<N, NODES>>);

impl<const N: usize> GapPieces<N> {
    fn through(values: impl Fn(f64) -> [f64; N]) -> Self {
        let count = (FARTHEST / CLOSEST).log(GROWTH).ceil() as i32;
        let edge = |k: i32| (CLOSEST * GROWTH.powi(k)).ln();
        let piece = |k: i32| {
            let samples = Chebyshev::<N, NODES>::nodes(edge(k), edge(k + 1)).map(|log| values(log.exp()));
            Chebyshev::through(edge(k), edge(k + 1), &samples)
        };
        Self((0..count).map(piece).collect())
    }

    fn at(&self, gap: f64) -> [f64; N] {
        let log = gap.ln();
        let piece = ((log - CLOSEST.ln()) / GROWTH.ln()).max(0.0) as usize;
        self.0[piece.min(self.0.len() - 1)].at(log)
    }
}

/// Numbers at one gap, without interpolation.
fn lanes(exact: &SphereWall, gap: f64) -> [f64; LANES] {
    let (exact, known) = (WallBlocks::exact(&exact.at(gap)), WallBlocks::of_fcm(1.0 + gap));
    let [force, torque, strain] = ISOLATED.map(f64::sqrt);
    let axial = change(&difference(&exact.axial, &known.axial), &from_pole_coordinates());
    let spin = symmetric_root(&[[(exact.spin[0][0] - known.spin[0][0]) / ISOLATED[1]]])[0][0];
    let planar = (exact.planar[0][0] - known.planar[0][0]) / ISOLATED[2];
    let axial = part(&axial, &[force], &[strain], symmetric_root);
    let transverse =
        part(&difference(&exact.transverse, &known.transverse), &[force, torque], &[strain], symmetric_root);
    let mut lanes = [0.0; LANES];
    let values = axial.into_iter().chain([spin]).chain(transverse).chain([planar]);
    lanes.iter_mut().zip(values).for_each(|(lane, value)| *lane = value);
    lanes
}

fn wall_factors(lanes: [f64; LANES], factor: f64) -> WallFactors {
    let [force, torque, strain] = ISOLATED.map(f64::sqrt);
    let mut lanes = lanes.into_iter();
    WallFactors {
        axial: BlockFactor::from_lanes(&mut lanes, &[force], &[strain], factor),
        spin: lanes.next().unwrap_or_default() * torque * factor,
        transverse: BlockFactor::from_lanes(&mut lanes, &[force, torque], &[strain], factor),
        planar: lanes.next().unwrap_or_default() * ISOLATED[2] * factor * factor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_between_the_nodes() {
        let (exact, table) = (SphereWall::get(), WallTable::get());
        for k in 0..54 {
            let gap = 1.3e-6 * 1.29_f64.powi(k);
            let (found, wanted) = (table.at(gap, 1.0), wall_factors(lanes(&exact, gap), 1.0));
            let relative = found.axial.factor[0][0] / wanted.axial.factor[0][0] - 1.0;
            assert!(gap > 0.8 || relative.abs() < 1e-8, "gap {gap}: {relative}");
            // Eigenvalues that change sign perturb the factors beyond a gap of 0.8, where their squares are small.
            let across =
                |factors: &WallFactors| factors.transverse.factor.map(|row| row.iter().map(|x| x * x).sum::<f64>());
            for (x, y) in across(&found).into_iter().zip(across(&wanted)) {
                assert!((x - y).abs() < 1e-5 * ISOLATED[1], "gap {gap}: {x}, not {y}");
            }
        }
    }

    #[test]
    fn slip_interpolates_between_the_nodes() {
        let (exact, table) = (SphereWallSlip::get(), WallSlipTable::get());
        for gap in (0..54).map(|k| 1.3e-6 * 1.29_f64.powi(k)) {
            let (all, known) = (exact.at(gap), slip_of_fcm(1.0 + gap));
            for (k, found) in table.at(gap).into_iter().enumerate() {
                assert!((found - all[k] + known[k]).abs() < 1e-6, "function {k} at {gap}");
            }
        }
    }

    /// The projection to the positive part changes the resistance to motion by less than 2e-3 of the drag of an
    /// isolated sphere, and only where it nearly vanishes.
    #[test]
    fn what_resists_motion_is_exact_but_for_what_is_negative() {
        let (exact, table) = (SphereWall::get(), WallTable::get());
        for gap in [1e-6, 1e-4, 0.01, 0.1, 0.5, 1.0, 1.2, 1.49] {
            let blocks = [WallBlocks::exact(&exact.at(gap)), WallBlocks::of_fcm(1.0 + gap)];
            let wanted = difference(&blocks[0].transverse, &blocks[1].transverse);
            let found = table.at(gap, 1.0);
            let allowed = if gap < 1.0 { 1e-7 * (1.0 + wanted[0][0]) } else { 2e-3 } * ISOLATED[0];
            for i in 0..2 {
                for j in 0..2 {
                    let root = &found.transverse.factor;
                    let product = root[i][0] * root[j][0] + root[i][1] * root[j][1];
                    assert!((product - wanted[i][j]).abs() < allowed, "gap {gap}: {product}, not {}", wanted[i][j]);
                }
            }
            let approach = found.axial.factor[0][0].powi(2);
            let wanted = blocks[0].axial[0][0] - blocks[1].axial[0][0];
            assert!(
                (approach - wanted).abs() < 1e-7 * wanted.abs() + 2e-3 * ISOLATED[0] * f64::from(u8::from(gap > 0.9))
            );
        }
    }
}
