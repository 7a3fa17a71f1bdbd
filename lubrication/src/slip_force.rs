//! Lubrication between squirmers: loads by their slip.

use std::sync::Arc;

use domain::Vector;

use crate::arithmetic::Arithmetic;
use crate::pair_force::{PairForce, PairForceError, PairGap};
use crate::slip_row::{SLIP_ROW, SlipRow};
use crate::slip_table::SlipTable;
use crate::sphere_motion::SphereLoads;
use crate::surface_slip::SurfaceSlip;

/// Correction of the force-coupling method for the slip of near pairs: exact loads of two spheres at rest in unbounded
/// fluid minus those of the method.
///
/// With the motions `q` of a pair relative to the ambient flow, the loads of the spheres on the fluid are `R q` plus
/// those by slip of spheres at rest. The correction is `R_lub q`, as of [`PairForce`], plus the difference here between
/// the exact loads by slip and those of the method. These diverge like the logarithm of the gap, while the resistance
/// of approach diverges like the inverse gap: slip is tangential.
#[derive(Debug, Clone)]
pub struct SlipForce {
    species: usize,
    /// By pair of species, of the loads of the first.
    tables: Vec<Arc<SlipTable>>,
}

impl SlipForce {
    /// Tables for every pair of species of a pair force. Computes tables at first use, with rayon; must not be called
    /// from a rayon task.
    ///
    /// # Errors
    /// If two radii differ too much.
    pub fn new(force: &PairForce) -> Result<Self, PairForceError> {
        let radii = force.radii();
        let table = |k: usize| {
            let [a, b] = [radii[k / radii.len()], radii[k % radii.len()]];
            let both = SlipTable::with_ratio(a.max(b) / a.min(b));
            let [small, large] = both.map_err(|error| PairForceError::Radii(a, b, error))?;
            Ok(if a <= b { small } else { large })
        };
        let tables = (0..radii.len() * radii.len()).map(table).collect::<Result<_, _>>()?;
        Ok(Self { species: radii.len(), tables })
    }

    /// Writes the numbers of the [`SlipRow`] of the first of two spheres at a distance of their centres, with the range
    /// of `force` and loads larger by a factor, with numbers of any width. Returns whether the spheres are within the
    /// cutoff.
    #[inline(always)]
    pub fn write<X: Arithmetic>(
        &self,
        force: &PairForce,
        distance: f64,
        species: [u32; 2],
        row: &mut [f64; SLIP_ROW],
    ) -> bool {
        let Some(PairGap { over_small, small, factor }) = force.pair_gap(distance, species) else { return false };
        self.tables[species[0] as usize * self.species + species[1] as usize].write::<X>(over_small, row);
        row[SlipRow::<X>::FACTORS].copy_from_slice(&[factor, factor * small]);
        true
    }

    /// Loads of the first of two spheres on the fluid by the slip of both, with `separation` from the first centre to
    /// the second and the range of `force`; `None` beyond the cutoff.
    pub fn loads(
        &self,
        force: &PairForce,
        separation: Vector,
        species: [u32; 2],
        slip: &[SurfaceSlip; 2],
    ) -> Option<SphereLoads> {
        let (distance, mut row) = (separation.length(), [0.0; SLIP_ROW]);
        self.write::<f64>(force, distance, species, &mut row).then(|| {
            let axis = (separation / distance).to_array();
            SphereLoads::from_numbers(&SlipRow::from_numbers(&row).loads(axis, &slip.map(|slip| slip.numbers())))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LubricationRange;
    use domain::{Quaternion, Tensor, Traceless};

    fn slips() -> [SurfaceSlip; 2] {
        [
            SurfaceSlip { first: Vector::new(0.3, -1.0, 0.4), second: Traceless([0.2, -0.5, 0.1, 0.7, 0.3]) },
            SurfaceSlip { first: Vector::new(-0.6, 0.2, 1.1), second: Traceless([-0.4, 0.6, 0.9, 0.1, -0.2]) },
        ]
    }

    /// Loads turn with the pair and its slip, and do not depend on which sphere comes first.
    #[test]
    fn loads_turn_with_the_pair() {
        let force = PairForce::new(&[1.0, 1.7], 0.8, LubricationRange::default()).unwrap();
        let slip = SlipForce::new(&force).unwrap();
        let rotation = Quaternion::exp(Vector::new(0.7, -0.4, 1.1));
        let turn =
            Tensor::from_cols(rotation.rotate(Vector::X), rotation.rotate(Vector::Y), rotation.rotate(Vector::Z));
        let turned = |v: Vector| turn * v;
        let turned_tensor = |t: Traceless| Traceless::part_of(&(turn * t.tensor() * turn.transpose()));
        for species in [[0, 0], [0, 1], [1, 0], [1, 1]] {
            let x = Vector::new(1.0, -1.4, 0.6).normalize() * (force.radii()[species[0] as usize] + 1.75);
            let by = |x: Vector, slips: &[SurfaceSlip; 2]| slip.loads(&force, x, species, slips).unwrap();
            let (straight, all) = (by(x, &slips()), slips());
            let other = all.map(|s| SurfaceSlip { first: turned(s.first), second: turned_tensor(s.second) });
            let found = by(turned(x), &other);
            assert!((found.force - turned(straight.force)).length() < 1e-12);
            assert!((found.torque - turned(straight.torque)).length() < 1e-12);
            let rest = found.moment - turned_tensor(straight.moment);
            assert!(rest.contract(rest).sqrt() < 1e-12);
        }
    }

    /// A mirror image of the pair, across the plane between equal spheres, has the mirror image of the loads.
    #[test]
    fn equal_spheres_are_mirror_images() {
        let force = PairForce::new(&[1.0], 1.0, LubricationRange::default()).unwrap();
        let slip = SlipForce::new(&force).unwrap();
        let x = Vector::Z * 2.03;
        let [a, b] = slips();
        let mirrored = |v: Vector| Vector::new(v.x, v.y, -v.z);
        let tensor = |t: Traceless| Traceless([t.0[0], t.0[1], -t.0[2], t.0[3], -t.0[4]]);
        let mirror = |s: SurfaceSlip| SurfaceSlip { first: mirrored(s.first), second: tensor(s.second) };
        let first = slip.loads(&force, x, [0, 0], &[a, b]).unwrap();
        let second = slip.loads(&force, -x, [0, 0], &[mirror(a), mirror(b)]).unwrap();
        assert!((second.force - mirrored(first.force)).length() < 1e-12);
        assert!((second.torque + mirrored(first.torque)).length() < 1e-12);
        let rest = second.moment - tensor(first.moment);
        assert!(rest.contract(rest).sqrt() < 1e-12);
    }
}
