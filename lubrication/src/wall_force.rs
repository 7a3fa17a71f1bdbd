//! Lubrication between spheres and plane walls.

use std::sync::Arc;

use domain::Vector;

use crate::lubrication_range::LubricationRange;
use crate::sphere_motion::SphereLoads;
use crate::surface_slip::{SurfaceSlip, loads_by_modes, scaled};
use crate::wall_factor::WallFactor;
use crate::wall_table::{WallSlipTable, WallTable};

/// Correction for a sphere at a wall, `R_exact - R_FCM`: the exact resistance of one sphere and one wall minus that
/// of the force-coupling method itself, with the wall's images of Gaussians. With it a single sphere at a wall is
/// exact at any gap up to `1.1` radii; beyond that the correction is tapered, to end at `1.5`.
///
/// As between spheres, the resistance to motions is kept positive semi-definite: the table stores, interpolates and
/// tapers a factor `B` of it. That changes the drag by up to 2e-3 beyond a gap of one radius, and nothing else.
#[derive(Debug, Clone)]
pub struct WallForce {
    viscosity: f64,
    range: LubricationRange,
    table: Arc<WallTable>,
}

impl WallForce {
    /// For a positive viscosity; `range` is that between spheres. Computes its table at first use, with rayon; must
    /// not be called from a rayon task.
    pub fn new(viscosity: f64, range: LubricationRange) -> Self {
        Self { viscosity, range: range.at_wall(), table: WallTable::get() }
    }

    /// Range of gaps of the correction, over the radius.
    pub fn range(&self) -> LubricationRange {
        self.range
    }

    /// Factor of a sphere whose centre is at a distance from a wall, with `axis` the unit vector to the wall. `None`
    /// beyond the cutoff; constant at gaps below the closest, also for spheres that overlap the wall unless the range
    /// separates them again.
    pub fn factor(&self, axis: Vector, distance: f64, radius: f64) -> Option<WallFactor> {
        let gap = distance / radius - 1.0;
        if gap >= self.range.cutoff() {
            return None;
        }
        let factor = (self.viscosity * radius).sqrt() * self.range.taper(gap);
        let factors = self.table.at(self.range.effective_gap(gap, self.range.minimum_gap()), factor);
        Some(WallFactor::new(&factors, axis, radius))
    }

    /// Correction for the slip of squirmers. Computes its table at first use, with rayon; must not be called from a
    /// rayon task.
    pub fn slip(&self) -> WallSlip<'_> {
        WallSlip { force: self, table: WallSlipTable::get() }
    }
}

/// Correction of the force-coupling method for the slip of squirmers at walls: the exact loads of a squirmer at rest
/// minus those of the method, as [`SlipForce`](crate::SlipForce) has between spheres.
#[derive(Debug, Clone)]
pub struct WallSlip<'a> {
    force: &'a WallForce,
    table: Arc<WallSlipTable>,
}

impl WallSlip<'_> {
    /// Loads of a squirmer on the fluid, in the range of [`WallForce::factor`] and by the same distances.
    pub fn loads(&self, axis: Vector, distance: f64, radius: f64, slip: &SurfaceSlip) -> Option<SphereLoads> {
        let (gap, range) = (distance / radius - 1.0, self.force.range);
        if gap >= range.cutoff() {
            return None;
        }
        let values = self.table.at(range.effective_gap(gap, range.minimum_gap()));
        let factor = self.force.viscosity * radius * range.taper_factor(gap);
        Some(scaled(loads_by_modes(axis, |function| values[function as usize], slip), factor, radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dense::inverse;
    use crate::sphere_motion::SphereMotion;
    use crate::two_sphere::SphereWall;
    use crate::wall_blocks::{ISOLATED, WallBlocks};
    use domain::Traceless;

    /// Unit motions by block, for an axis `z`: axial, spin, transverse in `x` and in `y`, and planar.
    fn unit(block: usize, kind: usize) -> SphereMotion {
        let third = (2.0_f64 / 3.0).sqrt() / 2.0;
        let half = 0.5_f64.sqrt();
        let mut motion = SphereMotion::default();
        match (block, kind) {
            (0, 0) => motion.velocity = Vector::Z,
            (0, _) => motion.strain_rate = Traceless([-third, 0.0, 0.0, -third, 0.0]),
            (1, _) => motion.angular_velocity = Vector::Z,
            (2, 0) => motion.velocity = Vector::X,
            (2, 1) => motion.angular_velocity = Vector::Y,
            (2, _) => motion.strain_rate = Traceless([0.0, 0.0, half, 0.0, 0.0]),
            (3, 0) => motion.velocity = Vector::Y,
            (3, 1) => motion.angular_velocity = -Vector::X,
            (3, _) => motion.strain_rate = Traceless([0.0, 0.0, 0.0, 0.0, half]),
            _ => motion.strain_rate = Traceless([half, 0.0, 0.0, -half, 0.0]),
        }
        motion
    }

    /// A block as rows.
    type Rows = Vec<Vec<f64>>;

    /// Blocks of FCM with lubrication and of the exact resistance.
    fn compared(gap: f64) -> Vec<(Rows, Rows)> {
        let exact = WallBlocks::exact(&SphereWall::get().resistance(gap).unwrap());
        let known = WallBlocks::of_fcm(1.0 + gap);
        let factor = WallForce::new(1.0, LubricationRange::default()).factor(Vector::Z, 1.0 + gap, 1.0);
        let rows = |blocks: &WallBlocks, block: usize| -> Rows {
            match block {
                0 => blocks.axial.map(|row| row.to_vec()).to_vec(),
                1 => blocks.spin.map(|row| row.to_vec()).to_vec(),
                2 | 3 => blocks.transverse.map(|row| row.to_vec()).to_vec(),
                _ => blocks.planar.map(|row| row.to_vec()).to_vec(),
            }
        };
        let of_block = |block: usize| {
            let (mut found, wanted) = (rows(&known, block), rows(&exact, block));
            let count = found.len();
            for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
                let loads = factor.map(|factor| factor.resistance(&unit(block, j)));
                found[i][j] += loads.map_or(0.0, |loads| unit(block, i).power(&loads));
            }
            (found, wanted)
        };
        (0..5).map(of_block).collect()
    }

    #[test]
    fn a_sphere_at_a_wall_is_exact_up_to_a_gap_of_its_radius() {
        for gap in [1.1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6, 0.9] {
            for (block, (found, wanted)) in compared(gap).into_iter().enumerate() {
                for (f, w) in found.iter().flatten().zip(wanted.iter().flatten()) {
                    // Error of the tables.
                    assert!((f - w).abs() < 2e-7 * (w.abs() + ISOLATED[0]), "gap {gap}, block {block}: {f}, not {w}");
                }
            }
        }
    }

    /// A sphere that overlaps the wall has the resistance at the closest gap, or that at a gap equal to the overlap
    /// if the range is to separate it.
    #[test]
    fn a_sphere_that_sank_in_parts_again_if_it_is_to() {
        let factor =
            |range: LubricationRange, gap: f64| WallForce::new(1.0, range).factor(Vector::Z, 1.0 + gap, 1.0).unwrap();
        let along = |range: LubricationRange, gap: f64| factor(range, gap).coefficients().xa;
        let (kept, parting) = (LubricationRange::default(), LubricationRange::default().separating());
        let ratio = |a: (LubricationRange, f64), b: (LubricationRange, f64)| along(a.0, a.1) / along(b.0, b.1);
        for (one, other) in [
            ((kept, -0.03), (kept, 0.5 * LubricationRange::MINIMUM_GAP)),
            ((parting, -0.03), (kept, 0.03)),
            ((parting, 0.03), (kept, 0.03)),
        ] {
            assert!((ratio(one, other) - 1.0).abs() < 1e-12, "{one:?}");
        }
    }

    #[test]
    fn beyond_it_motions_under_loads_are_within_a_percent() {
        for gap in [1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.7, 2.0, 3.0, 5.0] {
            let blocks = compared(gap);
            let [axial, transverse] = [0, 2].map(|k| (two(&blocks[k].0), two(&blocks[k].1)));
            assert!((axial.0[0][0] / axial.1[0][0] - 1.0).abs() < 0.01, "gap {gap}: {axial:?}");
            let [found, wanted] = [inverse(transverse.0), inverse(transverse.1)];
            assert!((found[0][0] / wanted[0][0] - 1.0).abs() < 0.01, "gap {gap}: {found:?}, not {wanted:?}");
            assert!((found[1][1] / wanted[1][1] - 1.0).abs() < 0.01, "gap {gap}: {found:?}, not {wanted:?}");
        }
    }

    /// The first two rows and columns.
    fn two(rows: &[Vec<f64>]) -> [[f64; 2]; 2] {
        std::array::from_fn(|i| std::array::from_fn(|j| rows[i][j]))
    }
}
